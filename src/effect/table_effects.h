/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects of tables, one row each (members in foilgauge/loop.h; fg_loop_table_effects returns all),
 * and further rows that the engine adds. */
#ifndef FG_EFFECT_TABLE_EFFECTS_H
#define FG_EFFECT_TABLE_EFFECTS_H

#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"

/* Returns the effects of an outlier row and of two exchanged rows, in the order of fg_loop_outlier;
 * then that of an outlier row whose values lie in each other's column. */
const fg_loop_effect *fg_loop_outlier_effects(void);

/* Returns the effects of the noise: serial correlation, unequal spread; ends with id NULL. */
const fg_loop_effect *fg_loop_noise_effects(void);

/* Returns the effect of a response on another scale: no candidate, a rival of claims. */
const fg_loop_effect *fg_loop_scale_effect(void);

/* Returns the curves for the part that no listed effect explains; ends with id NULL. */
const fg_loop_effect *fg_loop_curve_effects(void);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects of tables, one row each (foilgauge/loop.h has what a row says, fg_loop_table_effects all
 * that are looked for), and what the engine adds to them. */
#ifndef FG_EFFECT_TABLE_EFFECTS_H
#define FG_EFFECT_TABLE_EFFECTS_H

#include "foilgauge/loop.h"

/* A wrong row, and two that were exchanged: in the order of fg_loop_outlier. */
const fg_loop_effect *fg_loop_outlier_effects(void);

/* What noise may lack: serial correlation, unequal spread; ends with id NULL. */
const fg_loop_effect *fg_loop_noise_effects(void);

/* The curves of what no listed effect explains; ends with id NULL. */
const fg_loop_effect *fg_loop_curve_effects(void);

#endif

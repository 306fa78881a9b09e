/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of the table by subject; each list ends with id NULL. */
#ifndef FG_EFFECT_ROWS_OF_EFFECTS_H
#define FG_EFFECT_ROWS_OF_EFFECTS_H

#include "effect/effect.h"

extern const fg_effect fg_effects_scanner[], fg_effects_part[], fg_effects_curves[];

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Columns of effects at the rows of an edge fit. */
#ifndef FG_EFFECT_COLUMNS_H
#define FG_EFFECT_COLUMNS_H

#include "effect/effect.h"

/* Powers for the scanner's polynomials over an axis: u, u², u³ about the middle of the picture; 1
 * at FG_FIELD_HALF_MM from it. */
extern const fg_effect fg_effect_powers[2];

/* Computes columns of an effect at the rows: um of residual per um of amplitude. `columns` is
 * FG_FIELD_COLUMNS × row_count; returns the number filled. */
size_t fg_effect_columns(const fg_edge_fit *edge_fit, const fg_effect *effect, const double *shape,
                         double *columns);

/* Computes the columns for half the strip's width: a scanner's field stretches the strip as it
 * stretches the foil; a part's effect on the midline leaves its thickness unchanged and has none
 * (returns 0). */
size_t fg_effect_width_columns(const fg_edge_fit *edge_fit, const fg_effect *effect,
                               const double *shape, double *columns);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What effects do to the rows of points. */
#ifndef FG_EFFECT_COLUMNS_H
#define FG_EFFECT_COLUMNS_H

#include "effect/effect.h"

/* What polynomials over an axis of the scanner are made of: u, u², u³ about the middle of the
 * picture, along that axis; 1 at FG_FIELD_HALF_MM from it. */
extern const fg_effect fg_effect_powers[2];

/* Columns of an effect at the rows: um of residual per um of amplitude. `columns` is
 * FG_FIELD_COLUMNS × row_count; returns how many were filled. */
size_t fg_effect_columns(const fg_edge_fit *edge_fit, const fg_effect *effect, const double *shape,
                         double *columns);

/* The same for half the strip's width: a scanner's field stretches the strip as it stretches the
 * foil, a part's effect on the midline leaves its thickness alone. Returns 0 for those. */
size_t fg_effect_width_columns(const fg_edge_fit *edge_fit, const fg_effect *effect,
                               const double *shape, double *columns);

#endif

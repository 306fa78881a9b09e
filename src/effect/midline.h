/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What bases of the midline are made of. */
#ifndef FG_EFFECT_MIDLINE_H
#define FG_EFFECT_MIDLINE_H

#include "rows/edge_fit.h"

/* A part that was bent moves along its own normal; a part that was drawn with another radius moves
 * along the radius. On a land they are one, on the flank of a bump they differ. Of 1 outwards from
 * O, the share along the row's normal. */
double fg_midline_along_radius(const fg_edge_fit_row *row);
double fg_midline_along_normal(const fg_edge_fit_row *row);

/* Legendre polynomials first, first + step, ... of the place in the arc, the same on every bump.
 * P0, P1 and P2 are a circle's own. Returns `count`. */
size_t fg_midline_legendre(const fg_edge_fit_row *row, int first, int step, int count,
                           double *values);

/* Bumps of unlike radii may be alike over the angle or over the length of their arcs. The place is
 * the angle; over the length it is stretched by R over the mean R, which adds this much of
 * phi P'n, n = first and first + 2. Returns 2. */
size_t fg_midline_stretch(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, int first,
                          double *values);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Building blocks of the bases of the midline. */
#ifndef FG_EFFECT_MIDLINE_H
#define FG_EFFECT_MIDLINE_H

#include "rows/edge_fit.h"

/* Returns the share of a unit displacement outward from O that lies along the row's normal. A part
 * that was bent moves along its own normal; a part that was drawn with another radius moves along
 * the radius. On a land both are the same, on the flank of a bump they differ. */
double fg_midline_along_radius(const fg_edge_fit_row *row);
double fg_midline_along_normal(const fg_edge_fit_row *row);

/* Computes Legendre polynomials first, first + step, ... of the place in the arc, the same on every
 * bump. P0, P1 and P2 are the circle's own parameters. Returns `count`. */
size_t fg_midline_legendre(const fg_edge_fit_row *row, int first, int step, int count,
                           double *values);

/* Computes the columns that change a deviation from a function of the angle to one of the arc
 * length. Bumps of different radii may have the same deviation over either. Over the length, the
 * place is stretched by R over the mean R, which adds this multiple of phi P'n, n = first and first
 * + 2. Returns 2. */
size_t fg_midline_stretch(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, int first,
                          double *values);

#endif

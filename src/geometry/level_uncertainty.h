/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainty of the level at which edges are placed, and of lengths between two edges. */
#ifndef FG_GEOMETRY_LEVEL_UNCERTAINTY_H
#define FG_GEOMETRY_LEVEL_UNCERTAINTY_H

#include "foilgauge/foil.h"

/* Standard uncertainty of T(1/2), the count of half the light, as a share of the contrast. Sources:
 * the pixels (u_level; NaN counts as 0), the findings, and an unknown tone curve, unless the design
 * states it or a gauge or a scanner's model gives the level. `flags` are those of a foil; 0 for
 * discs. The error is common to all edges of one scan. */
double fg_level_uncertainty(const fg_design *design, const fg_picture_state *picture,
                            unsigned flags);

/* Returns the move of an edge of this blur per unit of the level, in the unit of the blur. */
double fg_level_shift(double blur);

/* Sets disc->level_u_mm from its blur, its picture and its edge_u_mm. Fit the disc
 * afterwards (fg_disc_measure_again). */
void fg_disc_find_level_uncertainty(const fg_design *design, fg_disc *disc);

#endif

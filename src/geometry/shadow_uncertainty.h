/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainty of circles by a shadow or a lit wall beside edges. */
#ifndef FG_GEOMETRY_SHADOW_UNCERTAINTY_H
#define FG_GEOMETRY_SHADOW_UNCERTAINTY_H

#include "geometry/layout.h"

/* None of these does anything where neither a shadow nor an uneven blur was found; both move edges
 * by their bearing. */

/* Widens the covariance of a circle that was fitted to the line. */
void fg_arc_add_shadow(const fg_datum_line *line, fg_arc *arc);

/* Widens the derived quantities of a bump and of the overall circle that they were derived with.
 * The shadow moves both circles at once, so a height hardly changes. The overall circle's own
 * covariance must not hold the shadow yet. */
void fg_bump_add_shadow(const fg_layout *layout, size_t i, const fg_design *design,
                        const fg_nominal *nominal, const fg_overall *overall, fg_bump *bump);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainty of circles by a shadow or a lit wall beside edges. */
#ifndef FG_GEOMETRY_SHADOW_UNCERTAINTY_H
#define FG_GEOMETRY_SHADOW_UNCERTAINTY_H

#include "geometry/layout.h"

/* None of these does anything where neither a shadow nor an uneven blur was found; both move edges
 * by their bearing. */

/* Number of bearings whose shifts are independent. */
enum { FG_SHADOW_PARTS = 12 };

/* Shifts of a circle's parameters, one by all bearings and one by each part of them; none without
 * shadow and uneven blur. */
typedef struct fg_arc_shadow {
  size_t count;
  double shifts[FG_SHADOW_PARTS + 1][3];
} fg_arc_shadow;

void fg_arc_find_shadow(const fg_datum_line *line, const fg_arc *arc, fg_arc_shadow *shadow);

/* Widens the covariance of a circle that was fitted to the line. */
void fg_arc_add_shadow(const fg_datum_line *line, fg_arc *arc);

/* Widens the derived quantities of a bump and of the overall circle that they were derived with.
 * The shadow moves both circles at once, so a height hardly changes. The overall circle's own
 * covariance must not hold the shadow yet. `own` is the shadow of the bump's circle, `lands` that
 * of the overall circle. */
void fg_bump_add_shadow(const fg_arc_shadow *own, const fg_arc_shadow *lands,
                        const fg_design *design, const fg_nominal *nominal,
                        const fg_overall *overall, fg_bump *bump);

#endif

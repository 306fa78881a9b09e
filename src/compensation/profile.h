/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The profile of a die as arcs: lands, fillets and bumps, about O; y points from O through the
 * middle of the bumps. */
#ifndef FG_COMPENSATION_PROFILE_H
#define FG_COMPENSATION_PROFILE_H

#include "foilgauge/compensation.h"
#include "foilgauge/foil.h"

/* Directions run clockwise from the y axis: a point is centre + radius (sin, cos). */
typedef struct fg_profile_arc {
  fg_point centre;
  double radius, from, to; /* mm, rad; `to` may be below `from` */
} fg_profile_arc;

/* Lands, two fillets and a bump each, and the last land. */
enum { FG_PROFILE_ARCS = 4 * FG_COMPENSATION_BUMPS + 1 };

typedef struct fg_die_profile_arcs {
  fg_profile_arc arc[FG_PROFILE_ARCS];
  size_t count;
} fg_die_profile_arcs;

/* Lines of the profile: the datum line, and the surfaces of both halves. */
typedef enum fg_profile_line {
  FG_PROFILE_DATUM,
  FG_PROFILE_CONCAVE, /* touches the strip's inner side */
  FG_PROFILE_CONVEX,
  FG_PROFILE_LINES
} fg_profile_line;

/* Distance of a line from the datum line, mm, outwards. */
double fg_profile_offset(const fg_design *design, fg_profile_line line);

/* Makes the arcs of a parallel to the datum line. FG_ERR_DATA: fillets of that size do not fit. */
fg_status fg_profile_make(fg_context *ctx, const fg_die_dimensions *die, double offset_mm,
                          fg_die_profile_arcs *profile);

#endif

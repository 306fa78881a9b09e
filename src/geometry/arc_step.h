/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A jump of the scan within a bump's arc: rows or columns that are lost or come twice displace all
 * that lies beyond them. Where the arc's tangent runs along the jump, its middle moves against its
 * ends, and the radius with it. */
#ifndef FG_GEOMETRY_ARC_STEP_H
#define FG_GEOMETRY_ARC_STEP_H

#include "geometry/layout.h"

/* Finds, for every fitted bump, the displacement along x or y of all beyond one row or column that
 * its residuals speak for, against none: fills `step` of layout->bumps. The changed centre lies
 * halfway between both parts of the scan. Chances are against the other bumps of the foil, whose
 * residuals have the same noise: with fewer than five bumps none is sought. FG_ERR_MEMORY. */
fg_status fg_arc_steps_find(fg_context *ctx, fg_layout *layout);

/* Returns true when a jump is so likely and so large that its bump is flagged. */
bool fg_arc_step_is_flagged(const fg_arc *arc);

/* Adds to the covariance of bump i its change by a jump that is likely, half of the jump on its
 * centre, and the displacement of the lands beside it that lie off the overall circle. */
void fg_arc_step_add(fg_layout *layout, size_t i);

#endif

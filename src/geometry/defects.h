/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Defects on the arcs of a foil, as flags of its bumps. */
#ifndef FG_GEOMETRY_DEFECTS_H
#define FG_GEOMETRY_DEFECTS_H

#include "geometry/layout.h"

/* Returns the flags of bump i of the layout: FG_BUMP_DISTURBED_EDGE, FG_BUMP_GAP,
 * FG_BUMP_TOUCHES_OTHER. */
unsigned fg_defect_flags(const fg_layout *layout, size_t i);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A jump of the scan between two lands: all beyond it is displaced. */
#ifndef FG_GEOMETRY_LAND_STEP_H
#define FG_GEOMETRY_LAND_STEP_H

#include "geometry/layout.h"

/* Finds the jump that the lands' distances from the overall circle speak for, against no jump and
 * against an oval foil. `change` is what the circle's x, y and radius would change by (the centre
 * halfway between both parts of the scan). False: there is none, or there are too few lands. */
bool fg_land_step_find(const fg_layout *layout, double change[3]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A jump of the scan between two lands: all beyond it is displaced. */
#ifndef FG_GEOMETRY_LAND_STEP_H
#define FG_GEOMETRY_LAND_STEP_H

#include "geometry/layout.h"

/* Finds the jump that the lands' distances from the overall circle speak for, against no jump and
 * against an oval foil, and fills layout->land_step. Displaced are all lands from one on, along any
 * direction, or all stations beyond one row or column, along y or x. The changed centre lies
 * halfway between both parts of the scan. */
void fg_land_step_find(fg_layout *layout);

#endif

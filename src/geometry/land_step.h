/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A jump of the scan between two lands: all beyond it is displaced. */
#ifndef FG_GEOMETRY_LAND_STEP_H
#define FG_GEOMETRY_LAND_STEP_H

#include "geometry/layout.h"

typedef struct fg_land_step {
  double chance;    /* of distances as far from one circle without a jump; 1: no jump was sought */
  double jump_mm;   /* size of the jump; NaN: none was sought */
  double change[3]; /* of the circle's x, y and radius, if the scan jumps */
} fg_land_step;

/* Finds the jump that the lands' distances from the overall circle speak for, against no jump and
 * against an oval foil. The changed centre lies halfway between both parts of the scan. */
fg_land_step fg_land_step_find(const fg_layout *layout);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Map: a smooth displacement of places of the glass, both components, as a cubic B-spline over x
 * and y. Beyond its region it keeps the border's value. */
#ifndef FG_FIELD_MAP_H
#define FG_FIELD_MAP_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/circle.h"

enum { FG_MAP_SIDE_MIN = 4, FG_MAP_SIDE_MAX = 24, FG_MAP_WEIGHTS = 16, FG_MAP_MODES_MAX = 64 };

/* Knots over a region. */
typedef struct fg_map_frame {
  double low_mm[2], high_mm[2];
  size_t side[2]; /* number of splines along x and along y */
} fg_map_frame;

/* Returns the place at shares x and y of the way over the region. */
static inline fg_point fg_map_place(const fg_map_frame *frame, double x, double y) {
  return (fg_point){frame->low_mm[0] + x * (frame->high_mm[0] - frame->low_mm[0]),
                    frame->low_mm[1] + y * (frame->high_mm[1] - frame->low_mm[1])};
}

/* A spline that is not 0 at a place, and its value there. */
typedef struct fg_map_weight {
  size_t spline; /* row by row */
  double value;
} fg_map_weight;

static inline size_t fg_map_splines(const fg_map_frame *frame) {
  return frame->side[0] * frame->side[1];
}

void fg_map_weigh(const fg_map_frame *frame, fg_point at, fg_map_weight weights[FG_MAP_WEIGHTS]);

/* A map with numbers. `mm`: displacement along x of all splines, then along y. A mode is such a
 * list, too: a displacement with the size of its standard uncertainty, independent of the other
 * modes'. */
typedef struct fg_field_map {
  fg_map_frame frame;
  double *mm;                      /* owned */
  double *modes[FG_MAP_MODES_MAX]; /* owned */
  size_t mode_count;
} fg_field_map;

void fg_field_map_free(fg_field_map *map); /* frees its members; NULL is fine */

/* Displacement by the numbers of a map or a mode. */
fg_point fg_map_at(const fg_map_frame *frame, const double *mm, fg_point at);

#endif

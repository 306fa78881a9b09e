/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The counts across edges under a driver's model, at many places, again and again: for values that
 * differ from earlier ones in one value only that value's part is computed anew. */
#ifndef FG_VISION_DRIVER_PLACES_H
#define FG_VISION_DRIVER_PLACES_H

#include "vision/driver_light.h"

typedef struct fg_driven_places {
  size_t count;   /* of places asked for */
  size_t grid;    /* of places of the unsharp mask's result; 0: no mask */
  size_t reach;   /* of the mask, beyond either end of that grid */
  double from_px; /* place of the grid's first value */
  bool regular;   /* the grid is the places asked for */
  bool single;
  double *across; /* the places asked for where they are not the grid, then the grid's */
  fg_lit_side kept[2], other[2];
  double *plain, *blurred, *other_plain, *other_blurred;
  fg_driver driver; /* of `plain` and `blurred` */
  double values[FG_DRIVEN_VALUES];
  double *memory;
} fg_driven_places;

/* Allocates room for `count` places; `masked`: there may be an unsharp mask. Free them by
 * fg_driven_places_free. */
fg_status fg_driven_places_create(fg_context *ctx, size_t count, bool masked,
                                  fg_driven_places *places);
void fg_driven_places_free(fg_driven_places *places);

/* Sets the places to those of a profile's bins, or to `count` places from `from_px` on,
 * FG_DRIVEN_STEP_PX apart. `masked`: there may be a mask of up to radius_px. */
void fg_driven_places_of_bins(const fg_driven_profile *profile, bool masked, double radius_px,
                              fg_driven_places *places);
void fg_driven_places_of_grid(double from_px, size_t count, bool single, double radius_px,
                              fg_driven_places *places);

/* Finds the counts, and keeps what the following calls of fg_driven_places_vary may use. `lossy`:
 * there may be a halo. */
void fg_driven_places_keep(const fg_driver *driver, const fg_driver_tone *tone,
                           const double *values, bool lossy, fg_driven_places *places,
                           double *counts);

/* Finds the counts for other values. */
void fg_driven_places_vary(const fg_driver *driver, const fg_driver_tone *tone,
                           const double *values, fg_driven_places *places, double *counts);

#endif

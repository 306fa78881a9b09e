/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mean profiles across edges, for the findings about driver and light.
 *
 * No function here uses an edge model. Levels are medians, the edge is the crossing of the middle
 * of its levels, and a share of the contrast is 1 on the material and 0 beside it.
 */
#ifndef FG_VISION_PICTURE_PROFILE_H
#define FG_VISION_PICTURE_PROFILE_H

#include <math.h>

#include "foilgauge/picture.h"
#include "foilgauge/status.h"
#include "vision/edge_model.h"

/* Distance of neighbouring shares, and their number on either side of the edge. */
#define FG_SHARE_STEP_PX 0.25
enum { FG_SHARES_INSIDE = 48, FG_SHARES_OUTSIDE = 80, FG_SHARES = 128 };

/* One edge, outwards. */
typedef struct fg_edge_profile {
  double bearing;          /* of the outward normal, rad, from x towards y */
  double inside, outside;  /* counts */
  double blur_px;          /* by a model's fit; NaN: none */
  float shares[FG_SHARES]; /* at fg_share_px; NaN: no pixel */
  float background;        /* share far from the edge; NaN: not known */
  double inside_px;        /* how far inwards the profile belongs to this edge alone */
} fg_edge_profile;

/* Distance outwards from the edge. */
static inline double fg_share_px(size_t i) {
  return ((double)i + 0.5 - FG_SHARES_INSIDE) * FG_SHARE_STEP_PX;
}

/* Source of a profile. `bins` run from inside the material to outside when `way` is 1, the other
 * way round when it is -1. */
typedef struct fg_profile_source {
  const fg_profile_bin *bins;
  size_t count;
  int way;
  double middle_px; /* place surely on the material, and its half width of sure material, -1: to the
                       end */
  double plateau_px; /* half width of the stretch whose median is the material's level */
  double reach_px;   /* the last stretch outside, whose median is the background's level */
  double bearing, blur_px, background; /* background: count, NaN: not known */
} fg_profile_source;

/* Fills `profile`; false when there is no edge. */
bool fg_edge_profile_make(const fg_profile_source *source, fg_edge_profile *profile);

/* Fills the findings of profiles of many bearings: under- and overshoot, blur and shadow by
 * direction. Reorders nothing. */
fg_status fg_picture_inspect_profiles(fg_context *ctx, const fg_edge_profile *profiles,
                                      size_t count, fg_picture_state *state);

/* A band beside an edge reaches from the end of the edge's own blur to this distance. */
#define FG_BAND_PX 5.0
static inline double fg_band_from(double blur_px) {
  return fmax(2.5 * blur_px, 2.0);
}

/* Mean share in the band, over the background's. */
typedef struct fg_edge_band {
  double bearing; /* as a profile's */
  double share;   /* NaN: not seen */
} fg_edge_band;

/* Fills the findings of a shadow from bands; left and right edges alternate, in order along the
 * strip. */
fg_status fg_picture_inspect_bands(fg_context *ctx, const fg_edge_band *bands, size_t count,
                                   fg_picture_state *state);

#endif

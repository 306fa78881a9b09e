/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mean profiles across edges, for what a scanner's driver or the light has made of a picture.
 *
 * Nothing here asks the model of an edge: levels are medians, the edge is where the profile crosses
 * the middle of its levels, and a share of the contrast is 1 on the material and 0 beside it.
 */
#ifndef FG_VISION_PICTURE_PROFILE_H
#define FG_VISION_PICTURE_PROFILE_H

#include <math.h>

#include "foilgauge/picture.h"
#include "foilgauge/status.h"
#include "vision/edge_model.h"

/* Shares lie so many px apart, and reach so far on either side of the edge. */
#define FG_SHARE_STEP_PX 0.25
enum { FG_SHARES_INSIDE = 48, FG_SHARES_OUTSIDE = 80, FG_SHARES = 128 };

/* One edge, outwards. */
typedef struct fg_edge_profile {
  double bearing;          /* of the outward normal, rad, from x towards y */
  double inside, outside;  /* counts */
  double blur_px;          /* as a model's fit has it; NaN: none */
  float shares[FG_SHARES]; /* at fg_share_px; NaN: no pixel */
  float background;        /* share far from the edge; NaN: not known */
  double inside_px;        /* how far the material reaches that is of this edge alone */
} fg_edge_profile;

/* Distance outwards from the edge. */
static inline double fg_share_px(size_t i) {
  return ((double)i + 0.5 - FG_SHARES_INSIDE) * FG_SHARE_STEP_PX;
}

/* What a profile is made of. `bins` run from inside the material to outside when `way` is 1, the
 * other way round when it is -1. */
typedef struct fg_profile_source {
  const fg_profile_bin *bins;
  size_t count;
  int way;
  double middle_px; /* place of sure material, and how far it reaches around that, -1: to the end */
  double plateau_px; /* half width of the stretch whose median is the material's level */
  double reach_px;   /* the last stretch outside, whose median is the background's level */
  double bearing, blur_px, background; /* background: count, NaN: not known */
} fg_profile_source;

/* False when there is no edge. */
bool fg_edge_profile_take(const fg_profile_source *source, fg_edge_profile *profile);

/* Fills what profiles of many bearings tell: under- and overshoot, blur and shadow by direction.
 * Reorders nothing. */
fg_status fg_picture_inspect_profiles(fg_context *ctx, const fg_edge_profile *profiles,
                                      size_t count, fg_picture_state *state);

/* A band beside an edge is sought where the edge's own blur has ended, and so far out. */
#define FG_BAND_PX 5.0
static inline double fg_band_from(double blur_px) {
  return fmax(2.5 * blur_px, 2.0);
}

/* The mean share there over the background's. */
typedef struct fg_edge_band {
  double bearing; /* as a profile's */
  double share;   /* NaN: not seen */
} fg_edge_band;

/* Fills what bands tell of a shadow; left and right edges take turns, in order along the strip. */
fg_status fg_picture_inspect_bands(fg_context *ctx, const fg_edge_band *bands, size_t count,
                                   fg_picture_state *state);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Place of a cross-section in one channel, when another channel's is known. */
#ifndef FG_MEASURE_COLOUR_PROFILE_H
#define FG_MEASURE_COLOUR_PROFILE_H

#include <stdbool.h>
#include <stddef.h>

#include "vision/edge_model.h"

/* A pixel near the cross-section: distance along the normal from its known place. */
typedef struct fg_colour_pixel {
  float across_px;
  float value[3]; /* counts of 255; red, green, blue */
} fg_colour_pixel;

/* Known values: half the strip's width; of a single edge INFINITY (it lies at 0, and the normal
 * points out of the part). */
typedef struct fg_colour_known {
  double half_width_px, blur_px;
} fg_colour_known;

typedef struct fg_colour_place {
  double shift_px; /* shift of this channel along the normal */
  double variance; /* of the shift, for noise of variance 1 */
  double contrast; /* counts */
  double noise;    /* variance of a pixel, by the misfit */
  bool good;
} fg_colour_place;

/* Fits level, contrast, place and blur of the profile b + c (Phi((v + w) / s) - Phi((v - w) / s)),
 * v = n - shift, to one channel's pixels; of a single edge b + c Phi(-v / s). Deviations from this
 * model that are even about its middle, by halo and tone curve, move no place. Other deviations are
 * nearly the same in all channels. */
void fg_colour_profile_fit(const fg_edge_tables *tables, const fg_colour_known *known,
                           const fg_colour_pixel *pixels, size_t count, int channel,
                           fg_colour_place *place);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where one channel shows a cross-section whose place is known from another. */
#ifndef FG_MEASURE_COLOUR_PROFILE_H
#define FG_MEASURE_COLOUR_PROFILE_H

#include <stdbool.h>
#include <stddef.h>

#include "vision/edge_model.h"

/* A pixel near the cross-section: distance along the normal from where it is known to be. */
typedef struct fg_colour_pixel {
  float across_px;
  float value[3]; /* counts of 255; red, green, blue */
} fg_colour_pixel;

/* What is known: half the strip's width; of a lone edge INFINITY (it lies at 0, and the normal
 * points away from what lies within). */
typedef struct fg_colour_known {
  double half_width_px, blur_px;
} fg_colour_known;

typedef struct fg_colour_place {
  double shift_px; /* by which the channel shows it further along the normal */
  double variance; /* of the shift, for noise of variance 1 */
  double contrast; /* counts */
  double noise;    /* variance of a pixel that the misfit tells */
  bool good;
} fg_colour_place;

/* Fits level, contrast, place and blur of the profile b + c (Phi((v + w) / s) - Phi((v - w) / s)),
 * v = n - shift, to one channel's pixels; of a lone edge b + c Phi(-v / s). A profile that is even
 * about its middle, as halo and tone curve leave it, moves no place; what it differs by from this
 * form is the same in all channels, nearly. */
void fg_colour_profile_fit(const fg_edge_tables *tables, const fg_colour_known *known,
                           const fg_colour_pixel *pixels, size_t count, int channel,
                           fg_colour_place *place);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The intensity across one edge that stands alone.
 *
 * With d = n - e (distance outwards from the edge), levels a and b and slopes g and h inside and
 * outside, blur s and the tone curve G of vision/edge_model.h:
 *
 *  I(n) = G( (a + g d) (1 - Phi(d/s)) + (b + h d) Phi(d/s) + (h - g) s phi(d/s) )
 *
 * the Gaussian blur of a step between two straight lines. Counts at the end of the scale are
 * censored: they give only a lower bound of the light.
 */
#ifndef FG_VISION_STEP_MODEL_H
#define FG_VISION_STEP_MODEL_H

#include <stdbool.h>

#include "vision/edge_model.h"

/* Values of the model, in this order. */
enum {
  FG_STEP_EDGE,
  FG_STEP_INSIDE,
  FG_STEP_OUTSIDE,
  FG_STEP_SLOPE_IN,
  FG_STEP_SLOPE_OUT,
  FG_STEP_BLUR,
  FG_STEP_GAMMA,
  FG_STEP_VALUES
};

#define FG_COUNT_WHITE 253.5 /* mean counts above count as the end of the scale */

typedef struct fg_step_fit {
  double values[FG_STEP_VALUES]; /* px, light, light per px */
  double sd[FG_STEP_VALUES];     /* 0 for those that were held */
  unsigned held;                 /* bit i: values[i] stays as given */
  double noise;                  /* sd of one pixel, by the misfit */
  double shape_ratio; /* of the edge's variance, to the one if nothing else were fitted */
  bool good;                     /* the fit converged to plausible values */
} fg_step_fit;

/* Fits the model to a mean profile by damped Gauss-Newton; `fit` holds the start and the bits of
 * held values. */
void fg_step_fit_model(const fg_profile_bin *bins, size_t count, fg_step_fit *fit);

#endif

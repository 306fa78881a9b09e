/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Model of a scanner's driver: a tone curve of few parameters, and an unsharp mask.
 *
 *  counts = (1 + a) C - a (C * normal(r)),   C = G((1 - h) light + h (light * exp(-|x|/l)/2l))
 *  G(u) = A + (B - A) S( (255 (u/255)^(1/gamma) - A) / (B - A) )
 *  S(x) = (L(x) - L(0)) / (L(1) - L(0)),   L(x) = 1 / (1 + exp(-k (x - m)))
 *
 * First a power of the light. Then an S of steepness k about m between the counts A and B of the
 * edge's two levels, which it leaves in place (k = 0: none). Then the unsharp mask: it adds `a`
 * times the difference of the counts from their own Gaussian blur. The halo h belongs to the
 * optics, but has its place here: a model without it takes light that is spread wide for a tone
 * curve.
 *
 * The mean profile of one edge tells little of the driver: another place and blur of the edge make
 * up for much of a tone curve. So many profiles are fitted at once, each with its own levels,
 * slopes, blurs and edges, and one driver for all. The result holds the uncertainty of the edges
 * that the driver's uncertainty causes.
 */
#ifndef FG_VISION_DRIVER_MODEL_H
#define FG_VISION_DRIVER_MODEL_H

#include <math.h>
#include <stdbool.h>

#include "foilgauge/status.h"
#include "vision/edge_model.h"

enum {
  FG_DRIVER_LN_GAMMA,
  FG_DRIVER_STEEPNESS, /* k */
  FG_DRIVER_CENTRE,    /* m */
  FG_DRIVER_AMOUNT,    /* a */
  FG_DRIVER_RADIUS,    /* r, px */
  FG_DRIVER_HALO,      /* h */
  FG_DRIVER_HALO_PX,   /* l */
  FG_DRIVER_VALUES
};

enum { FG_DRIVER_TONE_STEPS = 2048, FG_DRIVER_LIGHT_MAX = 330 };

typedef struct fg_driver {
  double values[FG_DRIVER_VALUES];
  double ends[2]; /* A < B, counts */
  bool sharpens;  /* every model without an unsharp mask explains the profiles clearly worse */
} fg_driver;

/* No tone curve, no unsharp mask. */
fg_driver fg_driver_none(const double ends[2]);

/* G as a table over all light, dense where powers are steep. */
typedef struct fg_driver_tone {
  bool filled, linear;                    /* linear: G is the identity, there is no table */
  fg_driver of;                           /* whose table it is */
  double count[FG_DRIVER_TONE_STEPS + 2]; /* at FG_DRIVER_LIGHT_MAX i² / steps² */
  double rate[FG_DRIVER_TONE_STEPS + 1];  /* counts per light from there to the next */
  double below;                           /* counts per light below 0 */
} fg_driver_tone;

bool fg_driver_is_linear(const fg_driver *driver);
double fg_driver_count(const fg_driver *driver, double light); /* G */

/* Makes the table, unless it is that of the same curve (a new one is zeroed). */
void fg_driver_tone_fill(const fg_driver *driver, fg_driver_tone *tone);
double fg_driver_tone_inverse(const fg_driver_tone *tone, double count);

/* Light at the table's i-th count. */
static inline double fg_driver_tone_light(int i) {
  const double steps = FG_DRIVER_TONE_STEPS;
  return FG_DRIVER_LIGHT_MAX / (steps * steps) * ((double)i * i);
}

/* Returns G, and its change per light. */
static inline double fg_driver_tone_at(const fg_driver_tone *tone, double light, double *rate) {
  *rate = 1;
  if (tone->linear) return light;
  *rate = tone->below;
  if (light < 0) return tone->count[0] + light * tone->below;
  const double steps = FG_DRIVER_TONE_STEPS;
  double root = sqrt(light * (steps * steps / FG_DRIVER_LIGHT_MAX));
  int i = root < FG_DRIVER_TONE_STEPS ? (int)root : FG_DRIVER_TONE_STEPS;
  *rate = tone->rate[i];
  return tone->count[i] + (light - fg_driver_tone_light(i)) * *rate;
}

/* Turns light at many places to counts. */
void fg_driver_tone_all(const fg_driver_tone *tone, size_t count, double *light);

/* Slope of S in its middle, less 1. */
double fg_driver_extra_slope(const fg_driver *driver);

/* Values of the profile of one edge, or of both of a strip. Levels are counts before the unsharp
 * mask; slopes are light per px, as counts over the contrast in both; edges and blurs are px. Of
 * one edge alone the plateau is the level inside, and SLOPE_L the slope there. */
enum {
  FG_DRIVEN_LEFT,
  FG_DRIVEN_RIGHT,
  FG_DRIVEN_PLATEAU,
  FG_DRIVEN_LEVEL_L,
  FG_DRIVEN_LEVEL_R,
  FG_DRIVEN_SLOPE_L,
  FG_DRIVEN_SLOPE_R,
  FG_DRIVEN_BLUR_L,
  FG_DRIVEN_BLUR_R,
  FG_DRIVEN_VALUES
};

typedef struct fg_driven_profile {
  const fg_profile_bin *bins; /* none of them empty, at most FG_DRIVEN_MAX - 8 */
  const double *tails;        /* of each bin: counts per contrast of light; NULL: not used */
  size_t count;
  double values[FG_DRIVEN_VALUES];
  double sd[FG_DRIVEN_VALUES]; /* with the driver held */
  unsigned held;               /* bit i: values[i] is not fitted */
  bool single;                 /* one edge, not both of a strip */
} fg_driven_profile;

/* Max number of values of one profile, with those at the ends of the convolution. */
enum { FG_DRIVEN_MAX = 1024 };
#define FG_DRIVEN_STEP_PX 0.25

typedef struct fg_driver_fit {
  fg_driver driver;
  unsigned free; /* bit i: driver.values[i] is fitted */
  double sd[FG_DRIVER_VALUES];
  double u_edge_px;           /* sd of an edge's place, outwards, caused by the free values */
  double edge_px;             /* mean place of the edges, outwards from the middle */
  double noise;               /* sd of a pixel: in: as expected; out: by the misfit */
  bool good;                  /* it converged */
  const fg_driver_tone *tone; /* of `driver` where nothing of it is free; NULL: made anew */
} fg_driver_fit;

/* Fits all profiles and the free values of the driver at once. `profiles` and fit->driver hold the
 * start. */
fg_status fg_driver_fit_profiles(fg_context *ctx, fg_driven_profile *profiles, size_t count,
                                 fg_driver_fit *fit);

#endif

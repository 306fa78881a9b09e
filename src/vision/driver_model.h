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
  bool linear;                            /* G is the identity, there is no table */
  double count[FG_DRIVER_TONE_STEPS + 2]; /* at FG_DRIVER_LIGHT_MAX i² / steps² */
  double below;                           /* counts per light below 0 */
} fg_driver_tone;

bool fg_driver_is_linear(const fg_driver *driver);
double fg_driver_count(const fg_driver *driver, double light); /* G */
void fg_driver_tone_fill(const fg_driver *driver, fg_driver_tone *tone);
double fg_driver_tone_at(const fg_driver_tone *tone, double light, double *rate);
double fg_driver_tone_inverse(const fg_driver_tone *tone, double count);

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

/* Counts at the places of the bins. */
void fg_driven_counts(const fg_driver *driver, const fg_driver_tone *tone,
                      const fg_driven_profile *profile, const double *values, double *counts);

/* Counts at `count` places from `from_px` on, FG_DRIVEN_STEP_PX apart. */
void fg_driven_grid(const fg_driver *driver, const fg_driver_tone *tone, const double *values,
                    bool single, double from_px, size_t count, double *counts);

typedef struct fg_driver_fit {
  fg_driver driver;
  unsigned free; /* bit i: driver.values[i] is fitted */
  double sd[FG_DRIVER_VALUES];
  double u_edge_px; /* sd of an edge's place, outwards, caused by the free values */
  double edge_px;   /* mean place of the edges, outwards from the middle */
  double noise;     /* sd of a pixel: in: as expected; out: by the misfit */
  bool good;        /* it converged */
} fg_driver_fit;

/* Fits all profiles and the free values of the driver at once. `profiles` and fit->driver hold the
 * start. */
fg_status fg_driver_fit_profiles(fg_context *ctx, fg_driven_profile *profiles, size_t count,
                                 fg_driver_fit *fit);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The intensity across a strip: both edges at once.
 *
 * With d1 = e1 - n and d2 = n - e2 (distance outwards from the left and the right edge), and the
 * tone curve G,
 *
 *  I(n) = G( P + T(d1; bL, gL, sL) + T(d2; bR, gR, sR) )
 *  T(d; b, g, s) = (b + g d - P) Phi(d/s) + g s phi(d/s)
 *
 * a plateau P between two backgrounds that start with level b at the edge and run with slope g (a
 * halo, the part's wall), each step blurred with a Gaussian of sd s. Both edges stand in one model
 * because they overlap: the strip is 19 px wide and the blur reaches 3 px.
 *
 * Levels are in counts of light on a scale of 0 to 255; G(u) = 255 (u/255)^(1/gamma).
 */
#ifndef FG_VISION_EDGE_MODEL_H
#define FG_VISION_EDGE_MODEL_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Shape of the profile: all values but the edges' places. */
typedef struct fg_edge_shape {
  double plateau;    /* P */
  double level[2];   /* bL, bR */
  double slope[2];   /* gL, gR per px */
  double blur_px[2]; /* sL, sR */
} fg_edge_shape;

enum { FG_EDGE_SHAPE_VALUES = 7, FG_NORMAL_STEPS = 64, FG_NORMAL_REACH = 6, FG_TONE_STEPS = 1024 };

/* Tables for the inner loops: the normal distribution and the tone curve. */
typedef struct fg_edge_tables {
  float density[2 * FG_NORMAL_REACH * FG_NORMAL_STEPS + 2];    /* phi */
  float cumulative[2 * FG_NORMAL_REACH * FG_NORMAL_STEPS + 2]; /* Phi */
  bool linear;                                                 /* G(u) = u */
  float tone[FG_TONE_STEPS + 2];                               /* G at 255 i / FG_TONE_STEPS */
} fg_edge_tables;

void fg_edge_tables_init(fg_edge_tables *tables, double gamma);

/* phi and Phi by linear interpolation (error below 1e-5). */
static inline void fg_edge_normal(const fg_edge_tables *tables, float t, float *density,
                                  float *cumulative) {
  float u = (t + FG_NORMAL_REACH) * FG_NORMAL_STEPS;
  if (u <= 0) {
    *density = 0;
    *cumulative = 0;
    return;
  }
  if (u >= 2 * FG_NORMAL_REACH * FG_NORMAL_STEPS) {
    *density = 0;
    *cumulative = 1;
    return;
  }
  int i = (int)u;
  float f = u - (float)i;
  *density = tables->density[i] + f * (tables->density[i + 1] - tables->density[i]);
  *cumulative = tables->cumulative[i] + f * (tables->cumulative[i + 1] - tables->cumulative[i]);
}

/* G and its derivative at u. */
static inline void fg_edge_tone(const fg_edge_tables *tables, float u, float *value, float *rate) {
  if (tables->linear) {
    *value = u;
    *rate = 1;
    return;
  }
  float x = u * (FG_TONE_STEPS / 255.0f);
  if (x < 0) x = 0;
  if (x > FG_TONE_STEPS) x = FG_TONE_STEPS;
  int i = (int)x;
  float step = tables->tone[i + 1] - tables->tone[i];
  *value = tables->tone[i] + (x - (float)i) * step;
  *rate = step * (FG_TONE_STEPS / 255.0f);
}

/* G, and its inverse. */
double fg_edge_count(double gamma, double light);
double fg_edge_light(double gamma, double count);

/* Count at an edge, where the light is the mean of both sides', for sides of given counts. */
double fg_edge_count_between(double gamma, const double counts[2]);

/* A mean profile across the strip. */
typedef struct fg_profile_bin {
  double across_px, value, count;
} fg_profile_bin;

/* Fit of one mean profile. */
typedef struct fg_profile_fit {
  fg_edge_shape shape;
  double edge_px[2];
  double gamma, u_gamma;
  double sd[FG_EDGE_SHAPE_VALUES]; /* of the shape's values, in the order of the struct */
  double noise;                    /* sd of one pixel, by the misfit */
  int good;                        /* 1: the fit converged to plausible values */
} fg_profile_fit;

/* Fits the model to a mean profile by damped Gauss-Newton; `fit` holds the start. gamma is fitted
 * when free_gamma is set, else held. Of the tables only the normal distribution is used. */
void fg_profile_fit_model(const fg_edge_tables *tables, const fg_profile_bin *bins, size_t count,
                          int free_gamma, fg_profile_fit *fit);

#ifdef __cplusplus
}
#endif
#endif

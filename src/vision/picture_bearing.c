/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Findings of profiles of many bearings: under- and overshoot, blur and shadow by direction. */
#include "vision/picture_profile.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/small_solve.h"
#include "core/spread.h"

enum { PROFILES_MIN = 8, BLUR_TERMS = 5 };

/* Ratio of the sd of a median to that of a mean. */
#define MEDIAN_OVER_MEAN 1.2533
/* Limits of an overshoot, which turns a profile back: the share of the contrast that moves a
 * strip's edges by their u, and standard deviations. */
#define TURN_SHARE     0.002
#define TURN_SIGMAS    6.0
#define TURN_OF_BLOCKS 0.015 /* ringing of edges in a JPEG */
/* Min share of it that profiles of opposite quarters of the bearings show each. */
#define QUARTER_SHARE 0.3
/* Max distance outwards; beyond it may lie the next object. */
#define TURN_MAX_PX 10.0
/* Max ratio of a flatbed's blur along the carriage to that across. */
#define BLUR_RATIO  1.6
#define BLUR_SIGMAS 5.0

typedef struct inspection {
  const fg_edge_profile *profiles;
  size_t count;
  double *scratch; /* one per profile */
  double blur_px;
  int quarter; /* of the bearings in use, -1: all */
} inspection;

/* Returns true when a profile faces one quarter of all bearings, whose middles are the axes. */
static bool is_in_quarter(double bearing, int quarter) {
  return quarter < 0 || fabs(remainder(bearing - quarter * M_PI / 2, 2 * M_PI)) <= M_PI / 4;
}

/* Median over the profiles of the share at one place, and its standard deviation. */
static double median_share(const inspection *in, size_t i, double *sd) {
  size_t n = 0, asked = 0;
  for (size_t k = 0; k < in->count; k++) {
    const fg_edge_profile *p = &in->profiles[k];
    if (!is_in_quarter(p->bearing, in->quarter)) continue;
    asked++;
    if (isnan(p->shares[i]) || -fg_share_px(i) > p->inside_px) continue;
    in->scratch[n++] = (double)p->shares[i];
  }
  *sd = NAN;
  if (n < PROFILES_MIN || 2 * n < asked) return NAN;
  double median = fg_select(in->scratch, n, n / 2);
  for (size_t k = 0; k < n; k++)
    in->scratch[k] = fabs(in->scratch[k] - median);
  *sd = MEDIAN_OVER_MEAN * fg_robust_sd(in->scratch, n) / sqrt((double)n);
  return median;
}

/* Size by which the mean profile turns back going away from the edge, inwards (way -1) or outwards.
 * An edge under any spread of light, with any tone curve, never turns back. */
static double find_turn(const double *shares, const double *sd, int way, double *u, int places[2]) {
  double extreme = -INFINITY, turn = 0, u_extreme = 0;
  int at_extreme = 0;
  *u = 0;
  int first = FG_SHARES_INSIDE + (way > 0 ? 0 : -1);
  for (int i = first; i >= 1 && i < FG_SHARES - 1; i += way) {
    double at = -way * (shares[i - 1] + shares[i] + shares[i + 1]) / 3;
    double here = sqrt((sd[i - 1] * sd[i - 1] + sd[i] * sd[i] + sd[i + 1] * sd[i + 1]) / 9);
    if (isnan(at) || fabs(fg_share_px((size_t)i)) > TURN_MAX_PX) break;
    if (at > extreme) {
      extreme = at;
      u_extreme = here;
      at_extreme = i;
    }
    if (extreme - at > turn) {
      turn = extreme - at;
      *u = hypot(u_extreme, here);
      places[0] = at_extreme;
      places[1] = i;
    }
  }
  return turn;
}

/* Size by which the profiles of one quarter of all bearings turn back between two places. */
static double turn_of_quarter(inspection *in, int quarter, const int places[2]) {
  double mean[2] = {0, 0}, sd;
  inspection part = *in;
  part.quarter = quarter;
  for (int k = 0; k < 2; k++)
    for (int i = places[k] - 1; i <= places[k] + 1; i++)
      mean[k] += median_share(&part, (size_t)i, &sd) / 3;
  return fabs(mean[1] - mean[0]);
}

/* Returns true when opposite quarters both turn back. Sharpening works on both sides of a
 * direction, a shadow on one. */
static bool is_two_sided(inspection *in, double turn, const int places[2]) {
  bool shown[4];
  for (int quarter = 0; quarter < 4; quarter++) {
    double part = turn_of_quarter(in, quarter, places);
    shown[quarter] = isnan(part) || part > QUARTER_SHARE * turn;
  }
  return (shown[0] && shown[2]) || (shown[1] && shown[3]);
}

static void inspect_turns(inspection *in, fg_picture_state *state) {
  double shares[FG_SHARES], sd[FG_SHARES], u[2];
  int places[2][2];
  for (size_t i = 0; i < FG_SHARES; i++)
    shares[i] = median_share(in, i, &sd[i]);
  double turns[2] = {find_turn(shares, sd, -1, &u[0], places[0]),
                     find_turn(shares, sd, 1, &u[1], places[1])};
  bool light = in->profiles[0].inside > in->profiles[0].outside;
  state->overshoot = turns[light ? 0 : 1];
  state->undershoot = turns[light ? 1 : 0];
  bool blocks = state->findings & FG_PICTURE_BLOCK_NOISE;
  for (int k = 0; k < 2; k++)
    if (turns[k] > (blocks ? TURN_OF_BLOCKS : TURN_SHARE) && turns[k] > TURN_SIGMAS * u[k] &&
        is_two_sided(in, turns[k], places[k]))
      state->findings |= FG_PICTURE_SHARPENED;
}

/* The variance of the blur over the bearing: an ellipse, and a blur of one side beside it. */
static void fill_blur_row(const fg_edge_profile *p, double *row) {
  const double values[BLUR_TERMS] = {1, cos(2 * p->bearing), sin(2 * p->bearing), cos(p->bearing),
                                     sin(p->bearing)};
  for (int k = 0; k < BLUR_TERMS; k++)
    row[k] = values[k];
}

static double blur_off(const fg_edge_profile *p, const double *x) {
  double row[BLUR_TERMS], sum = p->blur_px * p->blur_px;
  fill_blur_row(p, row);
  for (int k = 0; k < BLUR_TERMS; k++)
    sum -= row[k] * x[k];
  return sum;
}

static bool fit_blur(const inspection *in, double limit, double *x, double *u) {
  fg_normal_equations system;
  double row[BLUR_TERMS], inverse[FG_SMALL_MAX][FG_SMALL_MAX], squares = 0;
  size_t n = 0;
  fg_normal_clear(&system, BLUR_TERMS);
  for (size_t k = 0; k < in->count; k++) {
    const fg_edge_profile *p = &in->profiles[k];
    double off = blur_off(p, x);
    if (!(p->blur_px > 0) || fabs(off) > limit) continue;
    fill_blur_row(p, row);
    fg_normal_add(&system, row, p->blur_px * p->blur_px, 1);
    squares += off * off;
    n++;
  }
  if (n < 3 * BLUR_TERMS || !fg_normal_solve(&system, 0, x, inverse)) return false;
  *u = sqrt(squares / (double)n * fmax(inverse[1][1], inverse[2][2]));
  return true;
}

static double blur_limit(const inspection *in, const double *x) {
  size_t n = 0;
  for (size_t k = 0; k < in->count; k++)
    if (in->profiles[k].blur_px > 0) in->scratch[n++] = fabs(blur_off(&in->profiles[k], x));
  return fg_spread_limit(in->scratch, n, 4);
}

static void inspect_blur(const inspection *in, fg_picture_state *state) {
  double x[BLUR_TERMS] = {in->blur_px * in->blur_px}, u = 0, limit = INFINITY;
  for (int round = 0; round < 3; round++) {
    if (!fit_blur(in, limit, x, &u)) return;
    limit = blur_limit(in, x);
  }
  double half = hypot(x[1], x[2]), min = fmax(x[0] - half, 0.01 * x[0]);
  if (!(x[0] > 0) || u > 0.3 * x[0]) return;
  state->blur_px[0] = sqrt(x[0] + half);
  state->blur_px[1] = sqrt(min);
  double direction = 0.5 * atan2(x[2], x[1]) * 180 / M_PI;
  state->blur_direction_deg = direction < 0 ? direction + 180 : direction;
  if (x[0] + half > BLUR_RATIO * BLUR_RATIO * min && half > BLUR_SIGMAS * u)
    state->findings |= FG_PICTURE_UNEVEN_BLUR;
}

/* Mean share of the band beside an edge, from the end of its own blur, over the background's. */
static double band_of(const inspection *in, const fg_edge_profile *p) {
  double from = fg_band_from(fmax(in->blur_px, p->blur_px)), sum = 0, n = 0;
  for (size_t i = FG_SHARES_INSIDE; i < FG_SHARES; i++) {
    double at = fg_share_px(i);
    if (at < from || at > from + FG_BAND_PX || isnan(p->shares[i])) continue;
    sum += (double)p->shares[i];
    n++;
  }
  return n > 0 ? sum / n - (isnan(p->background) ? 0 : (double)p->background) : NAN;
}

static fg_status inspect_shadow(fg_context *ctx, const inspection *in, fg_picture_state *state) {
  fg_edge_band *bands = NULL;
  FG_TRY(fg_memory_allocate(ctx, in->count, sizeof *bands, (void **)&bands));
  for (size_t k = 0; k < in->count; k++)
    bands[k] = (fg_edge_band){in->profiles[k].bearing, band_of(in, &in->profiles[k])};
  fg_status status = fg_picture_inspect_bands(ctx, bands, in->count, state);
  free(bands);
  return status;
}

static double median_blur(const inspection *in) {
  size_t n = 0;
  for (size_t k = 0; k < in->count; k++)
    if (in->profiles[k].blur_px > 0) in->scratch[n++] = in->profiles[k].blur_px;
  return n ? fg_select(in->scratch, n, n / 2) : 1;
}

fg_status fg_picture_inspect_profiles(fg_context *ctx, const fg_edge_profile *profiles,
                                      size_t count, fg_picture_state *state) {
  inspection in = {.profiles = profiles, .count = count, .quarter = -1};
  if (count < PROFILES_MIN) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *in.scratch, (void **)&in.scratch));
  in.blur_px = median_blur(&in);
  inspect_turns(&in, state);
  inspect_blur(&in, state);
  fg_status status = inspect_shadow(ctx, &in, state);
  free(in.scratch);
  return status;
}

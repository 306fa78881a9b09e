/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A shadow or a lit wall beside the edges of some bearings. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/small_solve.h"
#include "core/spread.h"
#include "vision/picture_profile.h"

enum { BANDS_MIN = 8, PER_BEARING_MIN = 3, BASIS_TERMS = 5 };

/* Ratio of the sd of a median to that of a mean. */
#define MEDIAN_OVER_MEAN 1.2533
/* Min band: the share of the contrast that moves edges by their u. Where the light changes over the
 * picture the background beside an edge is less certain, by this share of its range. */
#define BAND_SHARE   0.015
#define BAND_SHADING 0.02
#define BAND_SIGMAS  5.0

typedef struct inspection {
  const fg_edge_band *bands;
  size_t count;
  double *scratch; /* one per band */
  double window;   /* half of the bearings that are one direction of a shadow, rad */
} inspection;

/* Standard deviation of one band from the differences of neighbours: a shadow changes slowly. */
static double noise_of_neighbours(const inspection *in) {
  size_t n = 0;
  for (size_t k = 0; k + 2 < in->count; k++) {
    double step = in->bands[k + 2].share - in->bands[k].share;
    if (!isnan(step)) in->scratch[n++] = fabs(step);
  }
  return n ? M_SQRT1_2 * fg_robust_sd(in->scratch, n) : INFINITY;
}

static void fill_basis_row(double bearing, double *row) {
  const double values[BASIS_TERMS] = {1, cos(bearing), sin(bearing), cos(2 * bearing),
                                      sin(2 * bearing)};
  for (int k = 0; k < BASIS_TERMS; k++)
    row[k] = values[k];
}

/* Standard deviation from the residuals about a smooth curve over the bearing: where a foil is few
 * pixels long its neighbours face bearings that are far apart. */
static double noise_about_fit(const inspection *in) {
  fg_normal_equations system;
  double row[BASIS_TERMS], x[FG_SMALL_MAX];
  size_t n = 0;
  fg_normal_clear(&system, BASIS_TERMS);
  for (size_t k = 0; k < in->count; k++) {
    if (isnan(in->bands[k].share)) continue;
    fill_basis_row(in->bands[k].bearing, row);
    fg_normal_add(&system, row, in->bands[k].share, 1);
    n++;
  }
  if (n < 2 * BASIS_TERMS || !fg_normal_solve(&system, 0, x, NULL)) return INFINITY;
  n = 0;
  for (size_t k = 0; k < in->count; k++) {
    double off = in->bands[k].share;
    if (isnan(off)) continue;
    fill_basis_row(in->bands[k].bearing, row);
    for (int i = 0; i < BASIS_TERMS; i++)
      off -= row[i] * x[i];
    in->scratch[n++] = fabs(off);
  }
  return fg_robust_sd(in->scratch, n) * sqrt((double)n / (double)(n - BASIS_TERMS));
}

/* Median of the bands that face a bearing within one step, and their number. */
static double band_at(const inspection *in, double bearing, size_t *n) {
  *n = 0;
  for (size_t k = 0; k < in->count; k++) {
    double off = remainder(in->bands[k].bearing - bearing, 2 * M_PI);
    if (fabs(off) <= in->window && !isnan(in->bands[k].share))
      in->scratch[(*n)++] = in->bands[k].share;
  }
  return *n < PER_BEARING_MIN ? NAN : fg_select(in->scratch, *n, *n / 2);
}

/* Depth at a bearing of too few bands: the deeper of the nearest known ones on either side. */
static double depth_near(const double *depths, int i) {
  double deepest = 0;
  for (int way = -1; way <= 1; way += 2)
    for (int k = 0; k < FG_PICTURE_BEARINGS; k++) {
      double depth = depths[(i + way * k + FG_PICTURE_BEARINGS) % FG_PICTURE_BEARINGS];
      if (isnan(depth)) continue;
      if (fabs(depth) > fabs(deepest)) deepest = depth;
      break;
    }
  return deepest;
}

static void inspect_shadow(const inspection *in, fg_picture_state *state) {
  double depths[FG_PICTURE_BEARINGS], u = 0;
  double shading = isnan(state->shading) ? 0 : state->shading;
  size_t n = 0;
  for (size_t k = 0; k < in->count; k++)
    if (!isnan(in->bands[k].share)) in->scratch[n++] = in->bands[k].share;
  if (n < BANDS_MIN) return;
  double usual = fg_select(in->scratch, n, n / 2);
  double noise = fmin(noise_of_neighbours(in), noise_about_fit(in));
  for (int i = 0; i < FG_PICTURE_BEARINGS; i++) {
    double bearing = i * 2 * M_PI / FG_PICTURE_BEARINGS;
    double depth = band_at(in, bearing, &n) - usual;
    depths[i] = depth;
    if (isnan(depth) || fabs(depth) <= fabs(state->shadow)) continue;
    state->shadow = depth;
    state->shadow_direction_deg = bearing * 180 / M_PI;
    u = MEDIAN_OVER_MEAN * noise / sqrt((double)n);
  }
  if (!(fabs(state->shadow) > BAND_SHARE + BAND_SHADING * shading &&
        fabs(state->shadow) > BAND_SIGMAS * u))
    return;
  state->findings |= FG_PICTURE_SHADOW;
  for (int i = 0; i < FG_PICTURE_BEARINGS; i++)
    state->shadow_at[i] = depth_near(depths, i);
}

fg_status fg_picture_inspect_bands(fg_context *ctx, const fg_edge_band *bands, size_t count,
                                   fg_picture_state *state) {
  inspection in = {.bands = bands, .count = count};
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *in.scratch, (void **)&in.scratch));
  in.window = 2 * M_PI * fmax(1.0 / FG_PICTURE_BEARINGS, 1.6 / (double)count);
  inspect_shadow(&in, state);
  free(in.scratch);
  return FG_OK;
}

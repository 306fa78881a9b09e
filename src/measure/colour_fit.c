/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/colour_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/correlation.h"
#include "core/memory.h"
#include "core/select.h"
#include "core/small_solve.h"

/* Limit of an outlier in standard deviations (by the median): dust, or a foreign object. */
#define OUTLIER_SIGMAS 4.5
#define ROUNDS         8
/* Number of neighbours for the correlation: some 0.1 to 0.2 mm of edge. */
enum { LAGS = 12 };
#define MEDIAN_TO_SD 1.4826

/* Median of a channel's noise variance, or of its contrast, over the cross-sections it shows. */
static fg_status median_of(fg_context *ctx, const fg_colour_stations *stations, int channel,
                           bool noise, double *median) {
  double *values;
  size_t count = 0;
  *median = NAN;
  FG_TRY(fg_memory_allocate(ctx, stations->count, sizeof *values, (void **)&values));
  for (size_t i = 0; i < stations->count; i++) {
    const fg_colour_place *place = &stations->list[i].place[channel];
    if (place->good) values[count++] = noise ? place->noise : place->contrast;
  }
  if (count) *median = fg_select(values, count, count / 2);
  free(values);
  return FG_OK;
}

double fg_colour_contrast(fg_context *ctx, const fg_colour_stations *stations, int channel) {
  double contrast, noise;
  if (median_of(ctx, stations, channel, false, &contrast) != FG_OK ||
      median_of(ctx, stations, channel, true, &noise) != FG_OK || isnan(contrast))
    return 0;
  /* Rounding to whole counts is noise as well: a picture without noise does not have infinite
   * contrast. */
  return fabs(contrast) / sqrt(fmax(noise, 1.0 / 12));
}

static fg_colour_row row_of(const fg_colour_station *s, int against, int channel,
                            const double noise[2], const double pixel_mm[2]) {
  const fg_colour_place *one = &s->place[channel], *other = &s->place[against];
  double variance = noise[0] * one->variance + noise[1] * other->variance;
  return (fg_colour_row){.x_mm = s->x * pixel_mm[0],
                         .y_mm = s->y * pixel_mm[1],
                         .nx = s->nx,
                         .ny = s->ny,
                         .bend = s->bend,
                         .value = one->shift_px - other->shift_px,
                         .weight = 1 / variance,
                         .part = s->part,
                         .used = isfinite(1 / variance)};
}

fg_status fg_colour_rows_build(fg_context *ctx, const fg_colour_stations *stations, int against,
                               int channel, const double dpi[2], fg_colour_rows *rows) {
  double noise[2], sum = 0;
  *rows =
      (fg_colour_rows){.pixel_mm = {25.4 / dpi[0], 25.4 / dpi[1]}, .scatter = 1, .correlation = 1};
  FG_TRY(median_of(ctx, stations, channel, true, &noise[0]));
  FG_TRY(median_of(ctx, stations, against, true, &noise[1]));
  for (int i = 0; i < 2; i++)
    noise[i] = fmax(noise[i], 1e-6); /* without noise the residuals decide */
  FG_TRY(fg_memory_allocate(ctx, stations->count, sizeof *rows->list, (void **)&rows->list));
  FG_TRY(fg_memory_allocate(ctx, stations->count, sizeof *rows->sizes, (void **)&rows->sizes));
  rows->unknowns =
      stations->count && stations->list[0].outlier ? FG_COLOUR_UNKNOWNS : FG_COLOUR_SWELL;
  for (size_t i = 0; i < stations->count; i++) {
    const fg_colour_station *s = &stations->list[i];
    if (!s->place[against].good || !s->place[channel].good) continue;
    rows->list[rows->count++] = row_of(s, against, channel, noise, rows->pixel_mm);
    sum += rows->list[rows->count - 1].x_mm;
  }
  rows->x0_mm = rows->count ? sum / (double)rows->count : 0;
  return FG_OK;
}

void fg_colour_rows_free(fg_colour_rows *rows) {
  free(rows->list);
  free(rows->sizes);
  rows->list = NULL;
  rows->sizes = NULL;
  rows->count = 0;
}

void fg_colour_row_coefficients(const fg_colour_rows *rows, const fg_colour_row *row,
                                double to[FG_COLOUR_UNKNOWNS]) {
  double x = row->x_mm - rows->x0_mm;
  to[FG_COLOUR_DX] = row->nx;
  to[FG_COLOUR_MAGNIFICATION] = row->nx * x;
  to[FG_COLOUR_DY] = row->ny;
  to[FG_COLOUR_SKEW] = row->ny * x;
  to[FG_COLOUR_SWELL] = rows->unknowns > FG_COLOUR_SWELL;
}

static double residual_of(const fg_colour_rows *rows, const fg_colour_row *row) {
  double a[FG_COLOUR_UNKNOWNS], rest = row->value;
  fg_colour_row_coefficients(rows, row, a);
  for (size_t k = 0; k < rows->unknowns; k++)
    rest -= a[k] * rows->values[k];
  return rest;
}

static bool solve_unknowns(fg_colour_rows *rows) {
  double inverse[FG_SMALL_MAX][FG_SMALL_MAX], a[FG_COLOUR_UNKNOWNS];
  fg_normal_equations system;
  size_t used = 0;
  fg_normal_clear(&system, rows->unknowns);
  for (size_t i = 0; i < rows->count; i++) {
    const fg_colour_row *row = &rows->list[i];
    if (!row->used) continue;
    fg_colour_row_coefficients(rows, row, a);
    fg_normal_add(&system, a, row->value, row->weight);
    used++;
  }
  rows->values[FG_COLOUR_SWELL] = 0;
  if (used <= 2 * FG_COLOUR_UNKNOWNS || !fg_normal_solve(&system, 0, rows->values, inverse))
    return false;
  for (size_t i = 0; i < rows->unknowns; i++)
    for (size_t k = 0; k < rows->unknowns; k++)
      rows->covariance[i][k] = inverse[i][k];
  return true;
}

size_t fg_colour_rows_keep(fg_colour_rows *rows, double sigmas) {
  size_t changed = 0;
  if (!rows->count) return 0;
  for (size_t i = 0; i < rows->count; i++)
    rows->sizes[i] = rows->list[i].size;
  double limit = sigmas * MEDIAN_TO_SD * fg_select(rows->sizes, rows->count, rows->count / 2);
  for (size_t i = 0; i < rows->count; i++) {
    bool used = rows->list[i].size <= limit;
    changed += used != rows->list[i].used;
    rows->list[i].used = used;
  }
  return changed;
}

static size_t drop_outliers(fg_colour_rows *rows) {
  for (size_t i = 0; i < rows->count; i++) {
    fg_colour_row *row = &rows->list[i];
    row->size = fabs(residual_of(rows, row)) * sqrt(row->weight);
  }
  return fg_colour_rows_keep(rows, OUTLIER_SIGMAS);
}

void fg_colour_rows_scatter(fg_colour_rows *rows, double (*drift)(const void *user, double y_mm),
                            const void *user) {
  double products[LAGS] = {0}, pairs[LAGS] = {0}, used = 0;
  for (size_t i = 0; i < rows->count; i++) {
    fg_colour_row *row = &rows->list[i];
    row->size = (residual_of(rows, row) - row->ny * drift(user, row->y_mm)) * sqrt(row->weight);
    for (size_t lag = 0; row->used && lag < LAGS && lag <= i; lag++) {
      const fg_colour_row *before = row - lag;
      if (!before->used || before->part != row->part) continue;
      products[lag] += row->size * before->size;
      pairs[lag]++;
    }
    used += row->used;
  }
  rows->scatter = products[0] / fmax(1, used - (double)rows->unknowns);
  rows->correlation = fg_correlation_integral(products, pairs, LAGS);
}

static bool fit_unknowns(fg_colour_rows *rows) {
  bool fine = rows->count > 0 && solve_unknowns(rows);
  for (int round = 0; round < ROUNDS && fine && drop_outliers(rows); round++)
    fine = solve_unknowns(rows);
  return fine;
}

/* Corrects the shift along a bent strip, which appears along its normal, too: n = bend t² / 2 moved
 * by (t, n) passes t = 0 at n + bend t² / 2. In a fillet that is some 0.003 px. */
static void correct_bends(fg_colour_rows *rows) {
  const double *v = rows->values;
  for (size_t i = 0; i < rows->count; i++) {
    fg_colour_row *row = &rows->list[i];
    double x = row->x_mm - rows->x0_mm;
    double dx = v[FG_COLOUR_DX] + x * v[FG_COLOUR_MAGNIFICATION];
    double dy = v[FG_COLOUR_DY] + x * v[FG_COLOUR_SKEW];
    double along = dy * row->nx - dx * row->ny;
    row->value -= 0.5 * row->bend * along * along;
  }
}

bool fg_colour_rows_fit(fg_colour_rows *rows) {
  if (!fit_unknowns(rows)) return false;
  correct_bends(rows);
  return fit_unknowns(rows);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/colour.h"

#include <math.h>

#include "measure/colour_drift.h"
#include "measure/colour_fit.h"
#include "measure/colour_read.h"

enum { RED, GREEN, BLUE, CHANNELS, ROWS_MIN = 30 };
/* Min ratio of contrast to noise of a channel that shows edges. */
#define CONTRAST_MIN 4.0
/* Min factor of correlation. Cross-sections meet the pixels at phases that change slowly along an
 * edge, which short lags do not show: with a smaller factor the intervals hold too seldom
 * (reports/colour_lines.md). */
#define CORRELATION_MIN 1.25
/* Min distance of channels that are reported apart, in u. */
#define APART_SIGMAS 3.0

/* Returns the channel that others are compared with: the measured one; green where the mean of all
 * was measured. */
static int choose_reference(const fg_measurement *m) {
  return m->file.channel == FG_CHANNEL_LUMINANCE ? GREEN : (int)m->file.channel - FG_CHANNEL_RED;
}

static void clear_shift(int channel, fg_colour_state state, fg_colour_shift *shift) {
  double none = state == FG_COLOUR_IDENTICAL ? 0 : NAN;
  *shift = (fg_colour_shift){.channel = (fg_channel)(FG_CHANNEL_RED + channel),
                             .state = state,
                             .dx_px = none,
                             .dy_px = none,
                             .magnification_ppm = none,
                             .skew_ppm = none,
                             .largest_px = none,
                             .rms_um = none,
                             .drift_rms_um = none,
                             .u_dx_px = NAN,
                             .u_dy_px = NAN,
                             .u_magnification_ppm = NAN,
                             .u_skew_ppm = NAN,
                             .correlation = NAN,
                             .p_constant = NAN};
}

static double u_of(const fg_colour_rows *rows, int unknown) {
  double correlation = fmax(CORRELATION_MIN, rows->correlation);
  return sqrt(rows->covariance[unknown][unknown] * rows->scatter * correlation);
}

/* Largest distance along x within the measured parts. */
static double find_largest(const fg_colour_rows *rows) {
  const double *v = rows->values;
  double largest = 0;
  for (size_t i = 0; i < rows->count; i++) {
    if (!rows->list[i].used) continue;
    double x = rows->list[i].x_mm - rows->x0_mm;
    largest = fmax(largest, hypot(v[FG_COLOUR_DX] + x * v[FG_COLOUR_MAGNIFICATION],
                                  v[FG_COLOUR_DY] + x * v[FG_COLOUR_SKEW]));
  }
  return largest;
}

static void fill_shift(const fg_colour_rows *rows, fg_colour_shift *shift) {
  const double *v = rows->values, um = 1e3 * sqrt(rows->pixel_mm[0] * rows->pixel_mm[1]);
  double ppm[2] = {1e6 * rows->pixel_mm[0], 1e6 * rows->pixel_mm[1]}, weight = 0;
  shift->dx_px = v[FG_COLOUR_DX];
  shift->dy_px = v[FG_COLOUR_DY];
  shift->u_dx_px = u_of(rows, FG_COLOUR_DX);
  shift->u_dy_px = u_of(rows, FG_COLOUR_DY);
  shift->magnification_ppm = ppm[0] * v[FG_COLOUR_MAGNIFICATION];
  shift->u_magnification_ppm = ppm[0] * u_of(rows, FG_COLOUR_MAGNIFICATION);
  shift->skew_ppm = ppm[1] * v[FG_COLOUR_SKEW];
  shift->u_skew_ppm = ppm[1] * u_of(rows, FG_COLOUR_SKEW);
  shift->largest_px = find_largest(rows);
  shift->correlation = rows->correlation;
  shift->stations = 0;
  for (size_t i = 0; i < rows->count; i++) {
    shift->stations += rows->list[i].used;
    weight += rows->list[i].used ? rows->list[i].weight : 0;
  }
  shift->rms_um = um * sqrt(rows->scatter * (double)shift->stations / weight);
}

static fg_status compare_pair(fg_context *ctx, const fg_colour_stations *stations,
                              const fg_measurement *m, int against, int channel,
                              fg_colour_shift *shift, double *x0_mm) {
  fg_colour_rows rows = {0};
  fg_status status = fg_colour_rows_build(ctx, stations, against, channel, m->dpi, &rows);
  bool told = status == FG_OK && rows.count >= ROWS_MIN && fg_colour_rows_fit(&rows);
  clear_shift(channel, FG_COLOUR_MEASURED, shift);
  if (told) status = fg_colour_drift_find(ctx, &rows, shift, &told);
  if (told)
    fill_shift(&rows, shift);
  else
    clear_shift(channel, FG_COLOUR_FEW_EDGES, shift);
  *x0_mm = rows.x0_mm;
  fg_colour_rows_free(&rows);
  return status;
}

/* Returns true when two channels hold the same pixels: of red and green, green and blue, blue and
 * red. */
static bool is_same(const bool same[CHANNELS], int one, int other) {
  return same[(one + 1) % CHANNELS == other ? one : other];
}

/* Compares each other channel with the reference, and the two others with each other. */
static bool find_apart(const fg_colour_lines *lines) {
  const fg_colour_shift *a = &lines->shifts[0], *b = &lines->shifts[1];
  double largest = 0, between = hypot(a->dx_px - b->dx_px, a->dy_px - b->dy_px), u = 0;
  for (int k = 0; k < 2; k++) {
    const fg_colour_shift *shift = &lines->shifts[k];
    if (shift->state != FG_COLOUR_MEASURED) continue;
    double sd = hypot(shift->u_dx_px, shift->u_dy_px);
    if (shift->largest_px > APART_SIGMAS * sd) largest = fmax(largest, shift->largest_px);
    u = hypot(u, sd);
  }
  if (isfinite(between) && between > APART_SIGMAS * u) largest = fmax(largest, between);
  return largest > FG_COLOUR_APART_PX;
}

static fg_status compare_all(fg_context *ctx, const fg_colour_stations *stations,
                             const bool same[CHANNELS], fg_measurement *m) {
  fg_colour_lines *lines = &m->colour_lines;
  double contrast[CHANNELS];
  int next = 0;
  for (int channel = 0; channel < CHANNELS; channel++)
    contrast[channel] = fg_colour_contrast(ctx, stations, channel);
  int against = choose_reference(m);
  lines->seen = true;
  lines->against = (fg_channel)(FG_CHANNEL_RED + against);
  for (int channel = 0; channel < CHANNELS; channel++) {
    if (channel == against) continue;
    fg_colour_shift *shift = &lines->shifts[next++];
    if (is_same(same, against, channel))
      clear_shift(channel, FG_COLOUR_IDENTICAL, shift);
    else if (fmin(contrast[channel], contrast[against]) < CONTRAST_MIN)
      clear_shift(channel, FG_COLOUR_NO_CONTRAST, shift);
    else
      FG_TRY(compare_pair(ctx, stations, m, against, channel, shift, &lines->x0_mm));
  }
  lines->apart = find_apart(lines);
  return FG_OK;
}

fg_status fg_colour_measure(fg_context *ctx, fg_scan *scan, size_t memory_cap, unsigned threads,
                            fg_measurement *m) {
  fg_colour_stations stations;
  fg_budget budget = {.name = m->scan, .limit = memory_cap};
  bool same[CHANNELS];
  if (!fg_scan_has_colours(scan)) return FG_OK;
  FG_TRY(fg_colour_stations_choose(ctx, m, &stations));
  fg_status status = FG_OK;
  if (stations.count) status = fg_colour_read(ctx, scan, &budget, threads, &stations, same);
  if (stations.count && status == FG_OK) status = compare_all(ctx, &stations, same, m);
  fg_colour_stations_free(&stations);
  return status;
}

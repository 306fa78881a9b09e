/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/measure.h"
#include "core/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/date.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/scan.h"
#include "measure/again.h"
#include "measure/colour.h"
#include "measure/discs.h"
#include "measure/gauges.h"
#include "measure/grids.h"
#include "measure/level.h"
#include "measure/picture_gather.h"
#include "measure/reader.h"
#include "measure/session.h"

/* Limits of resolutions: a stated one contradicts the file's beyond this share of it; x and y
 * differ beyond this logarithm of their ratio. Less is a scanner's own scale, as calibrated. */
#define CONTRADICTION 0.005
#define UNEQUAL       0.05
/* Min width of a strip that is surely found, px. */
#define STRIP_MIN_PX     2.0
#define MEMORY_CAP_BYTES ((size_t)FG_MEASURE_MEMORY_CAP_MIB << 20)

static size_t memory_cap(const fg_measure_options *options) {
  return options->memory_cap ? options->memory_cap : MEMORY_CAP_BYTES;
}

/* Data of fg_reader_run's visitor. */
typedef struct visit {
  fg_session *session;
  const fg_measure_options *options;
} visit;

static fg_status visit_strip(fg_context *ctx, fg_tiles *tiles, void *data) {
  const visit *v = data;
  FG_TRY(fg_session_advance(ctx, tiles, v->session));
  if (v->options->progress)
    v->options->progress(v->options->progress_user,
                         tiles->received < tiles->rows ? (int64_t)tiles->received * FG_TILE_PX
                                                       : tiles->height_px,
                         tiles->height_px);
  return FG_OK;
}

static fg_status fail_without_beams(fg_context *ctx, const fg_measurement *m) {
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: no foil with beams in the picture (%zu other objects or specks): form "
                 "cantilever is a flat foil with beams of about %g × %g mm that are free at one "
                 "end; is it that foil, is the design right, or the resolution of %g dpi wrong?",
                 m->scan, m->specks, m->design.beams.length_mm, m->design.beams.width_mm,
                 m->dpi[0]);
}

/* Explains an empty scan: it may hold 12 bits in samples of 16, the strip may be too thin for this
 * resolution, or the resolution wrong. */
static fg_status fail_empty(fg_context *ctx, const fg_measurement *m, const fg_tiles *tiles) {
  double brightest = 257.0 * tiles->brightest;
  if (m->file.bit_depth == 16 && brightest < 4096)
    return fg_fail(
        ctx, FG_ERR_DATA,
        "%s: no foil in the picture (%zu speck%s or other objects); its brightest place "
        "has %.0f of 65535: are they 12 bits in a file of 16? if so, multiply all values "
        "by 16",
        m->scan, m->specks, fg_plural(m->specks), brightest);

  if (fg_foil_traits_of(m->design.kind)->lies_flat) return fail_without_beams(ctx, m);
  double dpi = fmin(m->dpi[0], m->dpi[1]), width_px = m->design.thickness_mm * dpi / 25.4;
  if (width_px >= STRIP_MIN_PX)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: no foil in the picture (%zu speck%s or other objects); is the scan empty, "
                   "or the resolution of %g dpi wrong?",
                   m->scan, m->specks, fg_plural(m->specks), m->dpi[0]);
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: no foil in the picture (%zu speck%s or other objects): at %g dpi a strip of "
                 "%g mm is %.1f pixels wide; is the resolution of %g dpi wrong? if not, scan at "
                 "%.0f dpi or more, where it is %g",
                 m->scan, m->specks, fg_plural(m->specks), dpi, m->design.thickness_mm, width_px,
                 dpi, 100 * ceil(STRIP_MIN_PX * 0.254 / m->design.thickness_mm), STRIP_MIN_PX);
}

static fg_status measure_foils(fg_context *ctx, fg_scan *scan, const fg_measure_options *options,
                               fg_measurement *m) {
  fg_budget budget = {.name = m->scan, .limit = memory_cap(options)};
  fg_tiles tiles = {0};
  visit v = {.options = options};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_budget_reserve(ctx, &budget, (size_t)fg_scan_get_info(scan)->memory_bytes));
  FG_TRY_EXIT(fg_session_create(ctx, m, options->threads, !options->without_plain, &v.session));
  FG_TRY_EXIT(fg_reader_run(ctx, scan, visit_strip, &v, &budget, &tiles, m->sha256));
  FG_TRY_EXIT(fg_session_finish(ctx, v.session));
  if (m->foil_count == 0) status = fail_empty(ctx, m, &tiles);
exit:
  fg_session_free(v.session);
  fg_tiles_free(&tiles);
  return status;
}

/* Keeps reading: a part with round features may fill the scan, and all its tiles are kept to the
 * end. */
static fg_status keep_reading(fg_context *ctx, fg_tiles *tiles, void *data) {
  (void)ctx;
  (void)tiles;
  (void)data;
  return FG_OK;
}

/* Matches gauges of a scan of discs; they are discs, and stay among them. */
static fg_status match_discs(fg_context *ctx, fg_measurement *m) {
  fg_gauge_sightings sightings = {0};
  if (!m->design.gauge_count) return FG_OK;
  fg_status status = fg_gauge_find_discs(ctx, m, &sightings);
  if (status == FG_OK) fg_gauges_match(&sightings, m);
  free(sightings.list);
  return status;
}

/* Discs or marks. */
static fg_status measure_features(fg_context *ctx, fg_scan *scan, const fg_measure_options *options,
                                  fg_measurement *m) {
  fg_budget budget = {.name = m->scan, .limit = memory_cap(options)};
  fg_tiles tiles = {0};
  FG_TRY(fg_budget_reserve(ctx, &budget, (size_t)fg_scan_get_info(scan)->memory_bytes));
  fg_status status = fg_reader_run(ctx, scan, keep_reading, NULL, &budget, &tiles, m->sha256);
  bool is_grid = fg_foil_traits_of(m->design.kind)->is_grid;
  if (status == FG_OK)
    status = (is_grid ? fg_measure_grid : fg_measure_discs)(ctx, &tiles, options->threads, m);
  if (status == FG_OK && !is_grid) status = match_discs(ctx, m);
  fg_tiles_free(&tiles);
  return status;
}

static fg_status open_scan(fg_context *ctx, const char *path, const fg_measure_options *options,
                           fg_scan **scan, fg_measurement *m) {
  const fg_scan_options scan_options = {.dpi = options->dpi,
                                        .pixel_cap = options->pixel_cap,
                                        .memory_cap = memory_cap(options),
                                        .channel = options->channel,
                                        .allow_lossy = options->allow_lossy,
                                        .only_file = options->only_file,
                                        .threads = options->threads,
                                        .failed_sha256 = options->sum_failed ? m->sha256 : NULL};
  FG_TRY(fg_scan_open(ctx, path, &scan_options, scan));
  const fg_scan_info *info = fg_scan_get_info(*scan);
  snprintf(m->scan, sizeof m->scan, "%s", path);
  if (fg_scan_is_file(*scan)) fg_date_of_file(path, m->date);
  m->file = *info;
  snprintf(m->warning, sizeof m->warning, "%s", info->warning);
  memcpy(m->dpi, info->dpi, sizeof m->dpi);
  return FG_OK;
}

/* Clears the measurement but for the sum of the file, if requested. */
static void clear_failed(const fg_measure_options *options, fg_scan *scan, fg_measurement *m) {
  char sum[65] = "";
  if (!options->sum_failed) {
    fg_measurement_free(m);
    return;
  }
  bool known = m->sha256[0] ||
               (scan && fg_scan_is_file(scan) && fg_scan_sha256(NULL, scan, m->sha256) == FG_OK);
  if (known && (!scan || fg_scan_check_unchanged(NULL, scan) == FG_OK))
    memcpy(sum, m->sha256, sizeof sum);
  fg_measurement_free(m);
  memcpy(m->sha256, sum, sizeof sum);
}

/* Checks the resolution: a note of the scan, and a flag of its foils. */
static unsigned check_resolution(fg_measurement *m) {
  unsigned flags = 0;
  for (int axis = 0; axis < 2; axis++)
    if (fabs(m->file.averaged[axis] * m->dpi[axis] / m->file.dpi_file[axis] - 1) > CONTRADICTION)
      flags |= FG_FOIL_RESOLUTION_CONTRADICTS_FILE;
  if (fabs(log(m->dpi[0] / m->dpi[1])) > UNEQUAL) flags |= FG_FOIL_UNEQUAL_RESOLUTION;
  if (m->warning[0]) return flags;
  if (flags & FG_FOIL_RESOLUTION_CONTRADICTS_FILE)
    snprintf(m->warning, sizeof m->warning,
             "measured at %.6g dpi as was given, but the file says %.6g × %.6g", m->dpi[0],
             m->file.dpi_file[0], m->file.dpi_file[1]);
  else if (flags)
    snprintf(m->warning, sizeof m->warning, "the resolutions along x and y differ: %.6g × %.6g dpi",
             m->dpi[0], m->dpi[1]);
  return flags;
}

/* Refers lengths to 20 °C: scales the edges as they were found. A new search with other pixels
 * would find other stations, and move a radius by as much as its u. */
static fg_status refer_lengths(fg_context *ctx, unsigned threads, fg_measurement *m) {
  double factor = fg_calibration_factor(&m->design.calibration);
  const double factors[2] = {factor, factor};
  fg_measurement again;
  if (factor == 1) return FG_OK;
  FG_TRY(fg_measure_stretched(ctx, m, factors, threads, &again));
  for (int i = 0; i < 2; i++)
    again.dpi[i] /= factor;
  fg_measurement_free(m);
  *m = again;
  return FG_OK;
}

/* Refers the gauges' lengths to 20 °C, like the parts'. */
static void refer_gauges(fg_measurement *m) {
  double factor = fg_calibration_factor(&m->design.calibration);
  for (size_t i = 0; i < m->design.gauge_count; i++) {
    fg_gauge_reading *gauge = &m->gauges[i];
    gauge->measured_mm *= factor;
    gauge->u_measured_mm *= factor;
    gauge->blur_mm *= factor;
  }
}

/* Returns what happens where no gauge is used. */
static const char *without_gauges(const fg_design *design) {
  if (design->tone == FG_TONE_LINEAR || design->thickness_measured_mm > 0)
    return "the other statement of the design stands";
  return "widths keep the uncertainty of an unknown tone curve";
}

/* Notes the gauges when nothing else is odd, with the reason of the first that is not used. */
static void note_gauges(fg_measurement *m) {
  const fg_gauge_reading *reading = NULL;
  size_t found = 0, used = 0, count = m->design.gauge_count;
  for (size_t i = 0; i < count; i++) {
    found += m->gauges[i].found;
    used += m->gauges[i].used;
    if (!reading && !m->gauges[i].used) reading = &m->gauges[i];
  }
  if (m->warning[0] || (!reading && !m->gauges_contradict)) return;
  if (m->gauges_contradict)
    snprintf(m->warning, sizeof m->warning,
             "the gauges on the glass contradict each other: uncertainties are wider for it");
  else
    fg_text_clip(m->warning, sizeof m->warning, "%zu of %zu stated gauges found, %zu used (%s): %s",
                 found, count, used, reading->note,
                 used ? "the others tell nothing" : without_gauges(&m->design));
}

/* Notes a stated thickness that the scan contradicts when nothing else is odd. */
static void note_contradiction(fg_measurement *m) {
  for (size_t i = 0; i < m->foil_count && !m->warning[0]; i++)
    if (m->foils[i].flags & FG_FOIL_THICKNESS_CONTRADICTS)
      snprintf(m->warning, sizeof m->warning,
               "the scan shows a thickness of %.4f mm, and %.4f mm is stated as measured: one of "
               "them is wrong, and u holds the difference",
               m->foils[i].thickness.scan_mm, m->design.thickness_measured_mm);
}

/* Moves all edges to the level given by the gauges on the glass. */
static fg_status use_gauges(fg_context *ctx, unsigned threads, fg_measurement *m) {
  fg_level level;
  if (!m->design.gauge_count) return FG_OK;
  refer_gauges(m);
  if (fg_level_of_gauges(m, &level)) FG_TRY(fg_level_apply(ctx, &level, threads, m));
  note_gauges(m);
  return FG_OK;
}

/* Notes JPEG's loss when nothing else is odd, and flags all measured parts. */
static void note_loss(fg_measurement *m) {
  for (size_t i = 0; i < m->foil_count; i++)
    m->foils[i].flags |= FG_FOIL_LOSSY;
  for (size_t i = 0; i < m->disc_count; i++)
    m->discs[i].flags |= FG_BUMP_LOSSY;
  if (!m->warning[0])
    snprintf(
        m->warning, sizeof m->warning,
        "compressed with loss (JPEG, quality %d): edges have moved, and uncertainties are wider "
        "for it",
        m->file.jpeg_quality);
}

/* Notes channels apart when nothing else is odd. */
static void note_apart(fg_measurement *m) {
  const fg_colour_lines *lines = &m->colour_lines;
  double max = 0;
  for (int k = 0; k < 2; k++)
    max = fmax(max, lines->shifts[k].largest_px); /* fmax prefers the number to NaN */
  if (m->warning[0]) return;
  if (m->file.channel == FG_CHANNEL_LUMINANCE)
    snprintf(
        m->warning, sizeof m->warning,
        "the colour channels lie %.2f px apart, and their mean was measured: edges are blurred "
        "and moved; measure one channel (--channel green), do not convert to gray",
        max);
  else
    snprintf(m->warning, sizeof m->warning,
             "the colour channels lie %.2f px apart: one was measured; do not average channels or "
             "convert the scan to gray",
             max);
}

fg_status fg_measure_scan(fg_context *ctx, const char *path, const fg_design *design,
                          const fg_measure_options *options, fg_measurement *measurement) {
  static const fg_measure_options defaults = {0};
  fg_scan *scan = NULL;
  fg_status status = FG_OK;
  memset(measurement, 0, sizeof *measurement);
  measurement->design = *design;
  if (!options) options = &defaults;
  FG_TRY_EXIT(fg_design_derive(ctx, design, &measurement->nominal));
  FG_TRY_EXIT(open_scan(ctx, path, options, &scan, measurement));
  if (fg_foil_traits_of(design->kind)->is_foil)
    FG_TRY_EXIT(measure_foils(ctx, scan, options, measurement));
  else
    FG_TRY_EXIT(measure_features(ctx, scan, options, measurement));
  FG_TRY_EXIT(fg_colour_measure(ctx, scan, memory_cap(options), options->threads, measurement));
  FG_TRY_EXIT(refer_lengths(ctx, options->threads, measurement));
  FG_TRY_EXIT(use_gauges(ctx, options->threads, measurement));
  unsigned flags = check_resolution(measurement);
  for (size_t i = 0; i < measurement->foil_count; i++)
    measurement->foils[i].flags |= flags;
  note_contradiction(measurement);
  if (measurement->file.jpeg_quality) note_loss(measurement);
  if (measurement->colour_lines.apart) note_apart(measurement);
  fg_picture_gather(measurement);
exit:
  if (status != FG_OK) clear_failed(options, scan, measurement);
  fg_scan_close(scan);
  return status;
}

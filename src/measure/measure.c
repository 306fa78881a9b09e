#include "foilgauge/measure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "foilgauge/scan.h"
#include "measure/discs.h"
#include "measure/reader.h"
#include "measure/session.h"

#define MEMORY_CAP_BYTES ((size_t)2 << 30)

static size_t memory_cap(const fg_measure_options *options) {
  return options->memory_cap ? options->memory_cap : MEMORY_CAP_BYTES;
}

/* What fg_reader_run visits with. */
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

static fg_status measure_foils(fg_context *ctx, fg_scan *scan, const fg_measure_options *options,
                               fg_measurement *m) {
  fg_budget budget = {.name = m->scan, .limit = memory_cap(options)};
  fg_tiles tiles = {0};
  visit v = {.options = options};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_budget_take(ctx, &budget, (size_t)fg_scan_get_info(scan)->memory_bytes));
  FG_TRY_EXIT(fg_session_create(ctx, m, options->threads, &v.session));
  FG_TRY_EXIT(fg_reader_run(ctx, scan, visit_strip, &v, &budget, &tiles, m->sha256));
  FG_TRY_EXIT(fg_session_finish(ctx, v.session));
  if (m->foil_count == 0)
    status = fg_fail(ctx, FG_ERR_DATA,
                     "%s: no foil in the picture (%zu specks or other objects); is the scan empty, "
                     "or the resolution of %g dpi wrong?",
                     m->scan, m->specks, m->dpi[0]);
exit:
  fg_session_free(v.session);
  fg_tiles_free(&tiles);
  return status;
}

/* A part with round features may fill the scan: its tiles are all kept to the end. */
static fg_status keep_reading(fg_context *ctx, fg_tiles *tiles, void *data) {
  (void)ctx;
  (void)tiles;
  (void)data;
  return FG_OK;
}

static fg_status measure_discs(fg_context *ctx, fg_scan *scan, const fg_measure_options *options,
                               fg_measurement *m) {
  fg_budget budget = {.name = m->scan, .limit = memory_cap(options)};
  fg_tiles tiles = {0};
  FG_TRY(fg_budget_take(ctx, &budget, (size_t)fg_scan_get_info(scan)->memory_bytes));
  fg_status status = fg_reader_run(ctx, scan, keep_reading, NULL, &budget, &tiles, m->sha256);
  if (status == FG_OK) status = fg_measure_discs(ctx, &tiles, options->threads, m);
  fg_tiles_free(&tiles);
  return status;
}

static fg_status open_scan(fg_context *ctx, const char *path, const fg_measure_options *options,
                           fg_scan **scan, fg_measurement *m) {
  const fg_scan_options scan_options = {.dpi = options->dpi,
                                        .pixel_cap = options->pixel_cap,
                                        .memory_cap = memory_cap(options),
                                        .channel = options->channel,
                                        .allow_lossy = options->allow_lossy};
  FG_TRY(fg_scan_open(ctx, path, &scan_options, scan));
  const fg_scan_info *info = fg_scan_get_info(*scan);
  snprintf(m->scan, sizeof m->scan, "%s", path);
  snprintf(m->format, sizeof m->format, "%s", info->format);
  snprintf(m->warning, sizeof m->warning, "%s", info->warning);
  m->width_px = info->width_px;
  m->height_px = info->height_px;
  m->bit_depth = info->bit_depth;
  m->colour = info->colour;
  m->channel = info->channel;
  for (int i = 0; i < 2; i++) {
    m->dpi[i] = info->dpi[i];
    m->dpi_file[i] = info->dpi_file[i];
  }
  return FG_OK;
}

fg_status fg_measure_scan(fg_context *ctx, const char *path, const fg_design *design,
                          const fg_measure_options *options, fg_measurement *measurement) {
  static const fg_measure_options defaults = {0};
  fg_scan *scan = NULL;
  fg_status status = FG_OK;
  memset(measurement, 0, sizeof *measurement);
  measurement->design = *design;
  FG_TRY_EXIT(fg_design_derive(ctx, design, &measurement->nominal));
  if (!options) options = &defaults;
  FG_TRY_EXIT(open_scan(ctx, path, options, &scan, measurement));
  if (design->form == FG_FORM_DISCS)
    FG_TRY_EXIT(measure_discs(ctx, scan, options, measurement));
  else
    FG_TRY_EXIT(measure_foils(ctx, scan, options, measurement));
exit:
  fg_scan_close(scan);
  if (status != FG_OK) fg_measurement_free(measurement);
  return status;
}

#include "foilgauge/measure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "foilgauge/scan.h"
#include "measure/discs.h"
#include "measure/reader.h"
#include "measure/session.h"

static fg_status measure_foils(fg_context *ctx, fg_scan *scan, unsigned threads,
                               fg_measurement *m) {
  fg_tiles tiles = {0};
  fg_session *session = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_session_create(ctx, m, &tiles, threads, &session));
  FG_TRY_EXIT(fg_reader_run(ctx, scan, fg_session_advance, session, &tiles, m->sha256));
  FG_TRY_EXIT(fg_session_finish(ctx, session));
  if (m->foil_count == 0)
    status = fg_fail(ctx, FG_ERR_DATA,
                     "%s: no foil in the picture (%zu specks or other objects); is the scan empty, "
                     "or the resolution of %g dpi wrong?",
                     m->scan, m->specks, m->dpi[0]);
exit:
  fg_session_free(session);
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

static fg_status measure_discs(fg_context *ctx, fg_scan *scan, unsigned threads,
                               fg_measurement *m) {
  fg_tiles tiles = {0};
  fg_status status = fg_reader_run(ctx, scan, keep_reading, NULL, &tiles, m->sha256);
  if (status == FG_OK) status = fg_measure_discs(ctx, &tiles, threads, m);
  fg_tiles_free(&tiles);
  return status;
}

static fg_status open_scan(fg_context *ctx, const char *path, const fg_measure_options *options,
                           fg_scan **scan, fg_measurement *m) {
  fg_scan_options scan_options = {.dpi = options ? options->dpi : 0};
  FG_TRY(fg_scan_open(ctx, path, &scan_options, scan));
  const fg_scan_info *info = fg_scan_get_info(*scan);
  snprintf(m->scan, sizeof m->scan, "%s", path);
  m->width_px = info->width_px;
  m->height_px = info->height_px;
  m->bit_depth = info->bit_depth;
  for (int i = 0; i < 2; i++) {
    m->dpi[i] = info->dpi[i];
    m->dpi_file[i] = info->dpi_file[i];
  }
  return FG_OK;
}

fg_status fg_measure_scan(fg_context *ctx, const char *path, const fg_design *design,
                          const fg_measure_options *options, fg_measurement *measurement) {
  fg_scan *scan = NULL;
  fg_status status = FG_OK;
  memset(measurement, 0, sizeof *measurement);
  measurement->design = *design;
  FG_TRY_EXIT(fg_design_derive(ctx, design, &measurement->nominal));
  FG_TRY_EXIT(open_scan(ctx, path, options, &scan, measurement));
  unsigned threads = options ? options->threads : 0;
  if (design->form == FG_FORM_DISCS)
    FG_TRY_EXIT(measure_discs(ctx, scan, threads, measurement));
  else
    FG_TRY_EXIT(measure_foils(ctx, scan, threads, measurement));
exit:
  fg_scan_close(scan);
  if (status != FG_OK) fg_measurement_free(measurement);
  return status;
}

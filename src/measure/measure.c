#include "foilgauge/measure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "foilgauge/scan.h"
#include "measure/discs.h"
#include "measure/reader.h"
#include "vision/edges.h"
#include "vision/segment.h"
#include "vision/trace.h"

/* An object smaller than this share of the design's bump radius is dust. */
#define OBJECT_LEAST 1.0

static fg_status add_foil(fg_context *ctx, size_t *capacity, fg_measurement *m, fg_foil **foil) {
  FG_TRY(fg_memory_reserve(ctx, m->foil_count + 1, sizeof *m->foils, capacity,
                           (void **)&m->foils));
  *foil = &m->foils[m->foil_count++];
  memset(*foil, 0, sizeof **foil);
  (*foil)->number = (int)m->foil_count;
  return FG_OK;
}

/* A foil from one trace; what cannot be measured is a flag. */
static fg_status measure_foil(fg_context *ctx, const fg_tiles *tiles, const fg_segmentation *seg,
                              const fg_trace *trace, const fg_measurement *m, unsigned threads,
                              fg_foil *foil) {
  fg_status status = fg_edges_measure(ctx, tiles, seg, trace, m->dpi, threads, &foil->strip);
  if (status == FG_ERR_NUMERIC) {
    foil->flags |= FG_FOIL_NOT_MEASURED;
    snprintf(foil->error, sizeof foil->error, "%.255s", ctx->message);
    return FG_OK;
  }
  return status == FG_OK ? fg_foil_measure(ctx, &m->design, threads, foil) : status;
}

static fg_status measure_objects(fg_context *ctx, const fg_tiles *tiles,
                                 const fg_segmentation *seg, unsigned threads,
                                 fg_measurement *m) {
  double px_per_mm = sqrt(m->dpi[0] * m->dpi[1]) / 25.4;
  size_t capacity = 0;
  fg_trace_list list = {0};
  fg_status status = FG_OK;
  for (size_t i = 0; i < seg->object_count; i++) {
    FG_TRY_EXIT(fg_trace_object(ctx, tiles, seg, &seg->objects[i],
                                m->design.thickness_mm * px_per_mm, &list));
    if (!list.count) m->specks++;
    for (size_t j = 0; j < list.count; j++) {
      fg_foil *foil;
      FG_TRY_EXIT(add_foil(ctx, &capacity, m, &foil));
      FG_TRY_EXIT(measure_foil(ctx, tiles, seg, &list.traces[j], m, threads, foil));
    }
    fg_trace_list_free(&list);
  }
exit:
  fg_trace_list_free(&list);
  return status;
}

static fg_status measure_tiles(fg_context *ctx, const fg_tiles *tiles, unsigned threads,
                               fg_measurement *m) {
  fg_segmentation seg = {0};
  double px_per_mm = sqrt(m->dpi[0] * m->dpi[1]) / 25.4;
  FG_TRY(fg_segment(ctx, tiles, OBJECT_LEAST * m->design.bump_radius_mm * px_per_mm, &seg));
  m->light_on_dark = seg.light_on_dark;
  m->specks = seg.speck_count;
  fg_status status = measure_objects(ctx, tiles, &seg, threads, m);
  if (status == FG_OK && m->foil_count == 0)
    status = fg_fail(ctx, FG_ERR_DATA,
                     "%s: no foil in the picture (%zu specks or other objects); is the scan empty, "
                     "or the resolution of %g dpi wrong?",
                     m->scan, m->specks, m->dpi[0]);
  fg_segmentation_free(&seg);
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
  fg_tiles tiles = {0};
  fg_status status = FG_OK;
  memset(measurement, 0, sizeof *measurement);
  measurement->design = *design;
  FG_TRY_EXIT(fg_design_derive(ctx, design, &measurement->nominal));
  FG_TRY_EXIT(open_scan(ctx, path, options, &scan, measurement));
  FG_TRY_EXIT(fg_reader_run(ctx, scan, &tiles, measurement->sha256));
  unsigned threads = options ? options->threads : 0;
  if (design->form == FG_FORM_DISCS)
    FG_TRY_EXIT(fg_measure_discs(ctx, &tiles, threads, measurement));
  else
    FG_TRY_EXIT(measure_tiles(ctx, &tiles, threads, measurement));
exit:
  fg_tiles_free(&tiles);
  fg_scan_close(scan);
  if (status != FG_OK) fg_measurement_free(measurement);
  return status;
}

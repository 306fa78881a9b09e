/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The overlay: the scan in gray, the measured geometry drawn over it, and a legend below. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "foilgauge/words.h"
#include "quantity/quantity_rows.h"
#include "report/measure/drawing.h"
#include "report/measure/foil_parts.h"
#include "report/measure/foil_view.h"
#include "report/measure/overlay.h"

enum { WIDTH_MAX = 8000, LEGEND_FOILS_MAX = 6, LINE_MAX_LENGTH = FG_OVERLAY_LINE };
static const double pixels_max = 48e6;
/* Capitals of the legend: as high as can be read, and the legend as wide as its widest row needs.
 */
static const double em_min_px = 8, legend_width_em = 118;

/* The legend: text in lines and columns under the picture. */
struct fg_overlay_legend {
  fg_rgb *rgb;
  double left_px, top_px;
  double em_px; /* height of capitals */
  double line;  /* the next line's number */
};

static fg_status put_text(fg_context *ctx, const fg_overlay_legend *at, double column_em,
                          uint32_t colour, const char *text) {
  char ascii[LINE_MAX_LENGTH];
  const double where[2] = {at->left_px + column_em * at->em_px,
                           at->top_px + (at->line + 1) * 2.0 * at->em_px};
  int32_t thickness = (int32_t)fmax(1, round(at->em_px / 8));
  fg_text_to_ascii(text, ascii, sizeof ascii);
  const fg_text_style style = {at->em_px, 0, colour, thickness, 0};
  return fg_cv_draw_text(ctx, at->rgb, ascii, where, &style);
}

fg_status fg_overlay_put_line(fg_context *ctx, fg_overlay_legend *legend, double column_em,
                              const char *text) {
  FG_TRY(put_text(ctx, legend, column_em, 0xf0f3f6, text));
  legend->line++;
  return FG_OK;
}

void fg_overlay_value_text(const fg_quantity *row, const void *object, char *text, size_t size) {
  double value = fg_quantity_value(row, object), u = fg_quantity_uncertainty(row, object);
  int decimals = fg_report_decimals(row, u);
  if (!isfinite(value))
    snprintf(text, size, "-");
  else if (isfinite(u))
    snprintf(text, size, "%.*f ± %.*f", decimals, value, decimals, FG_COVERAGE_FACTOR * u);
  else
    snprintf(text, size, "%.*f", decimals, value);
}

static fg_status put_heading(fg_context *ctx, fg_overlay_legend *at,
                             const fg_quantity *const *columns, size_t count) {
  for (size_t i = 0; i < count; i++) {
    char text[64];
    snprintf(text, sizeof text, "%s %s", columns[i]->symbol, columns[i]->unit);
    FG_TRY(put_text(ctx, at, 4 + 17.0 * (double)i, 0xa8b4c0, text));
  }
  at->line++;
  return FG_OK;
}

static fg_status put_row(fg_context *ctx, fg_overlay_legend *at, const fg_quantity *const *columns,
                         size_t count, int number, bool bad, const void *object) {
  char text[64];
  uint32_t colour = bad ? 0xff6b6b : 0xf0f3f6;
  snprintf(text, sizeof text, "%d", number);
  FG_TRY(put_text(ctx, at, 0, FG_COLOUR_BUMP, text));
  for (size_t i = 0; i < count; i++) {
    fg_overlay_value_text(columns[i], object, text, sizeof text);
    FG_TRY(put_text(ctx, at, 4 + 17.0 * (double)i, colour, text));
  }
  at->line++;
  return FG_OK;
}

static bool is_flagged(const fg_design *design, const fg_foil *foil, size_t i) {
  if (fg_foil_traits_of(design->kind)->part == FG_QUANTITY_OF_BEAM)
    return fg_beam_flags(design, foil, &foil->beams[i]) & ~(unsigned)FG_BEAM_ONE_FLOOR;
  return fg_bump_flags(design, foil, &foil->bumps[i]) != 0;
}

static fg_status put_parts(fg_context *ctx, fg_overlay_legend *at, const fg_design *design,
                           const fg_foil *foil) {
  const fg_foil_parts parts = fg_foil_parts_of(design, foil);
  const fg_quantity *columns[FG_QUANTITY_SHOWN_MAX];
  size_t count = fg_quantity_shown(parts.owner, FG_QUANTITY_ON_PICTURE, design->kind, columns);
  FG_TRY(put_heading(ctx, at, columns, count));
  for (size_t i = 0; i < parts.count; i++)
    FG_TRY(put_row(ctx, at, columns, count, fg_foil_part_number(&parts, i),
                   is_flagged(design, foil, i), fg_foil_part_at(&parts, i)));
  return FG_OK;
}

fg_status fg_overlay_of_beams(fg_context *ctx, fg_overlay_legend *at, const fg_design *design,
                              const fg_foil *foil, bool all) {
  char text[LINE_MAX_LENGTH];
  snprintf(text, sizeof text, "Foil %d: flat, %zu beams", foil->number, foil->beam_count);
  FG_TRY(put_text(ctx, at, 0, FG_COLOUR_OVERALL, text));
  at->line++;
  return all ? put_parts(ctx, at, design, foil) : FG_OK;
}

fg_status fg_overlay_put_bent_foil(fg_context *ctx, fg_overlay_legend *at, const fg_foil *foil) {
  char text[LINE_MAX_LENGTH], radius[64], error[64], thickness[64];
  fg_overlay_value_text(fg_quantity_find(FG_QUANTITY_OF_FOIL, "overall.radius_mm"), foil, radius,
                        sizeof radius);
  fg_overlay_value_text(fg_quantity_find(FG_QUANTITY_OF_FOIL, "overall.springback_error_pct"), foil,
                        error, sizeof error);
  fg_overlay_value_text(fg_quantity_find(FG_QUANTITY_OF_FOIL, "thickness_mm"), foil, thickness,
                        sizeof thickness);
  if (!fg_foil_is_measured(foil))
    snprintf(text, sizeof text, "Foil %d: not measured: %.180s", foil->number, foil->error);
  else
    snprintf(text, sizeof text, "Foil %d: R0 %s mm, springback %s %%, t %s mm", foil->number,
             radius, error, thickness);
  FG_TRY(put_text(ctx, at, 0, FG_COLOUR_OVERALL, text));
  at->line++;
  return FG_OK;
}

fg_status fg_overlay_of_bumps(fg_context *ctx, fg_overlay_legend *at, const fg_design *design,
                              const fg_foil *foil, bool all) {
  FG_TRY(fg_overlay_put_bent_foil(ctx, at, foil));
  return all ? put_parts(ctx, at, design, foil) : FG_OK;
}

static fg_status put_discs(fg_context *ctx, fg_overlay_legend *at,
                           const fg_measurement *measurement) {
  const fg_quantity *columns[FG_QUANTITY_SHOWN_MAX];
  size_t count = fg_quantity_shown(FG_QUANTITY_OF_DISC, FG_QUANTITY_ON_PICTURE,
                                   measurement->design.kind, columns);
  FG_TRY(put_heading(ctx, at, columns, count));
  for (size_t i = 0; i < measurement->disc_count; i++)
    FG_TRY(put_row(ctx, at, columns, count, measurement->discs[i].number,
                   fg_disc_flags(&measurement->design, &measurement->discs[i]) != 0,
                   &measurement->discs[i]));
  return FG_OK;
}

static bool legend_has_bumps(const fg_measurement *measurement) {
  return measurement->foil_count <= LEGEND_FOILS_MAX;
}

static size_t legend_lines(const fg_measurement *measurement) {
  size_t lines = 3 + measurement->foil_count;
  for (size_t i = 0; legend_has_bumps(measurement) && i < measurement->foil_count; i++)
    lines += measurement->foils[i].bump_count + measurement->foils[i].beam_count + 1;
  return lines + (measurement->disc_count ? measurement->disc_count + 1 : 0);
}

static fg_status draw_legend(fg_context *ctx, fg_overlay_legend *at,
                             const fg_measurement *measurement) {
  const fg_foil_view *view = fg_foil_view_of(measurement->design.kind);
  for (size_t i = 0; i < measurement->foil_count; i++)
    FG_TRY(view->overlay(ctx, at, &measurement->design, &measurement->foils[i],
                         legend_has_bumps(measurement)));
  if (measurement->disc_count) FG_TRY(put_discs(ctx, at, measurement));
  return put_text(ctx, at, 0, 0xa8b4c0, view->overlay_note);
}

/* The gray picture on top, a dark panel for the legend below, which may be wider. */
static fg_status make_ground(fg_context *ctx, const fg_picture *picture, double width_px,
                             double panel_px, fg_rgb *rgb) {
  size_t width = (size_t)picture->width, rows = (size_t)picture->height;
  void *block;
  rgb->width = (int32_t)fmax(picture->width, ceil(width_px));
  rgb->height = picture->height + (int32_t)panel_px;
  size_t row_bytes = 3 * (size_t)rgb->width;
  FG_TRY(fg_memory_allocate(ctx, (size_t)rgb->height, row_bytes, &block));
  rgb->pixels = block;
  memset(rgb->pixels, 0x16, (size_t)rgb->height * row_bytes);
  for (size_t row = 0; row < rows; row++)
    for (size_t i = 0; i < width; i++)
      memset(rgb->pixels + row * row_bytes + 3 * i, picture->gray[row * width + i], 3);
  return FG_OK;
}

static fg_status draw_overlay(fg_context *ctx, const fg_measurement *measurement,
                              const fg_picture *picture, fg_rgb *rgb) {
  double em_px = fmax(em_min_px, picture->width / legend_width_em);
  FG_TRY(make_ground(ctx, picture, legend_width_em * em_px,
                     2.0 * em_px * ((double)legend_lines(measurement) + 1), rgb));
  fg_canvas canvas = fg_canvas_over(picture, measurement);
  fg_rgb upper = {rgb->pixels, rgb->width, picture->height}; /* nothing reaches the legend */
  canvas.rgb = &upper;
  canvas.width_px = rgb->width;
  canvas.unit_px = rgb->width / 1600.0;
  FG_TRY(fg_draw_measurement(ctx, &canvas, measurement, 0));
  fg_overlay_legend at = {rgb, 2 * em_px, picture->height + em_px, em_px, 0};
  return draw_legend(ctx, &at, measurement);
}

fg_status fg_report_write_overlay(fg_context *ctx, const fg_report *report, FILE *out) {
  const fg_measurement *measurement = report->scans[0].measurement;
  fg_picture picture = {0};
  fg_rgb rgb = {0};
  uint8_t *png = NULL;
  size_t size = 0;
  fg_status status = FG_OK;
  if (report->scan_count != 1 || !measurement)
    return fg_fail(ctx, FG_ERR_USAGE, "an overlay shows exactly one measured scan");
  const int64_t box[4] = {0, 0, measurement->file.width_px, measurement->file.height_px};
  FG_TRY_EXIT(fg_picture_load(ctx, measurement, box, WIDTH_MAX, pixels_max, &picture));
  FG_TRY_EXIT(draw_overlay(ctx, measurement, &picture, &rgb));
  FG_TRY_EXIT(fg_png_encode(ctx, rgb.pixels, rgb.width, rgb.height, 3, &png, &size));
  fwrite(png, 1, size, out);
  status = fg_stream_finish(ctx, out, "the overlay");
exit:
  fg_picture_free(&picture);
  free(rgb.pixels);
  free(png);
  return status;
}

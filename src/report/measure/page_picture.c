/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report/measure/drawing.h"
#include "report/measure/page_parts.h"
#include "report/measure/picture_marks.h"

enum { WIDTH_MAX = 1600, FOILS_MAX = 6 };
static const double pixels_max = 4e6;
/* Largest size of a picture in the page's style, in CSS pixels; one unit of the drawing is one
 * of them. */
#define SHOWN_WIDTH  1038.0
#define SHOWN_HEIGHT 600.0

static void put_base64(FILE *out, const uint8_t *bytes, size_t size) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < size; i += 3) {
    size_t left = size - i;
    uint32_t three = (uint32_t)bytes[i] << 16 | (left > 1 ? (uint32_t)bytes[i + 1] << 8 : 0) |
                     (left > 2 ? bytes[i + 2] : 0);
    fputc(digits[three >> 18], out);
    fputc(digits[three >> 12 & 63], out);
    fputc(left > 1 ? digits[three >> 6 & 63] : '=', out);
    fputc(left > 2 ? digits[three & 63] : '=', out);
  }
}

/* Room for residuals, numbers, and a ring around the middle of any bump's chord (picture_marks.c):
 * none is wider than the bump. */
static double find_margin_mm(const fg_foil *foil) {
  static const double usual_mm = 3.5, ring_over_half_chord = 1.08, pen_mm = 0.2;
  static const double degree = 3.14159265358979323846 / 180, right_angle_deg = 90;
  double margin = usual_mm;
  for (size_t i = 0; foil && i < foil->bump_count; i++) {
    double half_deg = fmin(foil->bumps[i].bump_angle_deg / 2, right_angle_deg);
    double ring = ring_over_half_chord * foil->bumps[i].radius_mm * sin(half_deg * degree);
    margin = fmax(margin, ring + pen_mm); /* fmax skips missing values */
  }
  return fmin(margin, 3 * usual_mm);
}

/* `box`: the foil's with a margin, inside the scan; the whole scan without a foil or a box.
 * `beyond`: by how much the margin reaches over the scan's left, upper, right and lower edge. */
static void choose_box(const fg_measurement *measurement, const fg_foil *foil, int64_t box[4],
                       int64_t beyond[4]) {
  const int64_t size[2] = {measurement->file.width_px, measurement->file.height_px};
  double margin_mm = find_margin_mm(foil);
  for (int i = 0; i < 2; i++) {
    bool known = foil && foil->strip.box_px[2] > 0 && foil->strip.box_px[3] > 0;
    int64_t margin = (int64_t)(margin_mm * measurement->dpi[i] / 25.4);
    int64_t from = known ? foil->strip.box_px[i] - margin : 0;
    int64_t to = known ? foil->strip.box_px[i] + foil->strip.box_px[i + 2] + margin : size[i];
    box[i] = from > 0 ? from : 0;
    box[i + 2] = (to < size[i] ? to : size[i]) - box[i];
    beyond[i] = from < 0 ? -from : 0;
    beyond[i + 2] = to > size[i] ? to - size[i] : 0;
    if (box[i + 2] <= 0) {
      box[i] = 0;
      box[i + 2] = size[i];
      beyond[i] = beyond[i + 2] = 0;
    }
  }
}

/* Makes a picture without pixels, to place a drawing that stands alone. */
static void empty_picture(const int64_t box[4], fg_picture *picture) {
  double reduction = fmin(1, WIDTH_MAX / (double)box[2]);
  *picture = (fg_picture){.width = (int32_t)fmax(1, (double)box[2] * reduction),
                          .height = (int32_t)fmax(1, (double)box[3] * reduction),
                          .reduction = {reduction, reduction},
                          .origin_px = {box[0], box[1]}};
}

/* Rounds to every fourth level, which nobody sees: noise of a plain background would be most of
 * the page's bytes. */
static void drop_noise(fg_picture *picture) {
  enum { STEP = 4, WHITE = 255 };
  size_t pixels = (size_t)picture->width * (size_t)picture->height;
  for (size_t i = 0; i < pixels; i++) {
    int level = (picture->gray[i] + STEP / 2) / STEP * STEP;
    picture->gray[i] = (uint8_t)(level < WHITE ? level : WHITE);
  }
}

static fg_status put_image(fg_context *ctx, FILE *out, const fg_picture *picture) {
  uint8_t *png;
  size_t size;
  FG_TRY(fg_png_encode(ctx, picture->gray, picture->width, picture->height, 1, &png, &size));
  fprintf(out, "<image width=\"%d\" height=\"%d\" href=\"data:image/png;base64,", picture->width,
          picture->height);
  put_base64(out, png, size);
  fputs("\"/>\n", out);
  free(png);
  return FG_OK;
}

/* The measurement with this one foil, so that others do not reach into the picture. */
static fg_status put_drawing(fg_context *ctx, FILE *out, const fg_picture *picture,
                             const fg_measurement *measurement, const fg_foil *foil,
                             double magnification) {
  fg_measurement shown = *measurement;
  fg_foil one;
  if (foil) {
    one = *foil;
    shown.foils = &one;
    shown.foil_count = 1;
  }
  fg_canvas canvas = fg_canvas_over(picture, measurement);
  canvas.svg = out;
  canvas.unit_px = fmax(picture->width / SHOWN_WIDTH, picture->height / SHOWN_HEIGHT);
  fputs("<g fill=\"none\" stroke-linejoin=\"round\" class=\"drawing\">\n", out);
  FG_TRY(fg_draw_measurement(ctx, &canvas, &shown, magnification));
  if (foil || shown.disc_count) FG_TRY(fg_draw_verdicts(ctx, &canvas, &shown));
  fputs("</g>\n", out);
  return FG_OK;
}

/* The ground is plain where the margin reaches beyond the scan, or there are no pixels. */
static void begin_picture(FILE *out, const fg_picture *picture, const int64_t beyond[4]) {
  double edge[4];
  for (int i = 0; i < 4; i++)
    edge[i] = ceil((double)beyond[i] * picture->reduction[i % 2]);
  double width = picture->width + edge[0] + edge[2], height = picture->height + edge[1] + edge[3];
  fprintf(out,
          "<svg class=\"picture\" width=\"%.0f\" height=\"%.0f\" viewBox=\"%.0f %.0f %.0f %.0f\" "
          "role=\"img\" aria-label=\"The scan with fitted circles and residuals\">\n"
          "<rect x=\"%.0f\" y=\"%.0f\" width=\"%.0f\" height=\"%.0f\" fill=\"#20262c\"/>\n",
          width, height, 0 - edge[0], 0 - edge[1], width, height, 0 - edge[0], 0 - edge[1], width,
          height);
}

fg_status fg_html_picture(fg_context *ctx, FILE *out, const fg_measurement *measurement,
                          const fg_foil *foil, double magnification) {
  int64_t box[4], beyond[4];
  fg_picture picture;
  choose_box(measurement, foil, box, beyond);
  bool readable = strcmp(measurement->scan, "-") != 0 && measurement->foil_count <= FOILS_MAX;
  if (readable)
    FG_TRY(fg_picture_load(ctx, measurement, box, WIDTH_MAX, pixels_max, &picture));
  else
    empty_picture(box, &picture);
  begin_picture(out, &picture, beyond);
  if (readable) drop_noise(&picture);
  fg_status status = readable ? put_image(ctx, out, &picture) : FG_OK;
  if (status == FG_OK) status = put_drawing(ctx, out, &picture, measurement, foil, magnification);
  fputs("</svg>\n", out);
  fg_picture_free(&picture);
  return status;
}

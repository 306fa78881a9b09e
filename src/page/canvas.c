/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "page/canvas.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/json_writer.h"
#include "core/memory.h"

static const double pi = 3.14159265358979323846;

typedef double point_px[2];

fg_canvas fg_canvas_over(const fg_picture *picture, const fg_measurement *measurement) {
  fg_canvas canvas = {.width_px = picture->width, .height_px = picture->height};
  for (int i = 0; i < 2; i++) {
    canvas.px_per_mm[i] = measurement->dpi[i] / 25.4 * picture->reduction[i];
    /* The centre of scan pixel 0 lies half a scan pixel inside the picture's border. */
    canvas.origin_px[i] = (0.5 - (double)picture->origin_px[i]) * picture->reduction[i] - 0.5;
  }
  canvas.unit_px = picture->width / 1600.0;
  return canvas;
}

static void to_px(const fg_canvas *canvas, fg_point mm, point_px px) {
  px[0] = canvas->origin_px[0] + mm.x * canvas->px_per_mm[0];
  px[1] = canvas->origin_px[1] + mm.y * canvas->px_per_mm[1];
}

static int32_t raster_width(const fg_canvas *canvas, double units) {
  double width = units * canvas->unit_px;
  return width < 1 ? 1 : (int32_t)lround(width);
}

/* Dashes of a picture: pieces of the line, cut at multiples of the dash along it. */
static fg_status draw_dashed(fg_context *ctx, fg_canvas *canvas, point_px *px, size_t count,
                             fg_pen pen) {
  double dash_px = pen.dash * canvas->unit_px, walked = 0;
  for (size_t i = 0; i + 1 < count; i++) {
    double dx = px[i + 1][0] - px[i][0], dy = px[i + 1][1] - px[i][1];
    double length = hypot(dx, dy), at = 0;
    while (at < length) {
      double piece = fmin(dash_px - fmod(walked, dash_px), length - at) + 1e-6;
      bool visible = fmod(walked / dash_px, 2) < 1;
      double end = fmin(at + piece, length);
      point_px ends[2] = {{px[i][0] + dx * at / length, px[i][1] + dy * at / length},
                          {px[i][0] + dx * end / length, px[i][1] + dy * end / length}};
      if (visible)
        FG_TRY(fg_cv_draw_line(ctx, canvas->rgb, ends[0], 2, pen.colour,
                               raster_width(canvas, pen.width)));
      walked += piece;
      at += piece;
    }
  }
  return FG_OK;
}

static void begin_path(const fg_canvas *canvas, fg_pen pen) {
  fprintf(canvas->svg, "<path stroke=\"#%06x\" stroke-width=\"%.3g\"", (unsigned)pen.colour,
          pen.width * canvas->unit_px);
  if (pen.dash > 0) fprintf(canvas->svg, " stroke-dasharray=\"%.3g\"", pen.dash * canvas->unit_px);
  fputs(" d=\"", canvas->svg);
}

static void put_svg_line(const fg_canvas *canvas, point_px *px, size_t count) {
  for (size_t i = 0; i < count; i++)
    fprintf(canvas->svg, "%c%.2f %.2f", i ? 'L' : 'M', px[i][0] + 0.5, px[i][1] + 0.5);
}

static fg_status draw_line(fg_context *ctx, fg_canvas *canvas, point_px *px, size_t count,
                           fg_pen pen) {
  if (canvas->svg) {
    begin_path(canvas, pen);
    put_svg_line(canvas, px, count);
    fputs("\"/>\n", canvas->svg);
    return FG_OK;
  }
  if (pen.dash > 0) return draw_dashed(ctx, canvas, px, count, pen);
  return fg_cv_draw_line(ctx, canvas->rgb, px[0], count, pen.colour,
                         raster_width(canvas, pen.width));
}

fg_status fg_canvas_line(fg_context *ctx, fg_canvas *canvas, const fg_point *mm, size_t count,
                         fg_pen pen) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof(point_px), &block));
  point_px *px = block;
  size_t used = 0;
  for (size_t i = 0; i < count; i++) {
    to_px(canvas, mm[i], px[used]);
    bool far =
        used == 0 || hypot(px[used][0] - px[used - 1][0], px[used][1] - px[used - 1][1]) > 0.5;
    if (far || i + 1 == count) used++;
  }
  fg_status status = used ? draw_line(ctx, canvas, px, used, pen) : FG_OK;
  free(block);
  return status;
}

fg_status fg_canvas_segments(fg_context *ctx, fg_canvas *canvas, const fg_point (*mm)[2],
                             size_t count, fg_pen pen) {
  if (count == 0) return FG_OK;
  if (canvas->svg) begin_path(canvas, pen);
  for (size_t i = 0; i < count; i++) {
    point_px ends[2];
    to_px(canvas, mm[i][0], ends[0]);
    to_px(canvas, mm[i][1], ends[1]);
    if (canvas->svg)
      put_svg_line(canvas, ends, 2);
    else
      FG_TRY(fg_cv_draw_line(ctx, canvas->rgb, ends[0], 2, pen.colour,
                             raster_width(canvas, pen.width)));
  }
  if (canvas->svg) fputs("\"/>\n", canvas->svg);
  return FG_OK;
}

fg_status fg_canvas_arc(fg_context *ctx, fg_canvas *canvas, const fg_circle *circle,
                        double from_rad, double to_rad, fg_pen pen) {
  enum { PIECES_MAX = 720 };
  fg_point points[PIECES_MAX + 1];
  double pieces_wanted = ceil(fabs(to_rad - from_rad) / (pi / 360));
  if (!isfinite(circle->radius + pieces_wanted)) return FG_OK;
  int pieces = (int)fmin(PIECES_MAX, fmax(2, pieces_wanted));
  for (int i = 0; i <= pieces; i++) {
    double angle = from_rad + (to_rad - from_rad) * i / pieces;
    points[i] = (fg_point){circle->x + circle->radius * cos(angle),
                           circle->y + circle->radius * sin(angle)};
  }
  return fg_canvas_line(ctx, canvas, points, (size_t)pieces + 1, pen);
}

void fg_text_to_ascii(const char *text, char *ascii, size_t size) {
  static const struct {
    const char *letter, *ascii;
  } letters[] = {{"α", "alpha"}, {"θ", "theta"}, {"±", "+-"}, {"µ", "u"}, {"×", "x"}, {"°", "deg"}};
  size_t used = 0;
  ascii[0] = '\0';
  while (*text && used + 8 < size) {
    const char *replacement = NULL;
    size_t length = fg_utf8_length(text);
    for (size_t i = 0; i < sizeof letters / sizeof *letters; i++)
      if (length == 2 && !strncmp(text, letters[i].letter, 2)) replacement = letters[i].ascii;
    if (length == 1)
      used += (size_t)snprintf(ascii + used, size - used, "%c", *text);
    else
      used += (size_t)snprintf(ascii + used, size - used, "%s", replacement ? replacement : "?");
    text += length ? length : 1;
  }
}

fg_status fg_canvas_text(fg_context *ctx, fg_canvas *canvas, fg_point mm, double height,
                         double anchor, uint32_t colour, const char *text) {
  point_px px;
  to_px(canvas, mm, px);
  double height_px = height * canvas->unit_px;
  px[1] += height_px / 2;
  if (canvas->svg) {
    /* Capitals are about 0.7 of a font's size. */
    fprintf(canvas->svg,
            "<text x=\"%.1f\" y=\"%.1f\" font-size=\"%.3g\" fill=\"#%06x\" "
            "text-anchor=\"%s\">%s</text>\n",
            px[0], px[1], height_px / 0.7, (unsigned)colour, anchor > 0 ? "middle" : "start", text);
    return FG_OK;
  }
  char ascii[256];
  fg_text_to_ascii(text, ascii, sizeof ascii);
  int32_t thickness = raster_width(canvas, height / 8);
  const fg_text_style style = {height_px, anchor, colour, thickness, thickness};
  return fg_cv_draw_text(ctx, canvas->rgb, ascii, px, &style);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/drawing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "report/measure/draw_beams.h"

static const double pi = 3.14159265358979323846;

/* Distance of the residuals' baseline from the midline, on the shaft's side, where there is
 * room. */
static const double baseline_mm = 0.8;
static const double whisker_mm = 0.5;

static fg_point midpoint(const fg_station *station) {
  return (fg_point){(station->left.x + station->right.x) / 2,
                    (station->left.y + station->right.y) / 2};
}

static fg_point offset(fg_point from, fg_point direction, double length) {
  return (fg_point){from.x + direction.x * length, from.y + direction.y * length};
}

static fg_point direction_from(fg_point centre, fg_point to) {
  double length = hypot(to.x - centre.x, to.y - centre.y);
  return (fg_point){(to.x - centre.x) / length, (to.y - centre.y) / length};
}

static int compare_floats(const void *a, const void *b) {
  float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

/* 99 % of the residuals are smaller than this. */
static double large_residual(const fg_measurement *measurement) {
  double largest = 0;
  for (size_t i = 0; i < measurement->foil_count; i++) {
    const fg_foil *foil = &measurement->foils[i];
    float *sizes = calloc(foil->strip.count + 1, sizeof *sizes);
    size_t count = 0;
    for (size_t k = 0; sizes && foil->labels && k < foil->strip.count; k++)
      if (foil->labels[k].fitted && isfinite(foil->labels[k].residual_um))
        sizes[count++] = fabsf(foil->labels[k].residual_um);
    if (count) {
      fg_sort_items(sizes, count, sizeof *sizes, compare_floats);
      largest = fmax(largest, (double)sizes[(count - 1) * 99 / 100]);
    }
    free(sizes);
  }
  for (size_t i = 0; i < measurement->foil_count; i++)
    for (size_t b = 0; b < measurement->foils[i].beam_count; b++)
      if (isfinite(measurement->foils[i].beams[b].rms_um))
        largest = fmax(largest, 2.5 * measurement->foils[i].beams[b].rms_um);
  for (size_t i = 0; i < measurement->disc_count; i++)
    if (isfinite(measurement->discs[i].rms_um))
      largest = fmax(largest, 2.5 * measurement->discs[i].rms_um);
  return largest;
}

/* A larger magnification would draw the noise of a clean scan, residuals of 0.1 um, as spikes
 * that mean nothing. */
#define MAGNIFICATION_MAX 1000.0

/* Returns the magnification that draws the larger residuals about 0.5 mm long: 1, 2 or 5 times a
 * power of ten, at most MAGNIFICATION_MAX. */
static double magnification_for(double largest) {
  static const double steps[] = {1, 2, 5, 10};
  if (!(largest > 0)) return MAGNIFICATION_MAX;
  double wanted = whisker_mm / (largest * 1e-3), power = pow(10, floor(log10(wanted)));
  double best = power;
  for (int i = 0; i < 4; i++)
    if (steps[i] * power <= wanted) best = steps[i] * power;
  return fmin(MAGNIFICATION_MAX, fmax(1, best));
}

double fg_drawing_magnification(const fg_report *report) {
  double largest = 0;
  for (size_t i = 0; i < report->scan_count; i++)
    if (report->scans[i].measurement)
      largest = fmax(largest, large_residual(report->scans[i].measurement));
  return magnification_for(largest);
}

static fg_status draw_edges(fg_context *ctx, fg_canvas *canvas, const fg_strip *strip) {
  const fg_pen pen = {FG_COLOUR_EDGE, 0.8, 0};
  void *block;
  FG_TRY(fg_memory_allocate(ctx, strip->count, sizeof(fg_point), &block));
  fg_point *points = block;
  for (size_t i = 0; i < strip->count; i++)
    points[i] = strip->stations[i].left;
  fg_status status = fg_canvas_line(ctx, canvas, points, strip->count, pen);
  for (size_t i = 0; i < strip->count; i++)
    points[i] = strip->stations[i].right;
  if (status == FG_OK) status = fg_canvas_line(ctx, canvas, points, strip->count, pen);
  free(block);
  return status;
}

/* The circle that a station was fitted to; false when there is none. */
static bool circle_of(const fg_foil *foil, const fg_station_label *label, fg_point *centre) {
  if (!label->fitted || !isfinite(label->residual_um)) return false;
  if (label->kind == FG_ARC_LAND) *centre = foil->overall.centre_mm;
  if (label->kind == FG_ARC_LAND) return true;
  for (size_t i = 0; label->kind == FG_ARC_BUMP && i < foil->bump_count; i++) {
    if (foil->bumps[i].number != label->number) continue;
    *centre = foil->bumps[i].centre_mm;
    return true;
  }
  return false;
}

/* A residual at its station: away from the centre where the strip lies outside its circle. */
static fg_status draw_whiskers(fg_context *ctx, fg_canvas *canvas, const fg_foil *foil,
                               double magnification) {
  size_t every = 1 + (size_t)(1.2 * canvas->unit_px / (foil->strip.step_mm * canvas->px_per_mm[0]));
  void *block;
  FG_TRY(fg_memory_allocate(ctx, foil->strip.count, sizeof(fg_point[2]), &block));
  fg_point(*whiskers)[2] = block;
  size_t used = 0;
  for (size_t i = 0; foil->labels && i < foil->strip.count; i += every) {
    fg_point centre, middle = midpoint(&foil->strip.stations[i]);
    if (!circle_of(foil, &foil->labels[i], &centre)) continue;
    fg_point base = offset(middle, direction_from(middle, foil->overall.centre_mm), baseline_mm);
    whiskers[used][0] = base;
    whiskers[used][1] = offset(base, direction_from(centre, middle),
                               foil->labels[i].residual_um * 1e-3 * magnification);
    used++;
  }
  fg_status status = fg_canvas_segments(ctx, canvas, (const fg_point(*)[2])whiskers, used,
                                        (fg_pen){FG_COLOUR_RESIDUAL, 0.7, 0});
  free(block);
  return status;
}

static fg_status draw_cross(fg_context *ctx, fg_canvas *canvas, fg_point at, double size_mm,
                            uint32_t colour) {
  const fg_point lines[2][2] = {{{at.x - size_mm, at.y}, {at.x + size_mm, at.y}},
                                {{at.x, at.y - size_mm}, {at.x, at.y + size_mm}}};
  return fg_canvas_segments(ctx, canvas, lines, 2, (fg_pen){colour, 1.2, 0});
}

/* Finds the reach of the used arc to both sides of the direction to O. */
static void used_arc(const fg_foil *foil, const fg_bump *bump, double towards, double range[2]) {
  range[0] = range[1] = 0;
  for (size_t i = 0; foil->labels && i < foil->strip.count; i++) {
    const fg_station_label *label = &foil->labels[i];
    if (label->kind != FG_ARC_BUMP || label->number != bump->number || !label->fitted) continue;
    fg_point middle = midpoint(&foil->strip.stations[i]);
    double angle = remainder(
        atan2(middle.y - bump->centre_mm.y, middle.x - bump->centre_mm.x) - towards, 2 * pi);
    range[0] = fmin(range[0], angle);
    range[1] = fmax(range[1], angle);
  }
}

static fg_status draw_bump(fg_context *ctx, fg_canvas *canvas, const fg_foil *foil,
                           const fg_bump *bump) {
  const fg_pen solid = {FG_COLOUR_BUMP, 1.6, 0}, dashed = {FG_COLOUR_BUMP, 0.9, 5};
  const fg_circle circle = {bump->centre_mm.x, bump->centre_mm.y, bump->radius_mm};
  fg_point centre = foil->overall.centre_mm;
  if (!isfinite(circle.x + circle.y + circle.radius + centre.x + centre.y)) return FG_OK;
  double towards = atan2(centre.y - circle.y, centre.x - circle.x), range[2];
  double reach = isfinite(bump->bump_angle_deg) ? bump->bump_angle_deg * pi / 360 + 0.35 : 1;
  used_arc(foil, bump, towards, range);
  FG_TRY(fg_canvas_arc(ctx, canvas, &circle, towards + range[0], towards + range[1], solid));
  FG_TRY(fg_canvas_arc(ctx, canvas, &circle, towards + range[1], towards + reach, dashed));
  FG_TRY(fg_canvas_arc(ctx, canvas, &circle, towards - reach, towards + range[0], dashed));
  FG_TRY(draw_cross(ctx, canvas, bump->centre_mm, 0.3, FG_COLOUR_BUMP));
  char number[16];
  snprintf(number, sizeof number, "%d", bump->number);
  fg_point at = offset(bump->centre_mm, direction_from(bump->centre_mm, centre),
                       bump->radius_mm + 2 * baseline_mm + whisker_mm);
  return fg_canvas_text(ctx, canvas, at, 12, 0.5, FG_COLOUR_TEXT, number);
}

/* The letter stands on the foil's side of the centre: the other may lie beyond the picture. */
static fg_status draw_overall(fg_context *ctx, fg_canvas *canvas, const fg_foil *foil) {
  const fg_overall *overall = &foil->overall;
  const fg_circle circle = {overall->centre_mm.x, overall->centre_mm.y, overall->radius_mm};
  if (!isfinite(circle.x + circle.y + circle.radius)) return FG_OK;
  FG_TRY(fg_canvas_arc(ctx, canvas, &circle, 0, 2 * pi, (fg_pen){FG_COLOUR_OVERALL, 0.9, 8}));
  FG_TRY(draw_cross(ctx, canvas, overall->centre_mm, 0.5, FG_COLOUR_OVERALL));
  bool below =
      foil->strip.count && midpoint(&foil->strip.stations[foil->strip.count / 2]).y > circle.y;
  fg_point at = offset(overall->centre_mm, (fg_point){0, below ? 1 : -1},
                       22 * canvas->unit_px / canvas->px_per_mm[1]);
  return fg_canvas_text(ctx, canvas, at, 11, 0.5, FG_COLOUR_TEXT, "O");
}

/* Draws the cuts of a plain strip, prolonged beyond its edges, and their directions from O,
 * which enclose the angle. */
static fg_status draw_ends(fg_context *ctx, fg_canvas *canvas, const fg_foil *foil) {
  fg_point o = foil->overall.centre_mm;
  if (!isfinite(foil->arc.subtended_angle_deg)) return FG_OK;
  for (int i = 0; i < 2; i++) {
    const fg_strip_end *end = &foil->strip.ends[i];
    double dx = end->right.x - end->left.x, dy = end->right.y - end->left.y;
    const double beyond = 4; /* in widths of the strip: to be seen */
    const fg_point cut[1][2] = {{{end->left.x - beyond * dx, end->left.y - beyond * dy},
                                 {end->right.x + beyond * dx, end->right.y + beyond * dy}}};
    fg_point middle = {(end->left.x + end->right.x) / 2, (end->left.y + end->right.y) / 2};
    const fg_point ray[1][2] = {{o, middle}};
    FG_TRY(fg_canvas_segments(ctx, canvas, cut, 1, (fg_pen){FG_COLOUR_BUMP, 1.6, 0}));
    FG_TRY(fg_canvas_segments(ctx, canvas, ray, 1, (fg_pen){FG_COLOUR_OVERALL, 0.7, 0}));
  }
  return FG_OK;
}

static fg_status draw_foil(fg_context *ctx, fg_canvas *canvas, const fg_foil *foil,
                           double magnification) {
  if (foil->beam_count) return fg_draw_beams(ctx, canvas, foil, magnification);
  FG_TRY(draw_edges(ctx, canvas, &foil->strip));
  if (foil->flags & FG_FOIL_NOT_MEASURED) return FG_OK;
  FG_TRY(draw_whiskers(ctx, canvas, foil, magnification));
  FG_TRY(draw_overall(ctx, canvas, foil));
  FG_TRY(draw_ends(ctx, canvas, foil));
  for (size_t i = 0; i < foil->bump_count; i++)
    FG_TRY(draw_bump(ctx, canvas, foil, &foil->bumps[i]));
  return FG_OK;
}

static fg_status draw_disc(fg_context *ctx, fg_canvas *canvas, const fg_disc *disc,
                           double magnification) {
  const fg_circle circle = {disc->centre_mm.x, disc->centre_mm.y, disc->radius_mm};
  if (!isfinite(circle.x + circle.y + circle.radius)) return FG_OK;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, disc->points, sizeof(fg_point[2]), &block));
  fg_point(*whiskers)[2] = block;
  size_t used = 0;
  for (size_t i = 0; disc->edge && disc->residual_um && i < disc->points; i++) {
    fg_point outwards = direction_from(disc->centre_mm, disc->edge[i]);
    if (!isfinite(disc->residual_um[i])) continue;
    whiskers[used][0] = disc->edge[i];
    whiskers[used][1] =
        offset(disc->edge[i], outwards, disc->residual_um[i] * 1e-3 * magnification);
    used++;
  }
  fg_status status = fg_canvas_segments(ctx, canvas, (const fg_point(*)[2])whiskers, used,
                                        (fg_pen){FG_COLOUR_RESIDUAL, 0.7, 0});
  free(block);
  FG_TRY(status);
  FG_TRY(fg_canvas_arc(ctx, canvas, &circle, 0, 2 * pi, (fg_pen){FG_COLOUR_BUMP, 1.4, 0}));
  char number[16];
  snprintf(number, sizeof number, "%d", disc->number);
  return fg_canvas_text(ctx, canvas, disc->centre_mm, 12, 0.5, FG_COLOUR_TEXT, number);
}

/* The residuals' scale: a bar of 1 mm and its words, beside it or, where the canvas is too narrow for
 * that, in two rows below it. Units of the canvas. */
typedef struct scale_layout {
  bool is_narrow;
  double letter_height;
  double width, height;
} scale_layout;

static const double scale_margin = 30, scale_gap = 12, scale_row = 20;
/* Widths of the words at full size, in the longer of the languages: in one row and in two. */
static const double scale_words = 378, scale_half = 230;

static scale_layout lay_out_scale(const fg_canvas *canvas) {
  double bar = canvas->px_per_mm[0] / canvas->unit_px, room = canvas->width_px / canvas->unit_px;
  scale_layout layout = {.letter_height = 11,
                         .width = scale_margin + bar + scale_gap + scale_words,
                         .height = 56};
  if (layout.width <= room) return layout;
  layout.is_narrow = true;
  layout.letter_height *= fmin(1, fmax(0.2, (room - 2 * scale_margin) / scale_half));
  layout.width = fmin(room, scale_margin + fmax(bar, scale_half));
  layout.height += 2 * scale_row;
  return layout;
}

/* Returns the box of the scale in a corner of the canvas: 0 is the lower left, 1 the lower
 * right, 2 the upper left, 3 the upper right. */
static fg_drawing_box scale_box(const fg_canvas *canvas, int corner) {
  scale_layout layout = lay_out_scale(canvas);
  const double size_px[2] = {layout.width * canvas->unit_px, layout.height * canvas->unit_px};
  double x = corner % 2 ? fmax(0, canvas->width_px - size_px[0]) : 0;
  double y = corner < 2 ? canvas->height_px - size_px[1] : 0;
  fg_point low = {(x - canvas->origin_px[0]) / canvas->px_per_mm[0],
                  (y - canvas->origin_px[1]) / canvas->px_per_mm[1]};
  return (fg_drawing_box){
      low, {low.x + size_px[0] / canvas->px_per_mm[0], low.y + size_px[1] / canvas->px_per_mm[1]}};
}

static size_t count_beam_points(const fg_beam *beam, fg_drawing_box box) {
  size_t inside = 0;
  for (int side = 0; side < FG_BEAM_SIDES; side++)
    for (size_t k = 0; k < beam->edges[side].count; k++) {
      fg_point at = beam->edges[side].stations[k].at;
      inside += at.x > box.low.x && at.x < box.high.x && at.y > box.low.y && at.y < box.high.y;
    }
  return inside;
}

/* Counts the points of strips, with the residuals beside them, and of discs' edges in a box. */
static size_t crowd(const fg_measurement *measurement, fg_drawing_box box) {
  size_t inside = 0;
  double margin = baseline_mm + whisker_mm;
  for (size_t i = 0; i < measurement->foil_count; i++)
    for (size_t b = 0; b < measurement->foils[i].beam_count; b++)
      inside += count_beam_points(&measurement->foils[i].beams[b], box);
  for (size_t i = 0; i < measurement->foil_count; i++)
    for (size_t k = 0; k < measurement->foils[i].strip.count; k++) {
      fg_point at = midpoint(&measurement->foils[i].strip.stations[k]);
      inside += at.x > box.low.x - margin && at.x < box.high.x + margin &&
                at.y > box.low.y - margin && at.y < box.high.y + margin;
    }
  for (size_t i = 0; i < measurement->disc_count; i++)
    for (size_t k = 0; measurement->discs[i].edge && k < measurement->discs[i].points; k++) {
      fg_point at = measurement->discs[i].edge[k];
      inside += at.x > box.low.x && at.x < box.high.x && at.y > box.low.y && at.y < box.high.y;
    }
  return inside;
}

fg_drawing_box fg_drawing_scale_box(const fg_canvas *canvas, const fg_measurement *measurement) {
  fg_drawing_box best = scale_box(canvas, 0);
  size_t min = crowd(measurement, best);
  for (int corner = 1; corner < 4; corner++) {
    fg_drawing_box box = scale_box(canvas, corner);
    size_t inside = crowd(measurement, box);
    if (inside >= min) continue;
    min = inside;
    best = box;
  }
  return best;
}

static fg_status draw_scale_words(fg_context *ctx, fg_canvas *canvas, const scale_layout *layout,
                                  fg_point at, double magnification) {
  double row_mm = scale_row * canvas->unit_px / canvas->px_per_mm[1];
  char text[120];
  if (!layout->is_narrow) {
    snprintf(text, sizeof text, "1 mm; residual %.4g µm (drawn × %.0f)", 1000 / magnification,
             magnification);
    return fg_canvas_text(ctx, canvas, at, layout->letter_height, 0, FG_COLOUR_TEXT, text);
  }
  snprintf(text, sizeof text, "1 mm; residual %.4g µm", 1000 / magnification);
  FG_TRY(fg_canvas_text(ctx, canvas, (fg_point){at.x, at.y + row_mm}, layout->letter_height, 0,
                        FG_COLOUR_TEXT, text));
  snprintf(text, sizeof text, "(drawn × %.0f)", magnification);
  return fg_canvas_text(ctx, canvas, (fg_point){at.x, at.y + 2 * row_mm}, layout->letter_height, 0,
                        FG_COLOUR_TEXT, text);
}

/* Draws a bar of 1 mm in the emptiest corner, with the residual that it stands for. */
static fg_status draw_scale(fg_context *ctx, fg_canvas *canvas, const fg_measurement *measurement,
                            double magnification) {
  double unit_mm = canvas->unit_px / canvas->px_per_mm[0];
  scale_layout layout = lay_out_scale(canvas);
  fg_drawing_box box = fg_drawing_scale_box(canvas, measurement);
  fg_point left = {box.low.x + scale_margin * unit_mm,
                   box.low.y + 28 * canvas->unit_px / canvas->px_per_mm[1]};
  fg_point right = {left.x + 1, left.y};
  fg_point words_at = {layout.is_narrow ? left.x : right.x + scale_gap * unit_mm, left.y};
  const fg_point bar[3][2] = {{left, right},
                              {{left.x, left.y - 5 * unit_mm}, {left.x, left.y + 5 * unit_mm}},
                              {{right.x, right.y - 5 * unit_mm}, {right.x, right.y + 5 * unit_mm}}};
  FG_TRY(fg_canvas_segments(ctx, canvas, bar, 3, (fg_pen){FG_COLOUR_RESIDUAL, 2, 0}));
  return draw_scale_words(ctx, canvas, &layout, words_at, magnification);
}

fg_status fg_draw_measurement(fg_context *ctx, fg_canvas *canvas, const fg_measurement *measurement,
                              double magnification) {
  if (!(magnification > 0)) magnification = magnification_for(large_residual(measurement));
  for (size_t i = 0; i < measurement->foil_count; i++)
    FG_TRY(draw_foil(ctx, canvas, &measurement->foils[i], magnification));
  for (size_t i = 0; i < measurement->disc_count; i++)
    FG_TRY(draw_disc(ctx, canvas, &measurement->discs[i], magnification));
  return draw_scale(ctx, canvas, measurement, magnification);
}

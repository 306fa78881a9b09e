/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/picture_marks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/utf8.h"
#include "foilgauge/words.h"
#include "report/measure/drawing.h"

enum { COLOUR_FAIL = 0xff5252, COLOUR_OPEN = 0xffb833, MARKS_MAX = 40, TEXT_BYTES = 160 };

/* In units of the canvas. A capital's height; the width of a bold letter of that height, which
 * is 0.65 of its font's size, and that 1 / 0.7 of the height; the margin around a text. */
static const double letter_units = 12, width_per_height = 0.65 / 0.7, gap_units = 7;
/* Cells in which the picture is taken to be free or not, and the steps of places that are tried. */
static const double cell_units = 6;
/* A ring's radius over half the bump's chord; where residuals and the bump's number are drawn
 * (drawing.c) over the ring's centre, mm. */
static const double ring_over_chord = 1.08, ring_over_disc = 1.12, ring_over_width = 0.62,
                    number_mm = 2.1, band_mm = 0.9;

/* A mark at one place: for a value, or for a part without one (worst NULL: it fails). */
typedef struct mark {
  const fg_judgement *worst;
  fg_point at; /* mm: of the ring's centre, or of the overall circle's where there is no ring */
  double ring_mm;
  char text[TEXT_BYTES];
  double width_px, height_px; /* of the text, with its gap */
} mark;

/* Occupied cells of the picture. */
typedef struct cells {
  unsigned char *taken;
  int columns, rows;
  double size_px;
} cells;

typedef struct marks {
  fg_canvas *canvas;
  const fg_measurement *measurement;
  const fg_foil *foil; /* its one; NULL: discs */
  mark list[MARKS_MAX];
  size_t count;
  cells cells;
} marks;

static fg_point to_px(const fg_canvas *canvas, fg_point mm) {
  return (fg_point){canvas->origin_px[0] + mm.x * canvas->px_per_mm[0],
                    canvas->origin_px[1] + mm.y * canvas->px_per_mm[1]};
}

static fg_point to_mm(const fg_canvas *canvas, fg_point px) {
  return (fg_point){(px.x - canvas->origin_px[0]) / canvas->px_per_mm[0],
                    (px.y - canvas->origin_px[1]) / canvas->px_per_mm[1]};
}

static void occupy_box(cells *at, double left, double top, double right, double bottom) {
  int from = (int)fmax(0, floor(left / at->size_px)), to = (int)floor(right / at->size_px);
  int low = (int)fmax(0, floor(top / at->size_px)), high = (int)floor(bottom / at->size_px);
  for (int row = low; row <= high && row < at->rows; row++)
    for (int column = from; column <= to && column < at->columns; column++)
      at->taken[row * at->columns + column] = 1;
}

static bool is_free(const cells *at, double left, double top, double right, double bottom) {
  if (left < 0 || top < 0 || right >= at->columns * at->size_px || bottom >= at->rows * at->size_px)
    return false;
  for (int row = (int)(top / at->size_px); row <= (int)(bottom / at->size_px); row++)
    for (int column = (int)(left / at->size_px); column <= (int)(right / at->size_px); column++)
      if (at->taken[row * at->columns + column]) return false;
  return true;
}

/* A place without a value is worse than any value. */
static bool is_worse(const fg_judgement *one, const fg_judgement *other) {
  if (!one || !other) return !one && other;
  return fg_judgement_compare(one, other) < 0;
}

static const fg_judgement *find_worst(const fg_decision *decision, int number) {
  const fg_judgement *worst = NULL;
  for (size_t i = 0; i < decision->count; i++) {
    const fg_judgement *one = &decision->judgements[i];
    bool told = one->verdict == FG_VERDICT_FAIL || one->verdict == FG_VERDICT_UNDECIDED;
    if (one->number == number && told && isfinite(one->value) && (!worst || is_worse(one, worst)))
      worst = one;
  }
  return worst;
}

/* "3: R 3.454 mm, max 3.408". */
static void write_text(const fg_judgement *worst, char text[TEXT_BYTES]) {
  int decimals =
      worst->row->kind == FG_QUANTITY_COUNT ? 0 : fg_report_decimals(worst->row, worst->u);
  char number[16] = "";
  if (worst->number) snprintf(number, sizeof number, "%d: ", worst->number);
  snprintf(text, TEXT_BYTES, "%s%s %s%.*f %s, %s %.7g%s", number, worst->row->symbol,
           worst->value < 0 ? "−" : "", decimals, fabs(worst->value), worst->row->unit,
           worst->margin.upper ? "max" : "min", worst->margin.limit,
           worst->verdict == FG_VERDICT_FAIL ? "" : " ?");
}

static mark *add_text(marks *at, const char *text, fg_point where, double ring_mm) {
  if (at->count == MARKS_MAX || !isfinite(where.x + where.y + ring_mm)) return NULL;
  mark *added = &at->list[at->count++];
  *added = (mark){.at = where, .ring_mm = ring_mm};
  snprintf(added->text, sizeof added->text, "%s", text);
  size_t letters = fg_utf8_count(added->text);
  double unit = at->canvas->unit_px;
  added->width_px = ((double)letters * letter_units * width_per_height + 2 * gap_units) * unit;
  added->height_px = (letter_units + 2 * gap_units) * unit;
  return added;
}

static void add_mark(marks *at, const fg_judgement *worst, fg_point where, double ring_mm) {
  char text[TEXT_BYTES];
  if (!worst) return;
  write_text(worst, text);
  mark *added = add_text(at, text, where, ring_mm);
  if (added) added->worst = worst;
}

/* Around the middle of the bump's chord. */
static void add_bump(marks *at, const fg_decision *decision, const fg_bump *bump) {
  static const double half_turn_deg = 180, pi = 3.14159265358979323846, usual_rad = 0.55;
  fg_point centre = at->foil->overall.centre_mm;
  double away = hypot(centre.x - bump->centre_mm.x, centre.y - bump->centre_mm.y);
  double half = bump->bump_angle_deg / 2 * pi / half_turn_deg;
  if (!isfinite(half) || half > pi / 2) half = usual_rad;
  double share = bump->radius_mm * cos(half) / away;
  fg_point middle = {bump->centre_mm.x + share * (centre.x - bump->centre_mm.x),
                     bump->centre_mm.y + share * (centre.y - bump->centre_mm.y)};
  add_mark(at, find_worst(decision, bump->number), middle,
           ring_over_chord * bump->radius_mm * sin(half));
}

/* Around the middle of the beam. */
static void add_beam(marks *at, const fg_decision *decision, const fg_beam *beam) {
  fg_point middle = {0.5 * (beam->root_mm.x + beam->tip_mm.x),
                     0.5 * (beam->root_mm.y + beam->tip_mm.y)};
  double width = isfinite(beam->width_mm) ? beam->width_mm : at->measurement->design.beams.width_mm;
  char text[TEXT_BYTES];
  const fg_judgement *worst = find_worst(decision, beam->number);
  if (worst || isfinite(beam->length_mm)) {
    add_mark(at, worst, middle, ring_over_width * width);
    return;
  }
  snprintf(text, sizeof text, "%d: no length", beam->number);
  add_text(at, text, middle, ring_over_width * width);
}

static void occupy_beams(marks *at) {
  for (size_t i = 0; at->foil && i < at->foil->beam_count; i++) {
    const fg_beam *beam = &at->foil->beams[i];
    double length = hypot(beam->tip_mm.x - beam->root_mm.x, beam->tip_mm.y - beam->root_mm.y);
    double half_px = 0.5 * beam->width_mm * at->canvas->px_per_mm[0];
    for (double s = 0; half_px > 0 && s <= length; s += 0.5 * beam->width_mm) {
      fg_point px =
          to_px(at->canvas,
                (fg_point){beam->root_mm.x + s / length * (beam->tip_mm.x - beam->root_mm.x),
                           beam->root_mm.y + s / length * (beam->tip_mm.y - beam->root_mm.y)});
      occupy_box(&at->cells, px.x - half_px, px.y - half_px, px.x + half_px, px.y + half_px);
    }
  }
}

static void occupy_strip(marks *at) {
  const fg_canvas *canvas = at->canvas;
  double band_px = band_mm * canvas->px_per_mm[0];
  for (size_t i = 0; at->foil && i < at->foil->strip.count; i++) {
    const fg_station *station = &at->foil->strip.stations[i];
    fg_point px = to_px(canvas, (fg_point){(station->left.x + station->right.x) / 2,
                                           (station->left.y + station->right.y) / 2});
    occupy_box(&at->cells, px.x - band_px, px.y - band_px, px.x + band_px, px.y + band_px);
  }
}

static void occupy_numbers(marks *at) {
  const fg_canvas *canvas = at->canvas;
  double unit = canvas->unit_px;
  for (size_t i = 0; at->foil && i < at->foil->bump_count; i++) {
    const fg_bump *bump = &at->foil->bumps[i];
    fg_point centre = at->foil->overall.centre_mm;
    double away = hypot(centre.x - bump->centre_mm.x, centre.y - bump->centre_mm.y);
    double share = (bump->radius_mm + number_mm) / away;
    if (!isfinite(share)) continue;
    fg_point px =
        to_px(canvas, (fg_point){bump->centre_mm.x + share * (centre.x - bump->centre_mm.x),
                                 bump->centre_mm.y + share * (centre.y - bump->centre_mm.y)});
    occupy_box(&at->cells, px.x - 14 * unit, px.y - 10 * unit, px.x + 14 * unit, px.y + 10 * unit);
  }
}

static void occupy_centre(marks *at) {
  if (!at->foil) return;
  fg_point centre = to_px(at->canvas, at->foil->overall.centre_mm);
  double around = 40 * at->canvas->unit_px;
  if (isfinite(centre.x + centre.y))
    occupy_box(&at->cells, centre.x - around, centre.y - around, centre.x + around,
               centre.y + around);
}

static void occupy_discs(marks *at) {
  const fg_canvas *canvas = at->canvas;
  for (size_t i = 0; i < at->measurement->disc_count; i++) {
    const fg_disc *disc = &at->measurement->discs[i];
    double radius_px = ring_over_disc * disc->radius_mm * canvas->px_per_mm[0];
    fg_point px = to_px(canvas, disc->centre_mm);
    if (isfinite(px.x + px.y + radius_px))
      occupy_box(&at->cells, px.x - radius_px, px.y - radius_px, px.x + radius_px,
                 px.y + radius_px);
  }
}

/* Marks the cells of the drawing as occupied. */
static void occupy_drawing(marks *at) {
  const fg_canvas *canvas = at->canvas;
  fg_drawing_box scale = fg_drawing_scale_box(canvas, at->measurement);
  fg_point low = to_px(canvas, scale.low), high = to_px(canvas, scale.high);
  occupy_box(&at->cells, low.x, low.y, high.x, high.y);
  occupy_centre(at);
  occupy_strip(at);
  occupy_beams(at);
  occupy_numbers(at);
  occupy_discs(at);
  for (size_t i = 0; i < at->count; i++) {
    double ring_px = at->list[i].ring_mm * canvas->px_per_mm[0];
    fg_point px = to_px(canvas, at->list[i].at);
    occupy_box(&at->cells, px.x - ring_px, px.y - ring_px, px.x + ring_px, px.y + ring_px);
  }
}

/* Finds the free place whose middle is nearest; false: there is none. */
static bool find_place(const marks *at, const mark *one, fg_point *middle) {
  fg_point anchor = to_px(at->canvas, one->at);
  double best = INFINITY, step = at->cells.size_px;
  double half[2] = {one->width_px / 2, one->height_px / 2};
  for (double y = half[1]; y < at->canvas->height_px - half[1]; y += step)
    for (double x = half[0]; x < at->canvas->width_px - half[0]; x += step) {
      /* A text is wide: places above or below are nearer than those beside it. */
      double distance = hypot(fmax(0, fabs(x - anchor.x) - half[0] / 2), y - anchor.y);
      if (distance >= best ||
          !is_free(&at->cells, x - half[0], y - half[1], x + half[0], y + half[1]))
        continue;
      best = distance;
      *middle = (fg_point){x, y};
    }
  return isfinite(best);
}

/* Draws a straight line from the ring to the text's edge. */
static fg_status draw_leader(fg_context *ctx, fg_canvas *canvas, const mark *one, fg_point middle,
                             fg_pen pen) {
  fg_point ring = to_px(canvas, one->at);
  double ring_px = one->ring_mm * canvas->px_per_mm[0];
  double half[2] = {one->width_px / 2, letter_units * canvas->unit_px};
  fg_point to = {fmax(middle.x - half[0], fmin(ring.x, middle.x + half[0])),
                 middle.y + (ring.y > middle.y ? half[1] : -half[1])};
  double away = hypot(to.x - ring.x, to.y - ring.y);
  if (!(away > ring_px)) return FG_OK;
  fg_point from = {ring.x + (to.x - ring.x) * ring_px / away,
                   ring.y + (to.y - ring.y) * ring_px / away};
  const fg_point line[1][2] = {{to_mm(canvas, from), to_mm(canvas, to)}};
  return fg_canvas_segments(ctx, canvas, line, 1, pen);
}

static fg_status draw_mark(fg_context *ctx, marks *at, const mark *one) {
  static const double full_turn_rad = 6.283185307179586;
  bool fails = !one->worst || one->worst->verdict == FG_VERDICT_FAIL;
  uint32_t colour = fails ? COLOUR_FAIL : COLOUR_OPEN;
  const fg_circle ring = {one->at.x, one->at.y, one->ring_mm};
  fg_point middle = {0, 0};
  if (one->ring_mm > 0)
    FG_TRY(fg_canvas_arc(ctx, at->canvas, &ring, 0, full_turn_rad, (fg_pen){colour, 3, 0}));
  if (!find_place(at, one, &middle)) return FG_OK;
  occupy_box(&at->cells, middle.x - one->width_px / 2, middle.y - one->height_px / 2,
             middle.x + one->width_px / 2, middle.y + one->height_px / 2);
  if (one->ring_mm > 0) FG_TRY(draw_leader(ctx, at->canvas, one, middle, (fg_pen){colour, 1.4, 0}));
  return fg_canvas_text(ctx, at->canvas, to_mm(at->canvas, middle), letter_units, 0.5, colour,
                        one->text);
}

/* The worst first: they get the nearest places. */
static int by_excess(const void *a, const void *b) {
  const mark *one = a, *other = b;
  return is_worse(one->worst, other->worst) ? -1 : is_worse(other->worst, one->worst) ? 1 : 0;
}

static fg_status draw_marks(fg_context *ctx, marks *at) {
  const fg_canvas *canvas = at->canvas;
  void *block;
  at->cells.size_px = cell_units * canvas->unit_px;
  at->cells.columns = (int)(canvas->width_px / at->cells.size_px) + 1;
  at->cells.rows = (int)(canvas->height_px / at->cells.size_px) + 1;
  FG_TRY(fg_memory_allocate(ctx, (size_t)at->cells.columns, (size_t)at->cells.rows, &block));
  at->cells.taken = block;
  memset(block, 0, (size_t)at->cells.columns * (size_t)at->cells.rows);
  occupy_drawing(at);
  fg_sort_items(at->list, at->count, sizeof *at->list, by_excess);
  fg_status status = FG_OK;
  for (size_t i = 0; i < at->count && status == FG_OK; i++)
    status = draw_mark(ctx, at, &at->list[i]);
  free(block);
  return status;
}

static const fg_bump *find_bump_by_number(const fg_foil *foil, int number) {
  for (size_t i = 0; i < foil->bump_count; i++)
    if (foil->bumps[i].number == number && isfinite(foil->bumps[i].position_deg))
      return &foil->bumps[i];
  return NULL;
}

/* Finds the place of a missing bump: on the overall circle, half-way between its neighbours, or
 * one pitch beyond the last. False: too few of them are there. */
static bool find_gap(const fg_foil *foil, int number, fg_point *at) {
  static const double radian = 3.14159265358979323846 / 180;
  const fg_bump *before = find_bump_by_number(foil, number - 1),
                *behind = find_bump_by_number(foil, number + 1);
  double turn_deg;
  if (before && behind) {
    turn_deg =
        before->position_deg + remainder(behind->position_deg - before->position_deg, 360) / 2;
  } else {
    const fg_bump *near = before ? before : behind;
    const fg_bump *next = find_bump_by_number(foil, before ? number - 2 : number + 2);
    if (!near || !next) return false;
    turn_deg = near->position_deg + remainder(near->position_deg - next->position_deg, 360);
  }
  *at = (fg_point){foil->overall.centre_mm.x + foil->overall.radius_mm * cos(turn_deg * radian),
                   foil->overall.centre_mm.y + foil->overall.radius_mm * sin(turn_deg * radian)};
  return true;
}

/* Adds marks for bumps without values: missing ones, and those whose circle could not be fitted. */
static void add_gaps(marks *at) {
  const double half_chord_mm = 1.8; /* of a ring around nothing */
  int last = (int)at->measurement->design.bumps.count;
  for (size_t i = 0; i < at->foil->bump_count; i++)
    if (at->foil->bumps[i].number > last) last = at->foil->bumps[i].number;
  for (int number = 1; number <= last; number++) {
    bool there = false, fitted = false;
    for (size_t i = 0; i < at->foil->bump_count; i++)
      if (at->foil->bumps[i].number == number) {
        there = true;
        fitted = !(at->foil->bumps[i].flags & FG_BUMP_NOT_FITTED);
      }
    char text[TEXT_BYTES];
    fg_point where;
    if (fitted || !fg_foil_is_measured(at->foil) || !find_gap(at->foil, number, &where)) continue;
    if (!there && at->foil->flags & FG_FOIL_TOUCHES_BORDER) continue;
    snprintf(text, sizeof text, there ? "%d: not fitted" : "%d: missing", number);
    add_text(at, text, where, half_chord_mm);
  }
}

static fg_status draw_foil(fg_context *ctx, marks *at) {
  fg_decision decision;
  FG_TRY(fg_foil_decide(ctx, &at->measurement->design, at->foil, &decision));
  for (size_t i = 0; i < at->foil->bump_count; i++)
    add_bump(at, &decision, &at->foil->bumps[i]);
  for (size_t i = 0; i < at->foil->beam_count; i++)
    add_beam(at, &decision, &at->foil->beams[i]);
  if (fg_foil_kind_has_bumps(at->measurement->design.kind)) add_gaps(at);
  fg_canvas *canvas = at->canvas;
  fg_point px = to_px(canvas, at->foil->overall.centre_mm);
  px = (fg_point){fmin(fmax(px.x, 0), canvas->width_px), fmin(fmax(px.y, 0), canvas->height_px)};
  add_mark(at, find_worst(&decision, 0), to_mm(canvas, px), 0);
  fg_status status = at->count ? draw_marks(ctx, at) : FG_OK;
  fg_decision_free(&decision);
  return status;
}

static fg_status draw_discs(fg_context *ctx, marks *at) {
  const fg_measurement *measurement = at->measurement;
  size_t count = measurement->disc_count < MARKS_MAX ? measurement->disc_count : MARKS_MAX;
  fg_decision decisions[MARKS_MAX];
  fg_status status = FG_OK;
  size_t made = 0;
  for (; made < count && status == FG_OK; made++) {
    const fg_disc *disc = &measurement->discs[made];
    status = fg_disc_decide(ctx, &measurement->design, disc, &decisions[made]);
    if (status != FG_OK) break;
    add_mark(at, find_worst(&decisions[made], disc->number), disc->centre_mm,
             ring_over_disc * disc->radius_mm);
  }
  if (status == FG_OK && at->count) status = draw_marks(ctx, at);
  while (made)
    fg_decision_free(&decisions[--made]);
  return status;
}

fg_status fg_draw_verdicts(fg_context *ctx, fg_canvas *canvas, const fg_measurement *measurement) {
  marks at = {.canvas = canvas, .measurement = measurement};
  if (measurement->disc_count) return draw_discs(ctx, &at);
  if (!measurement->foil_count) return FG_OK;
  at.foil = measurement->foils;
  return draw_foil(ctx, &at);
}

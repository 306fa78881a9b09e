/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/beam_find.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "vision/cut_floor.h"

/* Factors of a design's beam length and width within which a beam is accepted. A torn beam or one
 * of another size is reported by its values, not left out. */
#define LENGTH_MIN 0.3
#define LENGTH_MAX 3.0
#define WIDTH_MIN  0.3
#define WIDTH_MAX  3.0
/* Straightness tolerance as a share of the width, within limits in px. */
#define TOLERANCE_SHARE 0.01
#define TOLERANCE_MIN   2.0
#define TOLERANCE_MAX   5.0
/* Max angles between both long sides, and of the tip from across them. */
#define PARALLEL_RAD 0.15
#define ACROSS_RAD   0.45
/* Min straight part of a tip, as a share of the width. */
#define TIP_SHARE 0.3
/* A tip is torn when more than this share of its middle half deviates from its line by more than so
 * many tolerances: a burr or dust is smaller. */
#define TORN_SHARE      0.3
#define TORN_TOLERANCES 1.3
/* Max length of the rim over the tip, in widths. */
#define TIP_WIDTHS 4.0
/* Share at either end that a line's fit leaves out. */
#define TRIM 0.1

fg_beam_limits fg_beam_limits_of(const fg_design *design, const fg_pixel_shape *shape) {
  double length = design->beams.length_mm * 1000 / shape->um;
  double width = design->beams.width_mm * 1000 / shape->um;
  return (fg_beam_limits){.length_px = {LENGTH_MIN * length, LENGTH_MAX * length},
                          .width_px = {WIDTH_MIN * width, WIDTH_MAX * width},
                          .tolerance_px =
                              fmin(fmax(TOLERANCE_SHARE * width, TOLERANCE_MIN), TOLERANCE_MAX)};
}

static const fg_polygon_side *side_at(const fg_polygon *rim, size_t i) {
  return &rim->sides[i % rim->count];
}

static bool is_long(const fg_polygon_side *side, const fg_beam_limits *limits) {
  return side->length >= limits->length_px[0];
}

/* Finds the side that leads back from the tip for a side that leads there; returns its distance in
 * sides, 0 for none. */
static size_t find_side_back(const fg_polygon *rim, const fg_beam_limits *limits, size_t a) {
  double turn = 0;
  for (size_t k = 1; k < rim->count; k++) {
    const fg_polygon_side *before = side_at(rim, a + k - 1), *side = side_at(rim, a + k);
    turn += fg_polygon_turn(before->angle, side->angle);
    double way = (double)fg_polygon_span(rim, side_at(rim, a)->last, side->first);
    if (turn < -1 || turn > 4 || way > TIP_WIDTHS * limits->width_px[1]) return 0;
    /* Another side leads to the tip: the tip belongs to it. */
    if (fabs(turn) < PARALLEL_RAD && is_long(side, limits)) return 0;
    if (fabs(turn - M_PI) < PARALLEL_RAD && is_long(side, limits)) return k;
  }
  return 0;
}

/* Returns the index of the side across the tip, or `a` where there is none. */
static size_t find_tip(const fg_polygon *rim, size_t a, size_t back, double width) {
  size_t best = a;
  double longest = TIP_SHARE * width;
  for (size_t k = 1; k < back; k++) {
    const fg_polygon_side *side = side_at(rim, a + k);
    double turn = fg_polygon_turn(side_at(rim, a)->angle, side->angle);
    if (fabs(turn - M_PI_2) > ACROSS_RAD || side->length < longest) continue;
    longest = side->length;
    best = a + k;
  }
  return best;
}

static fg_straight straight_of(const fg_polygon *rim, size_t i) {
  const fg_polygon_side *side = side_at(rim, i);
  return fg_polygon_straight(rim, side->first, side->last, TRIM);
}

/* Cuts the part of a line between two of its points, without the parts near either that are not
 * straight. */
static bool cut_stretch(const fg_straight *line, fg_point from, fg_point to, double off_from,
                        double off_to, fg_stretch *stretch) {
  double a = line->along.x * (from.x - line->at.x) + line->along.y * (from.y - line->at.y);
  double b = line->along.x * (to.x - line->at.x) + line->along.y * (to.y - line->at.y);
  a += off_from;
  b -= off_to;
  *stretch = (fg_stretch){{line->at.x + a * line->along.x, line->at.y + a * line->along.y},
                          {line->at.x + b * line->along.x, line->at.y + b * line->along.y},
                          INFINITY,
                          0};
  return b - a >= FG_STRETCH_MIN_PX;
}

/* A beam in work. */
typedef struct beam_work {
  const fg_polygon *rim;
  size_t a, b, tip;             /* sides */
  fg_straight left, right, top; /* their lines; top is not used without a tip */
  fg_cut_floor floors[2];
} beam_work;

/* Returns true when the rim over the tip follows the tip's line. */
static bool is_straight_tip(const beam_work *w, double width, double tolerance) {
  const fg_polygon *rim = w->rim;
  size_t first = side_at(rim, w->a)->last, middle = 0, off = 0;
  size_t n = fg_polygon_span(rim, first, side_at(rim, w->b)->first);
  for (size_t i = 0; i < n; i++) {
    fg_point p = rim->points[(first + i) % rim->point_count];
    if (fabs(fg_straight_left(&w->left, p) / width - 0.5) > 0.25) continue;
    middle++;
    off += fabs(fg_straight_left(&w->top, p)) > TORN_TOLERANCES * tolerance;
  }
  return middle > 0 && (double)off <= TORN_SHARE * (double)middle;
}

static fg_point foot_of(const fg_straight *line, fg_point p) {
  double t = line->along.x * (p.x - line->at.x) + line->along.y * (p.y - line->at.y);
  return (fg_point){line->at.x + t * line->along.x, line->at.y + t * line->along.y};
}

/* Returns the root end of a long side: at its own floor, or beside the other side's. */
static fg_point root_of(const beam_work *w, int side) {
  const fg_straight *line = side ? &w->right : &w->left;
  return foot_of(line, w->floors[w->floors[side].found ? side : !side].place);
}

static double root_margin(const beam_work *w, int side) {
  return (w->floors[side].found ? w->floors[side].corner : 0) + FG_CORNER_MARGIN_PX;
}

static void place_sides(const beam_work *w, fg_beam_place *place) {
  bool torn = w->tip == w->a;
  const fg_polygon_side *a = side_at(w->rim, w->a), *b = side_at(w->rim, w->b);
  fg_point corner[2] = {w->rim->points[a->last], w->rim->points[b->first]};
  double radius[2] = {0, 0};
  if (!torn) {
    corner[0] = fg_straight_meet(&w->left, &w->top);
    corner[1] = fg_straight_meet(&w->top, &w->right);
    radius[0] = fg_corner_radius(w->rim, a->last, side_at(w->rim, w->tip)->first, corner[0]);
    radius[1] = fg_corner_radius(w->rim, side_at(w->rim, w->tip)->last, b->first, corner[1]);
  }
  double off[2] = {radius[0] + FG_CORNER_MARGIN_PX, radius[1] + FG_CORNER_MARGIN_PX};
  fg_stretch *sides = place->sides;
  place->there[FG_BEAM_LEFT] = cut_stretch(&w->left, root_of(w, 0), corner[0], root_margin(w, 0),
                                           off[0], &sides[FG_BEAM_LEFT]);
  place->there[FG_BEAM_RIGHT] = cut_stretch(&w->right, corner[1], root_of(w, 1), off[1],
                                            root_margin(w, 1), &sides[FG_BEAM_RIGHT]);
  place->there[FG_BEAM_TIP] =
      !torn && cut_stretch(&w->top, corner[0], corner[1], off[0], off[1], &sides[FG_BEAM_TIP]);
  for (int i = 0; i < 2; i++) {
    place->there[FG_BEAM_ROOT_LEFT + i] = w->floors[i].found;
    sides[FG_BEAM_ROOT_LEFT + i] = w->floors[i].stretch;
    if (!w->floors[i].found) place->flags |= FG_BEAM_ONE_FLOOR;
  }
  if (!place->there[FG_BEAM_TIP]) place->flags |= FG_BEAM_TORN_TIP;
  fg_point root[2] = {root_of(w, 0), root_of(w, 1)};
  place->root = (fg_point){0.5 * (root[0].x + root[1].x), 0.5 * (root[0].y + root[1].y)};
  place->tip = (fg_point){0.5 * (corner[0].x + corner[1].x), 0.5 * (corner[0].y + corner[1].y)};
  place->length_px = hypot(place->tip.x - place->root.x, place->tip.y - place->root.y);
}

/* Makes a beam of two long sides, if they bound one. */
static bool make_place(const fg_polygon *rim, const fg_beam_limits *limits, size_t a, size_t back,
                       fg_beam_place *place) {
  beam_work w = {.rim = rim, .a = a, .b = a + back};
  *place = (fg_beam_place){0};
  w.left = straight_of(rim, w.a);
  w.right = straight_of(rim, w.b);
  place->width_px = fg_straight_left(&w.left, w.right.at);
  if (!(place->width_px >= limits->width_px[0] && place->width_px <= limits->width_px[1]))
    return false;
  w.tip = find_tip(rim, a, back, place->width_px);
  if (w.tip != a) w.top = straight_of(rim, w.tip);
  if (w.tip != a && !is_straight_tip(&w, place->width_px, limits->tolerance_px)) w.tip = a;
  fg_cut_floor_find(rim, w.a, false, &w.left, place->width_px, &w.floors[0]);
  fg_cut_floor_find(rim, w.b, true, &w.right, place->width_px, &w.floors[1]);
  if (!w.floors[0].found && !w.floors[1].found) return false;
  place_sides(&w, place);
  for (int i = 0; i < 2; i++) {
    place->edge_sides[i] = (i ? w.b : w.a) % rim->count;
    place->floor_sides[i] = w.floors[i].side;
  }
  return place->there[FG_BEAM_LEFT] && place->there[FG_BEAM_RIGHT] &&
         place->length_px >= limits->length_px[0] && place->length_px <= limits->length_px[1];
}

/* Returns true when two beams exclude each other. Beside the base of a comb a beam and the base's
 * shoulder can each be mistaken for a beam that has the other for its floor. */
static bool is_exclusive(const fg_beam_place *a, const fg_beam_place *b) {
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 2; k++)
      if (a->floor_sides[i] == b->edge_sides[k] || b->floor_sides[i] == a->edge_sides[k] ||
          a->edge_sides[i] == b->edge_sides[k])
        return true;
  return false;
}

/* Deviation of a beam's size from the design's. */
static double size_deviation(const fg_beam_place *place, const fg_beam_limits *limits) {
  double length = sqrt(limits->length_px[0] * limits->length_px[1] / (LENGTH_MIN * LENGTH_MAX));
  double width = sqrt(limits->width_px[0] * limits->width_px[1] / (WIDTH_MIN * WIDTH_MAX));
  return fabs(log(place->length_px / length)) + fabs(log(place->width_px / width));
}

/* Keeps, of places that exclude each other, the one that is more like the design. */
static void drop_odd(const fg_beam_limits *limits, size_t first, fg_beam_places *places) {
  for (size_t i = first; i < places->count; i++)
    for (size_t k = i + 1; k < places->count;) {
      fg_beam_place *a = &places->list[i], *b = &places->list[k];
      if (!is_exclusive(a, b)) {
        k++;
        continue;
      }
      if (size_deviation(b, limits) < size_deviation(a, limits)) {
        *a = *b;
        k = i + 1; /* an excluded place may lie before it */
      }
      size_t at = (size_t)(b - places->list);
      memmove(b, b + 1, (places->count - at - 1) * sizeof *b);
      places->count--;
    }
}

fg_status fg_beams_find(fg_context *ctx, const fg_polygon *rim, const fg_beam_limits *limits,
                        fg_beam_places *places) {
  size_t first = places->count;
  for (size_t a = 0; a < rim->count; a++) {
    fg_beam_place place;
    if (!is_long(&rim->sides[a], limits)) continue;
    size_t back = find_side_back(rim, limits, a);
    if (!back || !make_place(rim, limits, a, back, &place)) continue;
    FG_TRY(fg_memory_reserve(ctx, places->count + 1, sizeof *places->list, &places->capacity,
                             (void **)&places->list));
    places->list[places->count++] = place;
  }
  drop_odd(limits, first, places);
  return FG_OK;
}

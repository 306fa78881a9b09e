/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/lattice.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* Steps are sought between a place and its nearest ones; each is tried on some places. */
enum { NEAREST = 24, STEPS_MAX = 480, TRIED_MAX = 300, PLACES_MIN = 4, ROUNDS = 12 };
/* Distance of a place from the lattice's, as a share of the step: in the search for the step, and
 * of places beside known ones. */
#define STEP_TOLERANCE  0.08
#define PLACE_TOLERANCE 0.2
/* Directions of corners, rad. A step has fewer hits than another by no more than this share. */
#define DIRECTION_TOLERANCE 0.08
#define HITS_SHARE          0.7

/* Places in square cells, for neighbours. */
typedef struct place_index {
  const fg_lattice_place *places;
  size_t count;
  double low[2], cell;
  int32_t width, height;
  int32_t *first, *next; /* owned; -1: none */
} place_index;

static size_t cell_of(const place_index *index, fg_point at) {
  int32_t x = (int32_t)floor((at.x - index->low[0]) / index->cell);
  int32_t y = (int32_t)floor((at.y - index->low[1]) / index->cell);
  x = x < 0 ? 0 : x >= index->width ? index->width - 1 : x;
  y = y < 0 ? 0 : y >= index->height ? index->height - 1 : y;
  return (size_t)y * (size_t)index->width + (size_t)x;
}

static fg_status build_index(fg_context *ctx, const fg_lattice_place *places, size_t count,
                             place_index *index) {
  double high[2] = {-INFINITY, -INFINITY};
  *index = (place_index){.places = places, .count = count, .low = {INFINITY, INFINITY}};
  for (size_t i = 0; i < count; i++) {
    index->low[0] = fmin(index->low[0], places[i].at.x);
    index->low[1] = fmin(index->low[1], places[i].at.y);
    high[0] = fmax(high[0], places[i].at.x);
    high[1] = fmax(high[1], places[i].at.y);
  }
  double w = high[0] - index->low[0], h = high[1] - index->low[1];
  index->cell = fmax(sqrt(w * h / (double)count), fmax(w, h) / (double)count);
  if (!(index->cell > 0)) index->cell = 1;
  index->width = (int32_t)(w / index->cell) + 1;
  index->height = (int32_t)(h / index->cell) + 1;
  size_t cells = (size_t)index->width * (size_t)index->height;
  FG_TRY(fg_memory_allocate(ctx, cells, sizeof *index->first, (void **)&index->first));
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *index->next, (void **)&index->next));
  for (size_t i = 0; i < cells; i++)
    index->first[i] = -1;
  for (size_t i = 0; i < count; i++) {
    size_t cell = cell_of(index, places[i].at);
    index->next[i] = index->first[cell];
    index->first[cell] = (int32_t)i;
  }
  return FG_OK;
}

static void free_index(place_index *index) {
  free(index->first);
  free(index->next);
}

/* The nearest place within `within`, other than `but`; -1: none. */
static int32_t find_near(const place_index *index, fg_point at, double within, size_t but) {
  int32_t best = -1;
  double best_square = within * within;
  int32_t x0 = (int32_t)floor((at.x - within - index->low[0]) / index->cell);
  int32_t x1 = (int32_t)floor((at.x + within - index->low[0]) / index->cell);
  int32_t y0 = (int32_t)floor((at.y - within - index->low[1]) / index->cell);
  int32_t y1 = (int32_t)floor((at.y + within - index->low[1]) / index->cell);
  for (int32_t y = y0 < 0 ? 0 : y0; y <= y1 && y < index->height; y++)
    for (int32_t x = x0 < 0 ? 0 : x0; x <= x1 && x < index->width; x++)
      for (int32_t k = index->first[(size_t)y * (size_t)index->width + (size_t)x]; k >= 0;
           k = index->next[k]) {
        double dx = index->places[k].at.x - at.x, dy = index->places[k].at.y - at.y;
        if ((size_t)k == but || dx * dx + dy * dy > best_square) continue;
        best_square = dx * dx + dy * dy;
        best = k;
      }
  return best;
}

/* ---- the step ---- */

/* A corner's edges run along the lattice. */
static bool suits_direction(const fg_lattice_place *place, fg_point step) {
  if (isnan(place->direction_rad)) return true;
  return fabs(remainder(atan2(step.y, step.x) - place->direction_rad, M_PI / 2)) <
         DIRECTION_TOLERANCE;
}

/* Number of tried places that have a neighbour by the step. */
static double count_hits(const place_index *index, fg_point step) {
  double length = hypot(step.x, step.y), hits = 0;
  size_t stride = index->count / TRIED_MAX + 1;
  for (size_t i = 0; i < index->count; i += stride) {
    fg_point at = index->places[i].at;
    bool suits = suits_direction(&index->places[i], step);
    for (int way = -1; way <= 1 && suits; way += 2)
      hits += find_near(index, (fg_point){at.x + way * step.x, at.y + way * step.y},
                        STEP_TOLERANCE * length, i) >= 0;
  }
  return hits;
}

typedef struct lattice_step {
  fg_point step;
  double hits;
} lattice_step;

/* Differences to the nearest places, by insertion. */
static size_t list_neighbours(const place_index *index, size_t i, fg_point *steps) {
  double square[NEAREST];
  size_t count = 0;
  for (size_t k = 0; k < index->count; k++) {
    fg_point d = {index->places[k].at.x - index->places[i].at.x,
                  index->places[k].at.y - index->places[i].at.y};
    double own = d.x * d.x + d.y * d.y;
    if (k == i || (count == NEAREST && own >= square[count - 1])) continue;
    size_t place = count < NEAREST ? count++ : count - 1;
    for (; place > 0 && square[place - 1] > own; place--) {
      square[place] = square[place - 1];
      steps[place] = steps[place - 1];
    }
    square[place] = own;
    steps[place] = d;
  }
  return count;
}

static size_t list_steps(const place_index *index, lattice_step *list) {
  size_t count = 0, stride = index->count / (STEPS_MAX / NEAREST) + 1;
  for (size_t i = 0; i < index->count; i += stride) {
    fg_point steps[NEAREST];
    size_t near = list_neighbours(index, i, steps);
    for (size_t k = 0; k < near && count < STEPS_MAX; k++) {
      if (!suits_direction(&index->places[i], steps[k])) continue;
      list[count++] = (lattice_step){steps[k], count_hits(index, steps[k])};
    }
  }
  return count;
}

/* The shortest of the steps with nearly most hits. */
static bool choose_step(const lattice_step *list, size_t count, fg_point *step) {
  double max_hits = 0, shortest = INFINITY;
  for (size_t i = 0; i < count; i++)
    max_hits = fmax(max_hits, list[i].hits);
  for (size_t i = 0; i < count; i++) {
    double length = hypot(list[i].step.x, list[i].step.y);
    if (list[i].hits < HITS_SHARE * max_hits || length >= shortest) continue;
    shortest = length;
    *step = list[i].step;
  }
  return max_hits >= 2;
}

/* ---- the places ---- */

static fg_point place_at(const fg_lattice *lattice, double column, double row) {
  return (fg_point){lattice->origin.x + column * lattice->axis[0].x + row * lattice->axis[1].x,
                    lattice->origin.y + column * lattice->axis[0].y + row * lattice->axis[1].y};
}

/* Least squares of origin and steps to the places that are on. Returns false for places on a line
 * of one axis. */
static bool fit_steps(const fg_lattice_place *places, size_t count, bool one_axis,
                      fg_lattice *lattice) {
  double n = 0, mean[4] = {0}, cc = 0, cr = 0, rr = 0, right[2][2] = {{0}};
  for (size_t i = 0; i < count; i++) {
    if (!places[i].on) continue;
    const double value[4] = {places[i].column, places[i].row, places[i].at.x, places[i].at.y};
    for (int k = 0; k < 4; k++)
      mean[k] += value[k];
    n++;
  }
  for (int k = 0; k < 4; k++)
    mean[k] /= n;
  for (size_t i = 0; i < count; i++) {
    if (!places[i].on) continue;
    double c = places[i].column - mean[0], r = places[i].row - mean[1];
    double off[2] = {places[i].at.x - mean[2], places[i].at.y - mean[3]};
    cc += c * c;
    cr += c * r;
    rr += r * r;
    for (int k = 0; k < 2; k++) {
      right[0][k] += c * off[k];
      right[1][k] += r * off[k];
    }
  }
  if (one_axis) rr = 1, cr = 0;
  double det = cc * rr - cr * cr;
  if (!(det > 1e-9)) return false;
  double a[2], b[2];
  for (int k = 0; k < 2; k++) {
    a[k] = (rr * right[0][k] - cr * right[1][k]) / det;
    b[k] = (cc * right[1][k] - cr * right[0][k]) / det;
  }
  lattice->axis[0] = (fg_point){a[0], a[1]};
  lattice->axis[1] = one_axis ? (fg_point){-a[1], a[0]} : (fg_point){b[0], b[1]};
  lattice->origin =
      (fg_point){mean[2] - mean[0] * lattice->axis[0].x - mean[1] * lattice->axis[1].x,
                 mean[3] - mean[0] * lattice->axis[0].y - mean[1] * lattice->axis[1].y};
  return true;
}

typedef struct lattice_growth {
  const place_index *index;
  fg_lattice_place *places;
  const fg_lattice *lattice;
  int32_t *queue; /* owned by the caller */
  size_t known;
} lattice_growth;

/* Gives the neighbours of known places their indices, step by step: the lattice may bend over its
 * length, but not from mark to mark. */
static void grow_from(lattice_growth *growth, size_t seed) {
  static const int ways[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  fg_lattice_place *places = growth->places;
  const fg_point *axis = growth->lattice->axis;
  double within = PLACE_TOLERANCE * hypot(axis[0].x, axis[0].y);
  growth->queue[growth->known++] = (int32_t)seed;
  places[seed].on = true;
  places[seed].column = places[seed].row = 0;
  for (size_t head = 0; head < growth->known; head++) {
    const fg_lattice_place *from = &places[growth->queue[head]];
    for (int w = 0; w < 4; w++) {
      fg_point at = {from->at.x + ways[w][0] * axis[0].x + ways[w][1] * axis[1].x,
                     from->at.y + ways[w][0] * axis[0].y + ways[w][1] * axis[1].y};
      int32_t k = find_near(growth->index, at, within, SIZE_MAX);
      if (k < 0 || places[k].on || !suits_direction(&places[k], axis[0])) continue;
      places[k].on = true;
      places[k].column = from->column + ways[w][0];
      places[k].row = from->row + ways[w][1];
      growth->queue[growth->known++] = k;
    }
  }
}

/* Takes places across gaps, which lie where the fitted lattice has one; drops those that do not. */
static size_t take_across_gaps(fg_lattice_place *places, size_t count, const fg_lattice *lattice) {
  const fg_point *a = lattice->axis;
  double det = a[0].x * a[1].y - a[0].y * a[1].x;
  size_t on = 0;
  for (size_t i = 0; i < count; i++) {
    fg_lattice_place *p = &places[i];
    double dx = p->at.x - lattice->origin.x, dy = p->at.y - lattice->origin.y;
    double c = (dx * a[1].y - dy * a[1].x) / det, r = (dy * a[0].x - dx * a[0].y) / det;
    if (lattice->one_axis) r = 0;
    bool near = fabs(c - round(c)) < PLACE_TOLERANCE && fabs(r - round(r)) < PLACE_TOLERANCE;
    if (!p->on && near && suits_direction(p, a[0])) {
      p->column = (int)round(c);
      p->row = (int)round(r);
      p->on = true;
    }
    on += p->on;
  }
  return on;
}

/* Of two places with one index the nearer one stays. */
static void drop_second_places(fg_lattice_place *places, size_t count, const fg_lattice *lattice) {
  for (size_t i = 0; i < count; i++)
    for (size_t k = i + 1; k < count && places[i].on; k++) {
      if (!places[k].on || places[k].column != places[i].column || places[k].row != places[i].row)
        continue;
      fg_point at = place_at(lattice, places[i].column, places[i].row);
      double own = hypot(places[i].at.x - at.x, places[i].at.y - at.y);
      double other = hypot(places[k].at.x - at.x, places[k].at.y - at.y);
      places[own <= other ? k : i].on = false;
    }
}

static void turn_indices(fg_lattice_place *places, size_t count, fg_lattice *lattice) {
  fg_point a = lattice->axis[0];
  lattice->axis[0] = (fg_point){-lattice->axis[1].x, -lattice->axis[1].y};
  lattice->axis[1] = a;
  for (size_t i = 0; i < count; i++) {
    int column = places[i].column;
    places[i].column = -places[i].row;
    places[i].row = column;
  }
}

static bool is_in_order(const fg_lattice *lattice) {
  fg_point a = lattice->axis[0];
  if (fabs(a.y) <= fabs(a.x)) return a.x > 0;
  return lattice->one_axis && a.y > 0;
}

/* Columns run along the direction nearest to x, rows a quarter turn on; both from 0. Columns of one
 * axis run along it. */
static void put_in_order(fg_lattice_place *places, size_t count, fg_lattice *lattice) {
  int low[2] = {0, 0};
  for (int turn = 0; turn < 4 && !is_in_order(lattice); turn++) {
    turn_indices(places, count, lattice);
    if (lattice->one_axis) turn_indices(places, count, lattice);
  }
  bool first = true;
  for (size_t i = 0; i < count; i++) {
    if (!places[i].on) continue;
    if (first || places[i].column < low[0]) low[0] = places[i].column;
    if (first || places[i].row < low[1]) low[1] = places[i].row;
    first = false;
  }
  lattice->origin = place_at(lattice, low[0], low[1]);
  for (size_t i = 0; i < count; i++) {
    places[i].column -= low[0];
    places[i].row -= low[1];
  }
}

static fg_status index_places(fg_context *ctx, fg_lattice_place *places, const place_index *index,
                              fg_lattice *lattice, size_t *on) {
  lattice_growth growth = {.index = index, .places = places, .lattice = lattice};
  size_t count = index->count, best = 0, max_known = 0;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *growth.queue, (void **)&growth.queue));
  for (int round = 0; round < ROUNDS; round++) { /* seeds over the picture */
    size_t seed = count * (size_t)round / ROUNDS;
    for (size_t i = 0; i < count; i++)
      places[i].on = false;
    growth.known = 0;
    if (!suits_direction(&places[seed], lattice->axis[0])) continue;
    grow_from(&growth, seed);
    if (growth.known > max_known) max_known = growth.known, best = seed;
  }
  for (size_t i = 0; i < count; i++)
    places[i].on = false;
  growth.known = 0;
  grow_from(&growth, best);
  free(growth.queue);
  *on = growth.known;
  for (int round = 0; round < 3; round++) {
    fg_lattice fitted = *lattice;
    if (fit_steps(places, count, lattice->one_axis, &fitted)) *lattice = fitted;
    *on = take_across_gaps(places, count, lattice);
  }
  drop_second_places(places, count, lattice);
  return FG_OK;
}

/* The second step: not along the first, and of its length. */
static bool choose_second(lattice_step *list, size_t count, fg_point first, fg_point *second) {
  size_t kept = 0;
  double length = hypot(first.x, first.y);
  for (size_t i = 0; i < count; i++) {
    fg_point s = list[i].step;
    double across = fabs(s.x * first.y - s.y * first.x) / (length * hypot(s.x, s.y));
    double ratio = hypot(s.x, s.y) / length;
    if (across < 0.9 || ratio < 0.9 || ratio > 1.1) continue;
    list[kept++] = list[i];
  }
  if (!choose_step(list, kept, second)) return false;
  if (first.x * second->y - first.y * second->x < 0) *second = (fg_point){-second->x, -second->y};
  return true;
}

static fg_status find_steps(fg_context *ctx, const place_index *index, bool one_axis,
                            fg_lattice *lattice) {
  lattice_step *list;
  FG_TRY(fg_memory_allocate(ctx, STEPS_MAX, sizeof *list, (void **)&list));
  size_t count = list_steps(index, list);
  bool found = choose_step(list, count, &lattice->axis[0]);
  lattice->one_axis = one_axis;
  if (one_axis)
    lattice->axis[1] = (fg_point){-lattice->axis[0].y, lattice->axis[0].x};
  else
    found = found && choose_second(list, count, lattice->axis[0], &lattice->axis[1]);
  free(list);
  return found ? FG_OK
               : fg_fail(ctx, FG_ERR_DATA, "%zu marks lie on no square lattice", index->count);
}

fg_status fg_lattice_find(fg_context *ctx, fg_lattice_place *places, size_t count, bool one_axis,
                          fg_lattice *lattice) {
  place_index index = {0};
  size_t on = 0;
  fg_status status = FG_OK;
  if (count < PLACES_MIN)
    return fg_fail(ctx, FG_ERR_DATA, "%zu marks are too few for a lattice; %d at least", count,
                   PLACES_MIN);
  FG_TRY_EXIT(build_index(ctx, places, count, &index));
  FG_TRY_EXIT(find_steps(ctx, &index, one_axis, lattice));
  for (size_t i = 0; i < count; i++)
    if (suits_direction(&places[i], lattice->axis[0])) lattice->origin = places[i].at;
  FG_TRY_EXIT(index_places(ctx, places, &index, lattice, &on));
  if (on < PLACES_MIN)
    status =
        fg_fail(ctx, FG_ERR_DATA, "only %zu of %zu marks lie on one square lattice", on, count);
  if (status == FG_OK) put_in_order(places, count, lattice);
exit:
  free_index(&index);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Row jumps of a picture across the beams of a foil.
 *
 * Every straight edge is a cubic along itself, and a jump of d at y0 adds d n_y [y > y0] to it,
 * with n its normal. Jumps are added one by one where they explain most over all edges together.
 * The part itself may have steps: a step of one edge alone, or steps of several that are not one
 * displacement of the rows. */
#include "geometry/beam_rows.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/spread.h"

enum { CUBIC = 4, COLUMNS = CUBIC + FG_BEAM_JUMPS_MAX, STATIONS_MIN = 40, REACH = 12 };
/* Min part of a normal along y: edges below show no jump. */
#define CROSSING_MIN 0.01
/* Min gain in squares, over the variance: one value explains 1 by chance, at the best of a thousand
 * rows 20. */
#define GAIN_MIN     40.0
#define JUMP_MIN_ROW 0.5
#define CUT_SIGMAS   6.0 /* residuals are clipped here: dust */
/* An edge is tested where the expected step is this many of its sd; the step may differ by this
 * share. */
#define TESTED_SIGMAS 4.0
#define STEP_SHARE    0.5
enum { AGREE_MIN = 2, AGREE_FACTOR = 3 };
/* Min distance of two jumps. The pixels of several rows determine an edge: nearer jumps are one. */
#define APART_ROWS 12.0

typedef struct row_place {
  double y, across, rest;
  double q[COLUMNS];
  double tail_residual, tails[COLUMNS]; /* sums from here on */
} row_place;

typedef struct row_edge {
  row_place *places; /* by y; owned */
  size_t count, columns;
  double normal_y, limit;
  double variance; /* of a place; for found jumps multiplied by the correlation of neighbours */
} row_edge;

typedef struct row_search {
  row_edge *edges;
  size_t count;
  double low, high, step; /* range and step of the tested rows */
  double *scratch;
  fg_beam_jumps *jumps;
} row_search;

/* Makes the last column orthogonal to those before it; one in their span is dropped. */
static void orthogonalise_edge(row_edge *e) {
  size_t k = e->columns;
  double before = 0, square = 0;
  for (size_t i = 0; i < e->count; i++)
    before += e->places[i].q[k] * e->places[i].q[k];
  for (size_t j = 0; j < k; j++) {
    double dot = 0;
    for (size_t i = 0; i < e->count; i++)
      dot += e->places[i].q[j] * e->places[i].q[k];
    for (size_t i = 0; i < e->count; i++)
      e->places[i].q[k] -= dot * e->places[i].q[j];
  }
  for (size_t i = 0; i < e->count; i++)
    square += e->places[i].q[k] * e->places[i].q[k];
  if (!(square > 1e-6 * before)) return;
  for (size_t i = 0; i < e->count; i++)
    e->places[i].q[k] /= sqrt(square);
  e->columns++;
}

static void find_residuals(row_edge *e) {
  for (size_t i = 0; i < e->count; i++)
    e->places[i].rest = e->places[i].across;
  for (size_t k = 0; k < e->columns; k++) {
    double dot = 0;
    for (size_t i = 0; i < e->count; i++)
      dot += e->places[i].q[k] * e->places[i].rest;
    for (size_t i = 0; i < e->count; i++)
      e->places[i].rest -= dot * e->places[i].q[k];
  }
}

static double clip_residual(const row_edge *e, double rest) {
  return fmax(-e->limit, fmin(e->limit, rest));
}

static void find_limit(row_edge *e, double *scratch) {
  for (size_t i = 0; i < e->count; i++)
    scratch[i] = fabs(e->places[i].rest);
  e->limit = CUT_SIGMAS * fg_robust_sd(scratch, e->count);
}

/* Fills the cubic and all jumps but one. */
static void fill_edge_columns(row_edge *e, const fg_beam_jumps *jumps, size_t without,
                              double *scratch) {
  e->columns = 0;
  double first = e->places[0].y, size = e->places[e->count - 1].y - first;
  for (int k = 0; k < CUBIC; k++) {
    for (size_t i = 0; i < e->count; i++)
      e->places[i].q[e->columns] = pow(2 * (e->places[i].y - first) / size - 1, k);
    orthogonalise_edge(e);
  }
  for (size_t k = 0; k < jumps->count; k++) {
    for (size_t i = 0; k != without && i < e->count; i++)
      e->places[i].q[e->columns] = e->places[i].y > jumps->y_mm[k];
    if (k != without) orthogonalise_edge(e);
  }
  find_residuals(e);
  find_limit(e, scratch);
  for (size_t i = e->count; i-- > 0;) {
    row_place *p = &e->places[i];
    bool last = i + 1 == e->count;
    p->tail_residual = clip_residual(e, p->rest) + (last ? 0 : p[1].tail_residual);
    for (size_t k = 0; k < e->columns; k++)
      p->tails[k] = p->q[k] + (last ? 0 : p[1].tails[k]);
  }
}

/* Finds the noise from second differences, to which jumps hardly add. */
static void find_noise(row_edge *e, double *scratch) {
  for (size_t i = 1; i + 1 < e->count; i++) {
    const row_place *p = &e->places[i];
    scratch[i - 1] = fabs(p->across - 0.5 * (p[-1].across + p[1].across));
  }
  double sd = fg_robust_sd(scratch, e->count - 2);
  e->variance = sd * sd / 1.5;
}

/* Finds the variance of a step: residuals of neighbours are alike, which raises it. */
static void find_variance(row_edge *e) {
  double squares = 0, products = 0;
  for (size_t i = 0; i < e->count; i++) {
    double here = clip_residual(e, e->places[i].rest);
    squares += here * here;
    for (size_t k = i + 1; k <= i + REACH && k < e->count; k++)
      products += here * clip_residual(e, e->places[k].rest);
  }
  e->variance = fmax(squares + 2 * products, squares) / (double)(e->count - e->columns);
}

/* Products of a step of the rows beyond a place with an edge's residuals, and with itself. */
static void test_edge(const row_edge *e, double y, double sums[2]) {
  size_t low = 0, high = e->count - 1;
  sums[0] = sums[1] = 0;
  if (!(y > e->places[0].y && y < e->places[e->count - 1].y) || !(e->variance > 0)) return;
  while (high - low > 1) {
    size_t mid = (low + high) / 2;
    *(e->places[mid].y > y ? &high : &low) = mid;
  }
  const row_place *p = &e->places[high];
  sums[1] = (double)(e->count - high);
  for (size_t k = 0; k < e->columns; k++)
    sums[1] -= p->tails[k] * p->tails[k];
  sums[0] = p->tail_residual * e->normal_y / e->variance;
  sums[1] = fmax(sums[1], 0) * e->normal_y * e->normal_y / e->variance;
}

static bool is_beside_another(const fg_beam_jumps *jumps, double y) {
  for (size_t k = 0; k < jumps->count; k++)
    if (fabs(jumps->y_mm[k] - y) < APART_ROWS * jumps->row_mm) return true;
  return false;
}

/* Returns true when the edges that would show a jump do; a part's own steps do not agree. */
static bool is_jump_shown(const row_search *s, double y, double size) {
  int agree = 0, differ = 0;
  for (size_t i = 0; i < s->count; i++) {
    double sums[2];
    test_edge(&s->edges[i], y, sums);
    double sigmas = fabs(size) * sqrt(sums[1]);
    if (sigmas < TESTED_SIGMAS) continue;
    if (fabs(sums[0] / sums[1] / size - 1) < STEP_SHARE + 2 / sigmas)
      agree++;
    else
      differ++;
  }
  return agree >= AGREE_MIN && agree >= AGREE_FACTOR * differ;
}

static void sum_edges(const row_search *s, double y, double sum[2]) {
  sum[0] = sum[1] = 0;
  for (size_t i = 0; i < s->count; i++) {
    double sums[2];
    test_edge(&s->edges[i], y, sums);
    sum[0] += sums[0];
    sum[1] += sums[1];
  }
}

/* Adds the jump that explains most beside the others; false when there is none. */
static bool add_jump(row_search *s) {
  double best = GAIN_MIN, at = NAN, size = 0;
  for (double y = s->low; y < s->high; y += s->step) {
    double sum[2];
    if (is_beside_another(s->jumps, y)) continue;
    sum_edges(s, y, sum);
    double gain = sum[1] > 0 ? sum[0] * sum[0] / sum[1] : 0;
    if (gain <= best || fabs(sum[0] / sum[1]) < JUMP_MIN_ROW * s->jumps->row_mm) continue;
    best = gain;
    at = y;
    size = sum[0] / sum[1];
  }
  if (isnan(at)) return false;
  s->jumps->y_mm[s->jumps->count] = at;
  s->jumps->size_mm[s->jumps->count++] = size;
  return true;
}

static void refresh_edges(row_search *s, size_t without) {
  for (size_t i = 0; i < s->count; i++)
    fill_edge_columns(&s->edges[i], s->jumps, without, s->scratch);
}

/* Drops the weakest jump that chance or the part's shape explains; false: all stay. */
static bool drop_weakest(row_search *s) {
  fg_beam_jumps *jumps = s->jumps;
  double min = INFINITY;
  size_t weakest = 0;
  refresh_edges(s, jumps->count);
  for (size_t i = 0; i < s->count; i++)
    find_variance(&s->edges[i]);
  for (size_t k = 0; k < jumps->count; k++) {
    double sum[2];
    refresh_edges(s, k);
    sum_edges(s, jumps->y_mm[k], sum);
    double size = sum[1] > 0 ? sum[0] / sum[1] : 0, gain = sum[0] * size;
    bool stays = gain > GAIN_MIN && fabs(size) > JUMP_MIN_ROW * jumps->row_mm &&
                 is_jump_shown(s, jumps->y_mm[k], size);
    jumps->size_mm[k] = size;
    if (stays || gain >= min) continue;
    min = gain;
    weakest = k;
  }
  if (isinf(min)) return false;
  jumps->count--;
  jumps->y_mm[weakest] = jumps->y_mm[jumps->count];
  jumps->size_mm[weakest] = jumps->size_mm[jumps->count];
  return true;
}

static void find_jumps(row_search *s) {
  refresh_edges(s, 0);
  for (size_t i = 0; i < s->count; i++)
    find_noise(&s->edges[i], s->scratch);
  while (s->jumps->count < FG_BEAM_JUMPS_MAX && add_jump(s))
    refresh_edges(s, s->jumps->count);
  while (s->jumps->count && drop_weakest(s))
    continue;
}

/* Adds one edge's stations in the order of y, as places across its chord. False when it shows
 * nothing. */
static fg_status add_edge(fg_context *ctx, const fg_beam_edge *from, row_search *s) {
  row_edge *e = &s->edges[s->count];
  if (from->round || from->count < STATIONS_MIN || !(from->row_mm > 0)) return FG_OK;
  fg_point a = from->stations[0].at, b = from->stations[from->count - 1].at;
  double size = hypot(b.x - a.x, b.y - a.y);
  if (b.y < a.y) size = -size;
  fg_point along = {(b.x - a.x) / size, (b.y - a.y) / size};
  if (fabs(along.x) < CROSSING_MIN || along.y < CROSSING_MIN) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, from->count, sizeof *e->places, (void **)&e->places));
  for (size_t i = 0; i < from->count; i++) {
    const fg_disc_point *p = &from->stations[size > 0 ? i : from->count - 1 - i];
    double across = (p->at.y - a.y) * along.x - (p->at.x - a.x) * along.y;
    double t = (p->at.x - a.x) * along.x + (p->at.y - a.y) * along.y;
    if (p->used) e->places[e->count++] = (row_place){.y = a.y + t * along.y, .across = across};
  }
  e->normal_y = along.x;
  s->count++;
  if (e->count < STATIONS_MIN) {
    free(e->places);
    *e = (row_edge){0};
    s->count--;
    return FG_OK;
  }
  s->low = fmin(s->low, e->places[0].y);
  s->high = fmax(s->high, e->places[e->count - 1].y);
  s->jumps->row_mm = from->row_mm;
  s->step = 0.5 * from->row_mm;
  return FG_OK;
}

fg_status fg_beam_jumps_find(fg_context *ctx, const fg_foil *foil, fg_beam_jumps *jumps) {
  row_search s = {.low = INFINITY, .high = -INFINITY, .jumps = jumps};
  size_t max = 1;
  fg_status status = FG_OK;
  *jumps = (fg_beam_jumps){.count = 0};
  FG_TRY(fg_memory_allocate(ctx, FG_BEAM_SIDES * foil->beam_count + 1, sizeof *s.edges,
                            (void **)&s.edges));
  for (size_t i = 0; i < foil->beam_count; i++)
    for (int side = 0; side < FG_BEAM_SIDES; side++) {
      const fg_beam_edge *edge = &foil->beams[i].edges[side];
      if (edge->count > max) max = edge->count;
      FG_TRY_EXIT(add_edge(ctx, edge, &s));
    }
  FG_TRY_EXIT(fg_memory_allocate(ctx, max, sizeof *s.scratch, (void **)&s.scratch));
  if (s.count >= AGREE_MIN) find_jumps(&s);
exit:
  for (size_t i = 0; i < s.count; i++)
    free(s.edges[i].places);
  free(s.edges);
  free(s.scratch);
  return status;
}

/* Widens a beam by the jumps across it. Rows that jump between root and tip change the length by
 * their component along the axis. A scanner that loses rows loses them all one way: sizes add up.
 * Jumps across the long edges turn and bend these. */
void fg_beam_jumps_widen(const fg_beam_jumps *jumps, fg_beam *beam) {
  double angle = beam->direction_deg * M_PI / 180, low = INFINITY, high = -INFINITY, sum = 0;
  if (isnan(beam->width_mm)) return;
  for (int i = 0; i < 4; i++) {
    low = fmin(low, beam->corners_mm[i].y);
    high = fmax(high, beam->corners_mm[i].y);
  }
  for (size_t k = 0; k < jumps->count; k++)
    if (jumps->y_mm[k] > low && jumps->y_mm[k] < high) sum += fabs(jumps->size_mm[k]);
  double along = sum * sin(angle), across = sum * cos(angle);
  double size = hypot(beam->tip_mm.x - beam->root_mm.x, beam->tip_mm.y - beam->root_mm.y);
  beam->u_length_mm = hypot(beam->u_length_mm, along);
  beam->u_width_mm = hypot(beam->u_width_mm, across);
  beam->u_taper_um_per_mm = hypot(beam->u_taper_um_per_mm, 1000 * 3 * across / size);
  beam->u_bow_um = hypot(beam->u_bow_um, 1000 * across);
}

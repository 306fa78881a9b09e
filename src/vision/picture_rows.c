/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Jumps of rows of a picture: both edges of a strip jump at one row, wherever they cross it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/small_solve.h"
#include "core/spread.h"
#include "vision/picture.h"

/* Means over two stretches of stations on either side of a place: a step there, and a straight line
 * along it. */
enum { STRETCHES = 2, PEAK = 5, ENDS = 24 };
static const int stretches[STRETCHES][2] = {{1, 3}, {4, 7}};
/* BENDS: terms of a cubic that models the bend at a step; FIT_REACH: stations that it covers. */
enum { BENDS = 4, FIT_REACH = 12, SHIFT_MAX = 5 };
/* Min angle of crossing: an edge along the rows has no definite place of crossing. */
#define CROSSING_MIN 0.2
/* A fillet bends both edges at one station, a jump moves them at one row: the two can be told apart
 * where these lie so many rows apart. An edge that runs across the rows shows no jump. */
#define FIT_SIGMAS    5.0
#define DISTINCT_ROWS 3.5
#define STEP_SIGMAS   4.0
#define JUMP_MIN_PX   0.5
/* Max differences in row and size, between both edges and between places of one jump. */
#define SAME_ROWS      2.0
#define APART_STATIONS 2.0
#define BESIDE_WIDTHS  6.0
/* Max deviation from whole rows: a driver loses or doubles whole rows, and an edge may run along
 * them and show a little less. */
#define WHOLE_SHARE 0.25
#define SAME_SHARE  0.15
#define SAME_PX     0.2

/* Number of pixels in which a row must equal the next; with noise of less than NOISE_MIN counts it
 * could. Where more than a tenth of the rows are doubled the driver has enlarged the picture. */
enum { DOUBLED_PIXELS = 128 };
#define NOISE_MIN     0.4
#define DOUBLED_SHARE 0.1

typedef struct crossing {
  double y, jump_px;
  size_t station;
  int side;
} crossing;

typedef struct row_search {
  const fg_edge_work *work;
  double weights[STRETCHES];
  fg_point *sums; /* of the edge's points before a station, count + 1 */
  double *steps;  /* at each station; NaN: not known */
  double *scratch;
  crossing *crossings;
  size_t crossing_count, capacity;
} row_search;

/* Weights of the stretches on both sides: a step counts in full, a line vanishes. */
static void find_weights(double weights[STRETCHES]) {
  double middle[STRETCHES];
  for (int k = 0; k < STRETCHES; k++)
    middle[k] = 0.5 * (stretches[k][0] + stretches[k][1]);
  weights[0] = middle[1] / (middle[1] - middle[0]);
  weights[1] = 1 - weights[0];
}

/* Place of the edge at a station. */
static fg_point edge_at(const row_search *r, size_t i, int side) {
  const fg_reference_station *at = &r->work->reference->stations[i];
  double across = (double)r->work->stations[i].edge_px[side];
  return (fg_point){at->x - across * at->ty, at->y + across * at->tx};
}

/* The step at one station along its normal, from the edge's own points. */
static double step_at(const row_search *r, size_t i) {
  const fg_reference_station *at = &r->work->reference->stations[i];
  double step = 0;
  for (int k = 0; k < STRETCHES; k++) {
    size_t from = (size_t)stretches[k][0], to = (size_t)stretches[k][1];
    double dx =
        r->sums[i + to + 1].x - r->sums[i + from].x - r->sums[i - from + 1].x + r->sums[i - to].x;
    double dy =
        r->sums[i + to + 1].y - r->sums[i + from].y - r->sums[i - from + 1].y + r->sums[i - to].y;
    step += r->weights[k] * (dy * at->tx - dx * at->ty) / (double)(to - from + 1);
  }
  return step;
}

/* The step at every station of one side. */
static void find_steps(row_search *r, int side) {
  size_t count = r->work->reference->count;
  r->sums[0] = (fg_point){0, 0};
  for (size_t i = 0; i < count; i++) {
    fg_point at = edge_at(r, i, side);
    r->sums[i + 1] = (fg_point){r->sums[i].x + at.x, r->sums[i].y + at.y};
    r->steps[i] = NAN;
  }
  for (size_t i = ENDS; i + ENDS < count; i++)
    r->steps[i] = step_at(r, i);
}

static double steps_sd(row_search *r) {
  size_t n = 0;
  for (size_t i = 0; i < r->work->reference->count; i++)
    if (!isnan(r->steps[i])) r->scratch[n++] = fabs(r->steps[i]);
  return n ? fg_robust_sd(r->scratch, n) : NAN;
}

/* A step before station c + 1 beside a bend, a cubic along the strip, from stations around it. */
typedef struct step_fit {
  size_t at;
  double step, sd, misfit;
} step_fit;

static step_fit fit_step(const row_search *r, size_t c, int side, size_t normal) {
  const fg_reference_station *at = &r->work->reference->stations[normal];
  fg_point here = edge_at(r, normal, side);
  double x[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX], squares;
  fg_normal_equations system;
  size_t n = 0;
  fg_normal_clear(&system, BENDS + 1);
  for (size_t k = c - FIT_REACH + 1; k <= c + FIT_REACH; k++) {
    if (k == c || k == c + 1) continue; /* their pixels come from both sides */
    fg_point p = edge_at(r, k, side);
    double s = ((double)k - (double)c - 0.5) / FIT_REACH;
    const double row[BENDS + 1] = {1, s, s * s, s * s * s, k > c};
    fg_normal_add(&system, row, (p.y - here.y) * at->tx - (p.x - here.x) * at->ty, 1);
    n++;
  }
  if (!fg_normal_solve(&system, 0, x, inverse)) return (step_fit){.misfit = INFINITY};
  squares = system.sum_squares;
  for (int k = 0; k <= BENDS; k++)
    squares -= x[k] * system.right[k];
  double variance = fmax(squares, 0) / (double)(n - BENDS - 1);
  return (step_fit){c, x[BENDS], sqrt(variance * inverse[BENDS][BENDS]), squares};
}

/* Finds the step that best explains the edge around a peak. */
static step_fit find_step(const row_search *r, size_t i, int side) {
  step_fit best = {.misfit = INFINITY};
  for (size_t c = i - SHIFT_MAX; c <= i + SHIFT_MAX; c++) {
    step_fit fit = fit_step(r, c, side, i);
    if (fit.misfit < best.misfit) best = fit;
  }
  return best;
}

static bool is_peak(const row_search *r, size_t i) {
  double here = fabs(r->steps[i]);
  for (size_t k = i > PEAK ? i - PEAK : 0; k <= i + PEAK && k < r->work->reference->count; k++)
    if (fabs(r->steps[k]) > here) return false;
  return true;
}

/* Finds peaks of one side that are more than chance, as jumps of rows. */
static fg_status find_crossings(fg_context *ctx, row_search *r, int side) {
  find_steps(r, side);
  double sd = steps_sd(r);
  for (size_t i = 0; i < r->work->reference->count; i++) {
    const fg_reference_station *at = &r->work->reference->stations[i];
    if (!(fabs(r->steps[i]) > STEP_SIGMAS * sd) || fabs(at->ty) < CROSSING_MIN ||
        fabs(at->tx) * r->work->width_px < DISTINCT_ROWS || !is_peak(r, i))
      continue;
    step_fit fit = find_step(r, i, side);
    double jump = fit.step * (at->ty > 0 ? 1 : -1) / at->tx;
    if (!(fabs(jump) > JUMP_MIN_PX && fabs(fit.step) > FIT_SIGMAS * fit.sd)) continue;
    double y = 0.5 * (edge_at(r, fit.at, side).y + edge_at(r, fit.at + 1, side).y);
    FG_TRY(fg_memory_reserve(ctx, r->crossing_count + 1, sizeof *r->crossings, &r->capacity,
                             (void **)&r->crossings));
    r->crossings[r->crossing_count++] =
        (crossing){.y = y, .jump_px = jump, .station = fit.at, .side = side};
  }
  return FG_OK;
}

static bool is_same_jump(const crossing *a, const crossing *b) {
  return fabs(a->y - b->y) <= SAME_ROWS &&
         fabs(a->jump_px - b->jump_px) <= SAME_PX + SAME_SHARE * fabs(a->jump_px);
}

/* Returns true when the strip's edges show the jump of one crossing: both beside it, at one row and
 * so at different stations; and another place as well, unless it is a whole row. */
static bool is_crossing_shown(const row_search *r, const crossing *a) {
  double beside = BESIDE_WIDTHS * r->work->width_px / r->work->reference->step_px;
  bool paired = false, elsewhere = false;
  for (size_t k = 0; k < r->crossing_count; k++) {
    const crossing *b = &r->crossings[k];
    double off = fabs((double)b->station - (double)a->station);
    if (!is_same_jump(a, b)) continue;
    paired |= b->side != a->side && off >= APART_STATIONS && off < beside;
    elsewhere |= off >= beside;
  }
  double whole = fmax(1, round(fabs(a->jump_px)));
  return paired && (elsewhere || fabs(fabs(a->jump_px) - whole) < WHOLE_SHARE * whole);
}

static int compare_rows(const void *a, const void *b) {
  double p = ((const crossing *)a)->y, q = ((const crossing *)b)->y;
  return (p > q) - (p < q);
}

static void count_jumps(row_search *r, fg_picture_state *state) {
  double last = -INFINITY;
  fg_sort_items(r->crossings, r->crossing_count, sizeof *r->crossings, compare_rows);
  state->row_jumps = 0;
  state->row_jump_px = 0;
  for (size_t i = 0; i < r->crossing_count; i++) {
    const crossing *c = &r->crossings[i];
    if (!is_crossing_shown(r, c)) continue;
    if (c->y - last > 2 * SAME_ROWS) state->row_jumps++;
    last = c->y;
    if (fabs(c->jump_px) > fabs(state->row_jump_px)) state->row_jump_px = c->jump_px;
  }
  if (state->row_jumps > 0) state->findings |= FG_PICTURE_ROW_JUMPS;
}

/* Pixels of a row that were held against those below, and how many differ from the one before. */
typedef struct row_match {
  size_t pixels, changes;
  bool same;
} row_match;

/* Holds a row of a tile against the next one, by blocks that both know. */
static void match_tile(const fg_tiles *tiles, int32_t column, int64_t y, row_match *match) {
  const fg_tile *tile = fg_tiles_at(tiles, column, (int32_t)(y / FG_TILE_PX));
  const fg_tile *next = fg_tiles_at(tiles, column, (int32_t)((y + 1) / FG_TILE_PX));
  if (!tile || !next) return;
  size_t bytes = (size_t)tiles->bytes_per_pixel, length = FG_BLOCK_PX * bytes;
  size_t above = (size_t)(y % FG_TILE_PX), below = (size_t)((y + 1) % FG_TILE_PX);
  for (size_t b = 0; b < FG_BLOCKS_PER_TILE && match->same; b++) {
    if (isnan(tile->blocks[above / FG_BLOCK_PX * FG_BLOCKS_PER_TILE + b]) ||
        isnan(next->blocks[below / FG_BLOCK_PX * FG_BLOCKS_PER_TILE + b]))
      continue;
    const uint8_t *row = tile->pixels + (above * FG_TILE_PX + b * FG_BLOCK_PX) * bytes;
    match->same =
        !memcmp(row, next->pixels + (below * FG_TILE_PX + b * FG_BLOCK_PX) * bytes, length);
    match->pixels += FG_BLOCK_PX;
    for (size_t i = 1; i < FG_BLOCK_PX; i++)
      match->changes += memcmp(row + i * bytes, row + (i - 1) * bytes, bytes) != 0;
  }
}

/* Number of rows that equal the next one wherever they are kept, which noise never makes. */
static double count_doubled(const fg_tiles *tiles, double *rows) {
  double doubled = 0;
  *rows = 0;
  for (int64_t y = 0; y + 1 < tiles->height_px; y++) {
    row_match match = {.same = true};
    for (int32_t c = 0; (int64_t)(c + 1) * FG_TILE_PX <= tiles->width_px && match.same; c++)
      match_tile(tiles, c, y, &match);
    *rows += match.pixels > 0;
    doubled += match.same && match.pixels >= DOUBLED_PIXELS && 4 * match.changes > match.pixels;
  }
  return doubled;
}

static void inspect_doubled(const fg_tiles *tiles, fg_picture_state *state) {
  double rows, doubled = count_doubled(tiles, &rows);
  if (!(state->noise > NOISE_MIN) || doubled < 1) return;
  if (doubled > DOUBLED_SHARE * rows) {
    state->findings |= FG_PICTURE_CORRELATED_NOISE;
    return;
  }
  state->row_jumps = fmax(state->row_jumps, doubled);
  if (!(fabs(state->row_jump_px) > 1)) state->row_jump_px = 1;
  state->findings |= FG_PICTURE_ROW_JUMPS;
}

fg_status fg_picture_inspect_rows(fg_context *ctx, const fg_edge_work *work,
                                  fg_picture_state *state) {
  size_t count = work->reference->count;
  row_search r = {.work = work};
  double *memory = NULL;
  fg_status status = FG_OK;
  if (count <= 2 * ENDS) return FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, 4 * count + 2, sizeof *memory, (void **)&memory));
  r.steps = memory;
  r.scratch = memory + count;
  r.sums = (fg_point *)(memory + 2 * count);
  find_weights(r.weights);
  for (int side = 0; side < 2; side++)
    FG_TRY_EXIT(find_crossings(ctx, &r, side));
  count_jumps(&r, state);
  inspect_doubled(work->tiles, state);
exit:
  free(memory);
  free(r.crossings);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Jumps of rows beside a round edge.
 *
 * Beyond a jump all of the edge is displaced by (dx, dy): rho = base + [y > y0] (dx cos phi + dy
 * sin phi), rho outwards from the circle. Both limbs step at one row, as one displacement demands.
 * That also holds where the limbs run along y and rho does not step but bends.
 *
 * Jumps are added one by one where they explain most. Three things show that a part is not round
 * instead: harmonics explain it better, one limb shows nothing, or the limbs do not step there. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/small_solve.h"
#include "core/spread.h"
#include "vision/picture.h"

/* Size of the base: a circle under different scales of x and y, or a blur of one side. Its rival
 * has at least as many values as all jumps. */
enum { BASE = 7, RIVAL = 27, JUMPS_MAX = 6, STATIONS_MIN = 120, ENDS = 24 };
/* BENDS: terms of a cubic that models the bend beside a step; FIT_REACH: stations of one limb that
 * it covers. */
enum { BENDS = 4, FIT_REACH = 12, LIMBS = 2 };
#define GAIN_MIN    40.0 /* of squares, over the variance: two values explain 2 by chance */
#define JUMP_MIN_PX 0.5
#define LIMB_SHARE  0.2 /* min step of the weaker limb, as a share of the other's */
#define STEP_SIGMAS 4.0 /* min expected step of a limb that is tested */
#define STEP_SHARE  0.5 /* max difference of the step from the expected one */
#define RIVAL_SHARE 1.1
#define CUT_SIGMAS  4.0 /* residuals are clipped here: dust */
#define ROW_STEP_PX 1.0
/* Min distance of two jumps. The pixels of several rows determine an edge, so one jump looks like
 * two of one limb each that lie a few rows apart; of two real ones so near to each other the sum is
 * found. */
#define APART_PX 12.0

typedef struct ring_row {
  double y, cosine, sine, rho, rest;
  size_t turn; /* its place around the circle */
  double q[RIVAL];
} ring_row;

typedef struct row_jump {
  size_t from; /* the first station beyond it, by y */
  double dx, dy, gain;
} row_jump;

typedef struct ring_search {
  ring_row *rows; /* by y */
  size_t count, columns;
  double *scratch; /* one per row */
  double noise;    /* sd of one station, from neighbours */
  double sd;       /* of the residuals, not less than the noise */
  row_jump jumps[JUMPS_MAX];
  size_t jump_count;
} ring_search;

static int compare_y(const void *a, const void *b) {
  double p = ((const ring_row *)a)->y, q = ((const ring_row *)b)->y;
  return (p > q) - (p < q);
}

/* `swapped`: x in the place of y, so that a jump is a seam of the columns. */
static void list_stations(const fg_disc_work *work, const fg_disc_edge *edge, bool swapped,
                          ring_search *s) {
  const fg_circle *circle = &edge->circle;
  for (size_t i = 0; i < edge->count; i++) {
    const fg_disc_station *station = &edge->stations[i];
    double angle = fg_ring_angle(&work->ring, i), rho = (double)station->edge_px;
    double x = cos(angle), y = sin(angle), sine = swapped ? x : y;
    if (!(station->weight > 0) || !isfinite(rho)) continue;
    s->rows[s->count++] =
        (ring_row){.y = (swapped ? circle->x : circle->y) + (circle->radius + rho) * sine,
                   .cosine = swapped ? y : x,
                   .sine = sine,
                   .rho = rho,
                   .turn = i};
  }
}

/* Returns the noise from the second differences of neighbours around the turn, to which an edge
 * that is not round or jumps at a few places hardly adds. */
static double find_noise(ring_search *s) {
  size_t n = 0;
  for (size_t i = 1; i + 1 < s->count; i++) {
    const ring_row *r = &s->rows[i];
    if (r[1].turn != r->turn + 1 || r[-1].turn + 1 != r->turn) continue;
    s->scratch[n++] = fabs(r->rho - 0.5 * (r[-1].rho + r[1].rho));
  }
  return n ? fmax(fg_robust_sd(s->scratch, n) / sqrt(1.5), 1e-3) : NAN;
}

/* Makes the last column orthogonal to those before it, and subtracts it from the residuals; a
 * column in their span is dropped. */
static void orthogonalise_column(ring_search *s) {
  size_t k = s->columns;
  double square = 0, share = 0, before = 0;
  for (size_t i = 0; i < s->count; i++)
    before += s->rows[i].q[k] * s->rows[i].q[k];
  for (size_t j = 0; j < k; j++) {
    double dot = 0;
    for (size_t i = 0; i < s->count; i++)
      dot += s->rows[i].q[j] * s->rows[i].q[k];
    for (size_t i = 0; i < s->count; i++)
      s->rows[i].q[k] -= dot * s->rows[i].q[j];
  }
  for (size_t i = 0; i < s->count; i++)
    square += s->rows[i].q[k] * s->rows[i].q[k];
  if (!(square > 1e-9 * before)) return;
  for (size_t i = 0; i < s->count; i++) {
    s->rows[i].q[k] /= sqrt(square);
    share += s->rows[i].q[k] * s->rows[i].rest;
  }
  for (size_t i = 0; i < s->count; i++)
    s->rows[i].rest -= share * s->rows[i].q[k];
  s->columns++;
}

static void add_harmonics(ring_search *s, size_t values) {
  s->columns = 0;
  for (size_t i = 0; i < s->count; i++)
    s->rows[i].rest = s->rows[i].rho;
  for (size_t k = 0; k < values; k++) {
    double order = (double)((k + 1) / 2);
    for (size_t i = 0; i < s->count; i++) {
      double angle = order * atan2(s->rows[i].sine, s->rows[i].cosine);
      s->rows[i].q[s->columns] = k % 2 ? cos(angle) : sin(angle + M_PI_2 * (k == 0));
    }
    orthogonalise_column(s);
  }
}

static void add_jump(ring_search *s, const row_jump *jump) {
  for (int k = 0; k < 2; k++) {
    for (size_t i = 0; i < s->count; i++)
      s->rows[i].q[s->columns] = i < jump->from ? 0 : (k ? s->rows[i].sine : s->rows[i].cosine);
    orthogonalise_column(s);
  }
}

/* Sums over the stations beyond a row: products of a jump there with the columns, with itself and
 * with the residuals. */
typedef struct jump_sums {
  double columns[2][RIVAL], own[3], rest[2];
} jump_sums;

static void add_station(const ring_search *s, const ring_row *r, jump_sums *sums) {
  for (size_t k = 0; k < s->columns; k++) {
    sums->columns[0][k] += r->cosine * r->q[k];
    sums->columns[1][k] += r->sine * r->q[k];
  }
  sums->own[0] += r->cosine * r->cosine;
  sums->own[1] += r->cosine * r->sine;
  sums->own[2] += r->sine * r->sine;
  sums->rest[0] += r->cosine * r->rest;
  sums->rest[1] += r->sine * r->rest;
}

static row_jump solve_jump(const ring_search *s, const jump_sums *sums, size_t from) {
  double m[3] = {sums->own[0], sums->own[1], sums->own[2]};
  for (size_t k = 0; k < s->columns; k++) {
    m[0] -= sums->columns[0][k] * sums->columns[0][k];
    m[1] -= sums->columns[0][k] * sums->columns[1][k];
    m[2] -= sums->columns[1][k] * sums->columns[1][k];
  }
  double determinant = m[0] * m[2] - m[1] * m[1];
  if (!(m[0] > 0 && m[2] > 0 && determinant > 1e-6 * m[0] * m[2])) return (row_jump){.gain = 0};
  row_jump jump = {.from = from,
                   .dx = (m[2] * sums->rest[0] - m[1] * sums->rest[1]) / determinant,
                   .dy = (m[0] * sums->rest[1] - m[1] * sums->rest[0]) / determinant};
  jump.gain = jump.dx * sums->rest[0] + jump.dy * sums->rest[1];
  return jump;
}

static bool is_beside_another(const ring_search *s, double y, size_t without) {
  for (size_t k = 0; k < s->jump_count; k++)
    if (k != without && fabs(s->rows[s->jumps[k].from].y - y) < APART_PX) return true;
  return false;
}

/* The jump that explains most of the residuals, away from the others. */
static row_jump find_jump(const ring_search *s, size_t without) {
  jump_sums sums = {.own = {0}};
  row_jump best = {.gain = 0};
  double last = INFINITY;
  for (size_t i = s->count; i-- > ENDS;) {
    const ring_row *r = &s->rows[i];
    add_station(s, r, &sums);
    if (i + ENDS > s->count || last - r->y < ROW_STEP_PX || is_beside_another(s, r->y, without))
      continue;
    row_jump jump = solve_jump(s, &sums, i);
    last = r->y;
    if (jump.gain > best.gain) best = jump;
  }
  return best;
}

/* The base and all jumps but one. */
static void fit_without(ring_search *s, size_t without) {
  add_harmonics(s, BASE);
  for (size_t k = 0; k < s->jump_count; k++)
    if (k != without) add_jump(s, &s->jumps[k]);
}

/* Adds jumps while they explain more than chance. */
static void find_jumps(ring_search *s) {
  add_harmonics(s, BASE);
  while (s->jump_count < JUMPS_MAX) {
    row_jump jump = find_jump(s, s->jump_count);
    if (!(jump.gain > GAIN_MIN * s->noise * s->noise)) break;
    s->jumps[s->jump_count++] = jump;
    add_jump(s, &jump);
  }
}

static double robust_sd_of_residuals(ring_search *s) {
  for (size_t i = 0; i < s->count; i++)
    s->scratch[i] = fabs(s->rows[i].rest);
  return fg_robust_sd(s->scratch, s->count);
}

/* Mean square of the residuals, clipped against dust. */
static double variance_of(const ring_search *s) {
  double sum = 0, limit = CUT_SIGMAS * s->sd;
  for (size_t i = 0; i < s->count; i++)
    sum += fmin(s->rows[i].rest * s->rows[i].rest, limit * limit);
  return sum / (double)(s->count - s->columns);
}

/* Factor of the variance of a mean of neighbours: on a rough edge they are alike. */
static double correlation_of(const ring_search *s) {
  double limit = CUT_SIGMAS * s->sd, squares = 0, products = 0;
  for (size_t i = 0; i + 1 < s->count; i++) {
    double here = fmax(-limit, fmin(limit, s->rows[i].rest));
    squares += here * here;
    for (size_t k = i + 1; k <= i + FIT_REACH && k < s->count; k++)
      if (s->rows[k].cosine * s->rows[i].cosine > 0)
        products += here * fmax(-limit, fmin(limit, s->rows[k].rest));
  }
  return squares > 0 ? fmax(1, 1 + 2 * products / squares) : 1;
}

/* Step of one limb under a jump: the right one, cos phi > 0, or the left one. */
static double step_of(const ring_search *s, const row_jump *jump, int limb) {
  const ring_row *at = &s->rows[jump->from];
  return jump->dx * (limb ? -1 : 1) * fabs(at->cosine) + jump->dy * at->sine;
}

/* Fits the step of one limb beside a cubic, to stations about the row: its ratio to the expected
 * one, and 1 / sd² of that ratio. */
static bool fit_limb(const ring_search *s, const row_jump *jump, int limb, double ratio[2]) {
  double x[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX], expected = step_of(s, jump, limb);
  fg_normal_equations system;
  fg_normal_clear(&system, BENDS + 1);
  for (int way = -1; way <= 1; way += 2) {
    int seen = 0;
    for (size_t i = way > 0 ? jump->from : jump->from - 1; i < s->count && seen <= FIT_REACH;
         i += (size_t)way) {
      const ring_row *r = &s->rows[i];
      if ((r->cosine < 0) != (limb == 1)) continue;
      if (seen++ == 0) continue; /* its pixels come from both sides */
      double t = way * (seen - 0.5) / FIT_REACH;
      const double row[BENDS + 1] = {1, t, t * t, t * t * t, way > 0};
      fg_normal_add(&system, row, r->rho, 1);
    }
    if (seen <= FIT_REACH) return false;
  }
  if (!fg_normal_solve(&system, 0, x, inverse)) return false;
  ratio[0] = x[BENDS] / expected;
  ratio[1] = expected * expected / (s->sd * s->sd * inverse[BENDS][BENDS]);
  return true;
}

/* Returns true when both limbs step as the jump demands, where a step would show. */
static bool is_jump_on_limbs(const ring_search *s, const row_jump *jump) {
  double sizes[LIMBS];
  for (int limb = 0; limb < LIMBS; limb++) {
    double ratio[2];
    sizes[limb] = fabs(step_of(s, jump, limb));
    if (!fit_limb(s, jump, limb, ratio) || ratio[1] < STEP_SIGMAS * STEP_SIGMAS) continue;
    if (fabs(ratio[0] - 1) > STEP_SHARE + 2 / sqrt(ratio[1])) return false;
  }
  return fmin(sizes[0], sizes[1]) >= LIMB_SHARE * fmax(sizes[0], sizes[1]);
}

static void find_again(ring_search *s) {
  for (size_t k = 0; k < s->jump_count; k++) {
    fit_without(s, k);
    s->jumps[k] = find_jump(s, k);
  }
}

/* Fits the base and all jumps. Returns the min squares that each must explain beside the others. */
static double find_gain_min(ring_search *s) {
  fit_without(s, s->jump_count);
  s->sd = fmax(robust_sd_of_residuals(s), s->noise);
  return GAIN_MIN * variance_of(s) * correlation_of(s);
}

/* Drops the jump that explains least, where that is chance or too small. */
static bool drop_weakest(ring_search *s) {
  double min = find_gain_min(s);
  size_t weakest = 0;
  for (size_t k = 1; k < s->jump_count; k++)
    if (s->jumps[k].gain < s->jumps[weakest].gain) weakest = k;
  const row_jump *jump = &s->jumps[weakest];
  if (jump->gain > min && hypot(jump->dx, jump->dy) > JUMP_MIN_PX) return false;
  s->jumps[weakest] = s->jumps[--s->jump_count];
  return true;
}

/* Variance that the base and the jumps leave. */
static double find_rest(ring_search *s) {
  find_gain_min(s);
  return variance_of(s);
}

/* Returns true when jumps, which leave `rest`, and not deviations of the part from roundness
 * explain the edge. */
static bool is_explained(ring_search *s, double rest) {
  add_harmonics(s, RIVAL);
  return rest < RIVAL_SHARE * variance_of(s);
}

static void count_jumps(const ring_search *s, double px_per_row, fg_picture_state *state) {
  double jumps = 0, largest = 0;
  for (size_t k = 0; k < s->jump_count; k++) {
    const row_jump *jump = &s->jumps[k];
    if (!is_jump_on_limbs(s, jump)) continue;
    double px = fabs(jump->dy) >= fabs(jump->dx) ? jump->dy / px_per_row : jump->dx * px_per_row;
    if (fabs(px) > fabs(largest)) largest = px;
    jumps++;
  }
  if (jumps == 0) return;
  state->row_jumps = jumps;
  state->row_jump_px = largest;
  state->findings |= FG_PICTURE_ROW_JUMPS;
}

/* Around the turn a station's neighbours are its own limb's; by y they are the other limb's. */
static fg_status search_jumps(fg_context *ctx, const fg_disc_work *work, const fg_disc_edge *edge,
                              bool swapped, ring_search *s) {
  *s = (ring_search){.count = 0};
  FG_TRY(fg_memory_allocate(ctx, edge->count, sizeof *s->rows, (void **)&s->rows));
  FG_TRY(fg_memory_allocate(ctx, edge->count, sizeof *s->scratch, (void **)&s->scratch));
  list_stations(work, edge, swapped, s);
  if (s->count < STATIONS_MIN || 4 * s->count <= 3 * edge->count) return FG_OK;
  s->noise = find_noise(s);
  fg_sort_items(s->rows, s->count, sizeof *s->rows, compare_y);
  find_jumps(s);
  find_again(s);
  while (s->jump_count && drop_weakest(s))
    find_again(s);
  return FG_OK;
}

static void close_search(ring_search *s) {
  free(s->rows);
  free(s->scratch);
}

/* Returns true where jumps from column to column, as of a sensor's chips, explain the edge better
 * than those from row to row. */
static fg_status find_seams(fg_context *ctx, const fg_disc_work *work, const fg_disc_edge *edge,
                            double rest, bool *seams) {
  ring_search s;
  fg_status status = search_jumps(ctx, work, edge, true, &s);
  *seams = status == FG_OK && s.jump_count && find_rest(&s) < rest;
  close_search(&s);
  return status;
}

fg_status fg_picture_inspect_ring_rows(fg_context *ctx, const fg_disc_work *work,
                                       const fg_disc_edge *edge, fg_picture_state *state) {
  ring_search s;
  bool seams = false;
  fg_status status = FG_OK;
  FG_TRY_EXIT(search_jumps(ctx, work, edge, false, &s));
  double rest = s.jump_count ? find_rest(&s) : NAN;
  if (!s.jump_count || !is_explained(&s, rest)) goto exit;
  FG_TRY_EXIT(find_seams(ctx, work, edge, rest, &seams));
  if (!seams) count_jumps(&s, work->shape->scale[1], state);
exit:
  close_search(&s);
  return status;
}

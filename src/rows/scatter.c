/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Noise of the rows by restricted likelihood, beside polynomials along every arc. */
#include "rows/scatter.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "core/select.h"

/* Bounds of the range: the scatter of edges is correlated over 0.02 to 0.1 mm of arc on real
 * flatbeds (reports/real); a margin on either side keeps estimates off the bound. */
#define RANGE_MIN_MM 0.01
#define RANGE_MAX_MM 0.12
#define SHARE_MAX    0.8
/* Rows are independent unless a correlation is likelier by this: chi² of two numbers, 1 in 20. */
#define GAIN_MIN 6.0
/* Polynomials along an arc: one per this length, which leaves shorter waves; their number; minimum
 * number of rows for each. */
#define POLYNOMIAL_MM 0.45
enum { POLYNOMIALS_MIN = 6, POLYNOMIALS_MAX = 16, ROWS_EACH = 4 };
/* Band of wave lengths, mm, that tests the model of the correlation: longer than the model is
 * fitted to, and shorter than effects. A wave of noise may exceed the model by SWELL_MAX. */
#define WAVE_SHORT_MM 0.4
#define WAVE_LONG_MM  0.75
#define SWELL_MAX     2.5
/* Dof of such a wave, shorter waves included: on 200 clean renders the noise of long waves scatters
 * by a tenth (reports/loop_rough.md, p-values). */
#define DOF_PER_WAVE 2.0
/* Arcs whose square exceeds the median one by this many standard errors have another deviation: a
 * step, dirt. At most this share of the arcs. */
#define ARC_SIGMAS 5.0
#define ARCS_MAX   0.25
/* Steps of the climb: of the range and of the share's odds; halved so often. */
#define STEP_START 1.5
enum { HALVINGS = 4, CLIMBS = 40 };

typedef struct arc {
  size_t from, to, rows, polynomials;
  bool out; /* has a deviation of its own */
  double square, dof;
} arc;

typedef struct search {
  fg_context *ctx;
  fg_edge_fit *edge_fit;
  const double *weighted; /* residual */
  double *polynomials;    /* POLYNOMIALS_MAX × rows, weighted */
  double *left, *columns; /* the same, whitened */
  arc *arcs;
  size_t arc_count;
  double shared; /* number of parameters that the shape common to all bumps uses, beyond the arcs'
                    own */
} search;

static fg_status list_arcs(search *s) {
  const fg_edge_fit *edge_fit = s->edge_fit;
  FG_TRY(fg_memory_allocate(s->ctx, edge_fit->row_count, sizeof *s->arcs, (void **)&s->arcs));
  for (size_t from = 0, to; from < edge_fit->row_count; from = to) {
    arc *a = &s->arcs[s->arc_count];
    *a = (arc){.from = from};
    to = a->to = fg_edge_fit_arc_end(edge_fit, from);
    for (size_t i = from; i < to; i++)
      a->rows += edge_fit->rows[i].weight > 0;
    double length = fabs(edge_fit->rows[to - 1].s_mm - edge_fit->rows[from].s_mm) / POLYNOMIAL_MM;
    a->polynomials = (size_t)fmax(POLYNOMIALS_MIN, fmin(POLYNOMIALS_MAX, round(length)));
    if (a->rows >= ROWS_EACH * a->polynomials) s->arc_count++;
  }
  return FG_OK;
}

/* Chebyshev's along each arc. */
static void fill_polynomials(search *s) {
  size_t rows = s->edge_fit->row_count;
  for (size_t k = 0; k < s->arc_count; k++) {
    const arc *a = &s->arcs[k];
    double low = s->edge_fit->rows[a->from].s_mm, high = s->edge_fit->rows[a->to - 1].s_mm;
    for (size_t i = a->from; i < a->to; i++) {
      const fg_edge_fit_row *row = &s->edge_fit->rows[i];
      double x = acos(fmax(-1, fmin(1, 2 * (row->s_mm - low) / (high - low) - 1)));
      double weight = fg_edge_fit_root_weight(row);
      for (size_t p = 0; p < a->polynomials; p++)
        s->polynomials[p * rows + i] = weight * cos((double)p * x);
    }
  }
}

/* Projects one arc beside its polynomials; returns ln of the determinant of their products. */
static double project_arc(search *s, arc *a) {
  size_t rows = s->edge_fit->row_count, n = a->to - a->from;
  double determinant = 0, *left = s->left + a->from;
  a->dof = (double)a->rows;
  for (size_t p = 0; p < a->polynomials; p++) {
    double *own = s->columns + p * rows + a->from, square = fg_dot(own, own, n);
    for (size_t q = 0; q < p; q++) {
      const double *before = s->columns + q * rows + a->from;
      double along = fg_dot(own, before, n);
      for (size_t i = 0; i < n; i++)
        own[i] -= along * before[i];
    }
    double rest = fg_dot(own, own, n);
    if (!(rest > 1e-12 * square)) { /* rounding: it lies in the span of those before it */
      memset(own, 0, n * sizeof *own);
      continue;
    }
    determinant += log(rest);
    a->dof--;
    for (size_t i = 0; i < n; i++)
      own[i] /= sqrt(rest);
    double along = fg_dot(own, left, n);
    for (size_t i = 0; i < n; i++)
      left[i] -= along * own[i];
  }
  a->square = fg_dot(left, left, n);
  return determinant;
}

/* Computes -2 ln of the restricted likelihood up to a constant; a row's variance has its best
 * value. */
static fg_status deviance(search *s, const fg_scatter *scatter, double *value) {
  size_t rows = s->edge_fit->row_count;
  fg_whitening whitening;
  double square = 0, dof = 0, determinants = 0;
  s->edge_fit->scatter = *scatter;
  FG_TRY(fg_whitening_open(s->ctx, s->edge_fit, &whitening));
  memcpy(s->left, s->weighted, rows * sizeof *s->left);
  size_t max = 0;
  for (size_t k = 0; k < s->arc_count; k++)
    max = s->arcs[k].polynomials > max ? s->arcs[k].polynomials : max;
  memcpy(s->columns, s->polynomials, max * rows * sizeof *s->columns);
  fg_whitening_apply(&whitening, s->left);
  for (size_t p = 0; p < max; p++)
    fg_whitening_apply(&whitening, s->columns + p * rows);
  for (size_t k = 0; k < s->arc_count; k++) {
    arc *a = &s->arcs[k];
    double determinant = project_arc(s, a);
    if (a->out) continue;
    for (size_t i = a->from; whitening.band && i < a->to; i++)
      if (whitening.used[i]) determinant -= 2 * log(whitening.scale[i]);
    determinants += determinant;
    square += a->square;
    dof += a->dof;
  }
  fg_whitening_close(&whitening);
  dof = fmax(1, dof - s->shared);
  *value = square > 0 ? dof * log(square / dof) + determinants : INFINITY;
  s->edge_fit->scatter.row_um = sqrt(square / fmax(dof, 1));
  return FG_OK;
}

typedef struct trial {
  fg_scatter scatter;
  double deviance;
} trial;

static fg_status try_one(search *s, fg_scatter scatter, trial *best, bool *better) {
  double value;
  *better = false;
  scatter.integral = 1;
  if (scatter.range_mm < RANGE_MIN_MM || scatter.range_mm > RANGE_MAX_MM) return FG_OK;
  if (scatter.share > SHARE_MAX) return FG_OK;
  FG_TRY(deviance(s, &scatter, &value));
  if (!(value < best->deviance)) return FG_OK;
  *best = (trial){s->edge_fit->scatter, value};
  *better = true;
  return FG_OK;
}

static fg_status try_grid(search *s, trial *best) {
  static const double ranges[] = {0.015, 0.025, 0.04, 0.065, 0.1};
  static const double shares[] = {0.15, 0.4, 0.7, 0.9};
  bool better;
  for (int model = FG_SCATTER_GAUSSIAN; model <= FG_SCATTER_EXPONENTIAL; model++)
    for (size_t r = 0; r < sizeof ranges / sizeof *ranges; r++)
      for (size_t k = 0; k < sizeof shares / sizeof *shares; k++)
        FG_TRY(try_one(s,
                       (fg_scatter){.share = shares[k],
                                    .range_mm = ranges[r],
                                    .model = (fg_scatter_model)model},
                       best, &better));
  return FG_OK;
}

static double share_of_odds(double odds) {
  return odds / (1 + odds);
}

/* Range and odds of the share up and down, each by itself and both at once, in ever smaller steps.
 */
static fg_status climb(search *s, trial *best) {
  double step = STEP_START;
  for (int halving = 0, tries = 0; halving < HALVINGS && tries < CLIMBS; tries++) {
    const fg_scatter from = best->scatter;
    double odds = from.share / (1 - from.share);
    bool any = false, better;
    for (int direction = 0; direction < 8; direction++) {
      static const int way[8][2] = {{1, 0}, {-1, 0},  {0, 1},  {0, -1},
                                    {1, 1}, {-1, -1}, {1, -1}, {-1, 1}};
      fg_scatter to = from;
      to.range_mm *= pow(step, way[direction][0]);
      to.share = share_of_odds(odds * pow(step, 2 * way[direction][1]));
      FG_TRY(try_one(s, to, best, &better));
      any = any || better;
    }
    if (any) continue;
    step = sqrt(step);
    halving++;
  }
  return FG_OK;
}

/* The first time over a grid, later from where it was. */
static fg_status find_best_scatter(search *s, fg_scatter from, trial *best) {
  bool better;
  fg_scatter none = {.integral = 1};
  best->deviance = INFINITY;
  FG_TRY(deviance(s, &none, &best->deviance));
  double white = best->deviance;
  best->scatter = s->edge_fit->scatter;
  trial correlated = {.deviance = INFINITY};
  if (from.share > 0)
    FG_TRY(try_one(s, from, &correlated, &better));
  else
    FG_TRY(try_grid(s, &correlated));
  FG_TRY(climb(s, &correlated));
  if (white - correlated.deviance > GAIN_MIN) *best = correlated;
  return FG_OK;
}

static int compare_squares(const void *a, const void *b) {
  double p = *(const double *)a, q = *(const double *)b;
  return (p > q) - (p < q);
}

/* Leaves out arcs with more than noise; returns their number. */
static fg_status leave_out(search *s, const fg_scatter *scatter, size_t *out) {
  double value, *each = NULL;
  *out = 0;
  FG_TRY(deviance(s, scatter, &value));
  FG_TRY(fg_memory_allocate(s->ctx, s->arc_count, sizeof *each, (void **)&each));
  for (size_t k = 0; k < s->arc_count; k++)
    each[k] = s->arcs[k].square / fmax(s->arcs[k].dof, 1);
  fg_sort_items(each, s->arc_count, sizeof *each, compare_squares);
  double median = each[s->arc_count / 2],
         max = each[(size_t)((1 - ARCS_MAX) * (double)s->arc_count)];
  free(each);
  for (size_t k = 0; k < s->arc_count; k++) {
    arc *a = &s->arcs[k];
    double mean = a->square / fmax(a->dof, 1);
    a->out = mean > median * (1 + ARC_SIGMAS * sqrt(2 / fmax(a->dof, 1))) && mean > max;
    *out += a->out;
  }
  return FG_OK;
}

/* Degrees of polynomials that are such waves along an arc: [from, to). */
static void find_waves(const fg_edge_fit *edge_fit, const arc *a, size_t *from, size_t *to) {
  double length = fabs(edge_fit->rows[a->to - 1].s_mm - edge_fit->rows[a->from].s_mm);
  *from = (size_t)fmax(POLYNOMIALS_MIN, ceil(2 * length / WAVE_LONG_MM));
  *to = (size_t)fmin(POLYNOMIALS_MAX,
                     fmin(floor(2 * length / WAVE_SHORT_MM), (double)(a->rows / ROWS_EACH)));
}

/* Waves of one degree, less the shape common to all bumps, which is no noise. */
typedef struct waves {
  double sum, square, count;
} waves;

static void add_waves(const search *s, const arc *a, waves of_bumps[POLYNOMIALS_MAX],
                      waves *of_lands) {
  size_t rows = s->edge_fit->row_count, from, to;
  bool bump = s->edge_fit->rows[a->from].bump != 0;
  find_waves(s->edge_fit, a, &from, &to);
  for (size_t p = from; p < to && !a->out; p++) {
    double along = fg_dot(s->columns + p * rows + a->from, s->left + a->from, a->to - a->from);
    waves *w = bump ? &of_bumps[p] : of_lands;
    w->sum += along;
    w->square += along * along;
    w->count++;
  }
}

/* Finds the mean square of such waves over that of all rows, both whitened: 1 where the model is
 * valid. */
static fg_status find_swell(search *s, fg_scatter *scatter) {
  waves bumps[POLYNOMIALS_MAX] = {{0}}, lands = {0};
  double value;
  fg_whitening whitening;
  for (size_t k = 0; k < s->arc_count; k++)
    s->arcs[k].polynomials = POLYNOMIALS_MAX;
  fill_polynomials(s);
  FG_TRY(deviance(s, scatter, &value)); /* leaves orthonormal polynomials, in order */
  FG_TRY(fg_whitening_open(s->ctx, s->edge_fit, &whitening));
  memcpy(s->left, s->weighted, s->edge_fit->row_count * sizeof *s->left);
  fg_whitening_apply(&whitening, s->left);
  fg_whitening_close(&whitening);
  for (size_t k = 0; k < s->arc_count; k++)
    add_waves(s, &s->arcs[k], bumps, &lands);
  double square = lands.square, count = lands.count;
  for (size_t p = 0; p < POLYNOMIALS_MAX; p++) {
    if (bumps[p].count < 2) continue;
    square += bumps[p].square - bumps[p].sum * bumps[p].sum / bumps[p].count;
    count += bumps[p].count - 1;
  }
  double mean = count > 0 ? square / count / (scatter->row_um * scatter->row_um) : 1;
  scatter->swell = fmin(fmax(mean, 1), SWELL_MAX);
  scatter->dof = DOF_PER_WAVE * count;
  return FG_OK;
}

static double spacing_of(const fg_edge_fit *edge_fit) {
  double sum = 0, n = 0;
  for (size_t i = 0, to; i < edge_fit->row_count; i = to) {
    to = fg_edge_fit_arc_end(edge_fit, i);
    sum += fabs(edge_fit->rows[to - 1].s_mm - edge_fit->rows[i].s_mm);
    n += (double)(to - i - 1);
  }
  return n > 0 ? sum / n : 1;
}

static double integral_of(const fg_edge_fit *edge_fit, const fg_scatter *s) {
  double spacing = spacing_of(edge_fit), sum = 1;
  for (int lag = 1; lag * spacing < 10 * s->range_mm; lag++) {
    double d = lag * spacing / s->range_mm;
    sum += 2 * s->share * exp(s->model == FG_SCATTER_GAUSSIAN ? -d * d : -d);
  }
  return sum;
}

static fg_status open_search(search *s) {
  size_t rows = s->edge_fit->row_count, columns = POLYNOMIALS_MAX * rows;
  FG_TRY(list_arcs(s));
  FG_TRY(fg_memory_allocate(s->ctx, columns, sizeof(double), (void **)&s->polynomials));
  FG_TRY(fg_memory_allocate(s->ctx, columns, sizeof(double), (void **)&s->columns));
  FG_TRY(fg_memory_allocate(s->ctx, rows, sizeof(double), (void **)&s->left));
  fill_polynomials(s);
  return FG_OK;
}

/* Of the first bump: they are alike. */
static double polynomials_of_bumps(const search *s) {
  for (size_t k = 0; k < s->arc_count; k++)
    if (s->edge_fit->rows[s->arcs[k].from].bump) return (double)s->arcs[k].polynomials;
  return 0;
}

/* Removes the shape common to the bumps, estimated from arcs that show no deviation of their own
 * before the noise is known. */
static fg_status remove_shared(search *s, double *weighted) {
  const fg_scatter white = {.integral = 1};
  bool *left_out = NULL;
  size_t out, numbers;
  FG_TRY(leave_out(s, &white, &out));
  FG_TRY(fg_memory_allocate(s->ctx, s->edge_fit->row_count, sizeof *left_out, (void **)&left_out));
  for (size_t k = 0; k < s->arc_count; k++) {
    arc *a = &s->arcs[k];
    for (size_t i = a->from; i < a->to; i++)
      left_out[i] = a->out;
    a->out = false;
  }
  fg_status status =
      fg_edge_fit_remove_shared_shape(s->ctx, s->edge_fit, left_out, weighted, &numbers);
  s->shared = fmax(0, (double)numbers - polynomials_of_bumps(s));
  free(left_out);
  return status;
}

fg_status fg_edge_fit_find_scatter(fg_context *ctx, fg_edge_fit *edge_fit,
                                   const double *residual_um) {
  search s = {.ctx = ctx, .edge_fit = edge_fit};
  fg_scatter from = edge_fit->scatter;
  trial best = {.scatter = {.integral = 1, .swell = 1}};
  double *weighted = NULL;
  size_t out;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, edge_fit->row_count, sizeof *weighted, (void **)&weighted));
  for (size_t i = 0; i < edge_fit->row_count; i++)
    weighted[i] = residual_um[i] * fg_edge_fit_root_weight(&edge_fit->rows[i]);
  s.weighted = weighted;
  FG_TRY_EXIT(open_search(&s));
  if (!s.arc_count) goto exit;
  FG_TRY_EXIT(remove_shared(&s, weighted));
  FG_TRY_EXIT(find_best_scatter(&s, from, &best));
  FG_TRY_EXIT(leave_out(&s, &best.scatter, &out));
  if (out) FG_TRY_EXIT(find_best_scatter(&s, best.scatter, &best));
  FG_TRY_EXIT(find_swell(&s, &best.scatter));
  best.scatter.integral = integral_of(edge_fit, &best.scatter);
exit:
  edge_fit->scatter = status == FG_OK ? best.scatter : from;
  free(weighted);
  free(s.arcs);
  free(s.polynomials);
  free(s.columns);
  free(s.left);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Deviations of single bumps from their circles that are too small for the search. The search
 * requires of a curve a gain above that of all its columns by chance. Here the columns are few: one
 * bump, some, or a cycle over them, raised at the middle or leaning. The noise is that of finer
 * polynomials on the same bumps, whatever its correlation along the edge. Deviations that follow
 * the direction of the edge are removed first, because the edge model's error does. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "effect/columns.h"
#include "effect/midline.h"
#include "scan_loop/bump_pattern.h"
#include "scan_loop/state.h"
#include "table_loop/engine.h"

/* Polynomials of a bump: a circle's own, those that are judged, those that are noise. */
enum { CIRCLE = 3, JUDGED = 2, NOISE = 4, ORDERS = CIRCLE + JUDGED + NOISE };
/* Minimum number of rows of a bump for separating its polynomials. */
enum { ROWS_MIN = 2 * ORDERS };

/* Amplitudes of one bump over their standard deviations for noise of 1. */
typedef struct amplitudes {
  int number;
  double weight[ORDERS], sum[ORDERS]; /* over the bump's views */
} amplitudes;

/* Fits the polynomials one after the other: the amplitude beside all others is that of the one
 * fitted last. */
static void add_view(const double *columns, const double *value, size_t n, double *work,
                     amplitudes *to) {
  for (int order = CIRCLE; order < ORDERS; order++) {
    size_t used = 0;
    double *others = work, *basis = work + ORDERS * n, own = 0, along = 0;
    for (int k = 0; k < ORDERS; k++)
      if (k != order) memcpy(others + n * used++, columns + (size_t)k * n, n * sizeof *others);
    size_t rank = fg_engine_orthonormal(n, NULL, 0, others, used, basis, NULL);
    double *column = others; /* the copies are in the basis by now */
    memcpy(column, columns + (size_t)order * n, n * sizeof *column);
    own = fg_engine_project_out(n, basis, rank, column);
    for (size_t i = 0; i < n; i++)
      along += column[i] * value[i];
    to->weight[order] += own;
    to->sum[order] += along;
  }
}

/* Computes the residual of every usable row, without the part that follows the edge's direction. */
static fg_status without_directions(fg_context *ctx, const fg_scan_loop *loop, double *value) {
  const fg_edge_fit *edge_fit = &loop->edge_fit;
  const fg_effect *normal = fg_effect_first();
  while (!(fg_effect_is_free(normal) && normal->coordinate == FG_EFFECT_NORMAL))
    normal = fg_effect_next(normal);
  size_t rows = edge_fit->row_count;
  double *columns = NULL, *basis;
  FG_TRY(fg_memory_allocate(ctx, 2 * rows, FG_EFFECT_COLUMNS_MAX * sizeof *columns,
                            (void **)&columns));
  basis = columns + rows * FG_EFFECT_COLUMNS_MAX;
  size_t count = fg_effect_columns(edge_fit, normal, NULL, columns);
  for (size_t i = 0; i < rows; i++) {
    const fg_edge_fit_row *row = &edge_fit->rows[i];
    double root = edge_fit->views[row->view].held_out ? 0 : sqrt(row->weight);
    value[i] = root * loop->residual_after[i];
    for (size_t c = 0; c < count; c++)
      columns[c * rows + i] *= root;
  }
  size_t rank = fg_engine_orthonormal(rows, NULL, 0, columns, count, basis, NULL);
  fg_engine_project_out(rows, basis, rank, value);
  free(columns);
  return FG_OK;
}

/* Fills polynomials over the visible part of the arc: a raised bump turns back sooner, and over the
 * shorter arc polynomials of the common one are nearly collinear. */
static void fill_polynomial_columns(const fg_edge_fit *edge_fit, const size_t *row, size_t n,
                                    double *columns) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < n; i++) {
    low = fmin(low, edge_fit->rows[row[i]].phi);
    high = fmax(high, edge_fit->rows[row[i]].phi);
  }
  for (size_t i = 0; i < n; i++) {
    fg_edge_fit_row own = edge_fit->rows[row[i]];
    double values[ORDERS] = {1};
    own.phi = 2 * (own.phi - low) / (high - low) - 1;
    fg_midline_legendre(&own, 1, 1, ORDERS - 1, values + 1);
    for (int k = 0; k < ORDERS; k++)
      columns[(size_t)k * n + i] = sqrt(own.weight) * values[k];
  }
}

static amplitudes *find_number(amplitudes *list, size_t *count, int number) {
  size_t k = 0;
  while (k < *count && list[k].number < number)
    k++;
  if (k < *count && list[k].number == number) return &list[k];
  if (*count == FG_BUMP_PATTERN_MAX) return NULL;
  memmove(&list[k + 1], &list[k], (*count - k) * sizeof *list);
  ++*count;
  list[k] = (amplitudes){.number = number};
  return &list[k];
}

/* Every bump of every view; rows of a bump on a view are neighbours. */
static fg_status collect_amplitudes(fg_context *ctx, const fg_scan_loop *loop, amplitudes *list,
                                    size_t *count) {
  const fg_edge_fit *edge_fit = &loop->edge_fit;
  size_t rows = edge_fit->row_count, *row = NULL;
  double *value = NULL, *work = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, 2 * rows, sizeof *value, (void **)&value));
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, sizeof *row, (void **)&row));
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, 3 * ORDERS * sizeof *work, (void **)&work));
  FG_TRY_EXIT(without_directions(ctx, loop, value));
  double *own = value + rows, *columns = work + 2 * ORDERS * rows;
  for (size_t from = 0, to; from < rows; from = to) {
    const fg_edge_fit_row *first = &edge_fit->rows[from];
    size_t n = 0;
    for (to = from; to < rows && edge_fit->rows[to].view == first->view &&
                    edge_fit->rows[to].bump == first->bump;
         to++) {
      if (!(edge_fit->rows[to].weight > 0) || edge_fit->views[first->view].held_out) continue;
      own[n] = value[to];
      row[n++] = to;
    }
    amplitudes *of = first->bump && n >= ROWS_MIN ? find_number(list, count, first->bump) : NULL;
    if (!of) continue;
    fill_polynomial_columns(edge_fit, row, n, columns);
    add_view(columns, own, n, work, of);
  }
exit:
  free(value);
  free(row);
  free(work);
  return status;
}

static double standard(const amplitudes *a, int order) {
  return a->weight[order] > 0 ? a->sum[order] / sqrt(a->weight[order]) : 0;
}

static double square_about_mean(const amplitudes *list, size_t count, int order) {
  double mean = 0, sum = 0;
  for (size_t k = 0; k < count; k++)
    mean += standard(&list[k], order) / (double)count;
  for (size_t k = 0; k < count; k++)
    sum += pow(standard(&list[k], order) - mean, 2);
  return sum;
}

static double mean_root_weight(const amplitudes *list, size_t count, int order) {
  double sum = 0;
  for (size_t k = 0; k < count; k++)
    sum += sqrt(list[k].weight[order]) / (double)count;
  return sum;
}

/* Returns the smallest deviation of a bump, um, that is more than the error of its edge's model may
 * do: the error is smooth, so that lower polynomials have more of it than those that are noise. The
 * largest of many is larger by chance. */
static double min_deviation_um(const fg_scan_loop *loop, size_t count) {
  return loop->edge_error_um * sqrt(2 * (loop->margin + log(JUDGED * (double)count)));
}

/* Probability that nothing of single bumps is there. `min_um`: a smaller deviation is nothing. */
static double find_p(const amplitudes *list, size_t count, uint64_t seed, double min_um) {
  fg_bump_values at = {.n = count, .noise_dof = NOISE * (double)(count - 1)};
  double min = 1;
  for (int order = CIRCLE + JUDGED; order < ORDERS; order++)
    at.noise_square += square_about_mean(list, count, order);
  for (int order = CIRCLE; order < CIRCLE + JUDGED; order++) {
    double p_value;
    for (size_t k = 0; k < count; k++) {
      at.number[k] = list[k].number;
      at.value[k] = standard(&list[k], order);
    }
    const fg_bump_pattern pattern = fg_bump_pattern_find(&at, seed, &p_value);
    double limit = min_um * mean_root_weight(list, count, order);
    if (fabs(pattern.by) >= limit) min = fmin(min, JUDGED * p_value);
  }
  return min;
}

/* The curve of single bumps joins every explanation, and is fitted beside the winner. */
static fg_status join_curve(fg_context *ctx, fg_scan_loop *loop, size_t candidate, double p_value) {
  fg_explanations *explanations = &loop->explanations;
  for (size_t m = 0; m < explanations->count; m++)
    explanations->each[m].mask |= 1u << candidate;
  explanations->p_value = fmin(explanations->p_value, p_value);
  const fg_candidate *from = &explanations->candidates[candidate];
  loop->set.effects[loop->set.count++] =
      (fg_effect_found){.kind = from->kind, .columns = from->columns};
  return fg_joint_fit(ctx, &loop->edge_fit, &loop->set, loop->residual_after);
}

fg_status fg_scan_loop_find_single_bumps(fg_context *ctx, fg_scan_loop *loop) {
  const fg_explanations *explanations = &loop->explanations;
  size_t candidate = 0, count = 0;
  amplitudes list[FG_BUMP_PATTERN_MAX];
  if (loop->edge_fit.discs || loop->edge_fit.coarse || loop->set.count == FG_EFFECT_SET_MAX)
    return FG_OK;
  if (!explanations->right) return FG_OK;
  /* With a free curve, or an effect that bends bumps, deviations are not of single bumps. */
  for (size_t e = 0; e < loop->set.count; e++)
    if (loop->set.effects[e].kind->bends || fg_effect_is_free(loop->set.effects[e].kind))
      return FG_OK;
  while (candidate < explanations->candidate_count &&
         explanations->candidates[candidate].kind->coordinate != FG_EFFECT_INDEX)
    candidate++;
  if (candidate == explanations->candidate_count) return FG_OK;
  FG_TRY(collect_amplitudes(ctx, loop, list, &count));
  if (count < FG_BUMP_PATTERN_MIN) return FG_OK;
  double p_value = find_p(list, count, loop->options.seed, min_deviation_um(loop, count));
  return p_value < FG_BUMP_PATTERN_P ? join_curve(ctx, loop, candidate, p_value) : FG_OK;
}

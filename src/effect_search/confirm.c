/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Confirmation of an effect from disc to disc.
 *
 * On one disc, its own form error looks like an effect of the scanner, and it does not average out
 * along the edge as noise does. So an effect must predict discs that it was not fitted to. Two
 * tests decide: its gain in grouped cross-validation, with discs as groups, and its amplitude
 * against the scatter between discs. A step or a ripple was sought over many places and may lie on
 * one disc alone. It is also confirmed when it is significant beside a smooth form error of every
 * disc, and each side of the discs predicts the other. */
#include "effect_search/confirm.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/small_solve.h"
#include "effect/columns.h"
#include "effect_search/common_level.h"
#include "effect_search/policy.h"

/* P-value at which an amplitude is confirmed (this and the constants below were tuned on
 * reports/loop_plate.md: plates with and without an effect, of true and of lobed pins). */
#define CONFIRM_P 0.005
/* P-value for the best of many places. */
#define CONFIRM_SHAPED_P 1e-4
/* Standard errors that the gain of a free curve has to exceed; of a listed effect. */
#define FREE_ERRORS   3.0
#define LISTED_ERRORS 1.0
/* Minimum amplitude in standard uncertainties, equal to the smallest detectable one in reports
 * (describe.c). */
#define AMPLITUDE_ERRORS 3.5
/* Minimum effective number of groups with information. */
#define GROUPS_MIN 1.5
/* Number of undulations of a disc's form error beside which a step or a ripple is tested. */
enum { ROUNDNESS_HARMONICS = 5 };
/* Pivot, as a share of its diagonal, below which normal equations are singular: of an effect; of a
 * form error, whose rows may lie on a short arc. */
#define SINGULAR           1e-9
#define ROUNDNESS_SINGULAR 1e-12
/* Sum of squares beside the form errors, um², below which a column counts as zero. */
#define NOTHING_UM2 1e-6
/* Lower limits of the dof of Student's t, and of the scatter. */
#define DOF_MIN     0.5
#define SCATTER_MIN 1e-300

typedef struct confirmation {
  const fg_edge_fit *edge_fit;
  const fg_effect_found *effect;
  double *residual; /* rows: with the effect added back, beside each disc's circle */
  double *columns;  /* effect->columns × rows, likewise */
  fg_normal_equations *groups;
  size_t group_count, columns_used, index[FG_EFFECT_COLUMNS_MAX];
} confirmation;

static double row_weight_at(const fg_edge_fit *edge_fit, size_t i) {
  const fg_edge_fit_row *row = &edge_fit->rows[i];
  return edge_fit->views[row->view].held_out ? 0 : row->weight / FG_EDGE_FIT_BLOCK;
}

/* Nuisance terms of each disc: harmonics up to this, and its radius unless it is known and counts.
 * The level of all edges moves known radii as well: only a scale is separated from it
 * (common_level.h); any other effect must show in the discs' shapes. */
typedef struct roundness {
  size_t harmonics;
  bool radius_counts;
} roundness;

/* Harmonics 1 to the last at a row, then 1 unless the radius counts; returns how many. */
static size_t roundness_basis(const fg_edge_fit *edge_fit, size_t i, roundness of, double *basis) {
  const fg_edge_fit_row *row = &edge_fit->rows[i];
  size_t n = 0;
  for (size_t k = 1; k <= of.harmonics; k++) {
    basis[n++] = cos((double)k * row->normal_rad);
    basis[n++] = sin((double)k * row->normal_rad);
  }
  if (!of.radius_counts || !edge_fit->parts[row->part].radius_known) basis[n++] = 1;
  return n;
}

/* Removes a disc's circle, or its form error up to a harmonic, from values at its rows [first,
 * last). */
static void remove_roundness_error(const fg_edge_fit *edge_fit, size_t first, size_t last,
                                   roundness of, double *values) {
  fg_normal_equations system;
  double x[FG_SMALL_MAX] = {0}, basis[FG_SMALL_MAX];
  size_t unknowns = roundness_basis(edge_fit, first, of, basis);
  fg_normal_clear(&system, unknowns);
  for (size_t i = first; i < last; i++) {
    roundness_basis(edge_fit, i, of, basis);
    fg_normal_add(&system, basis, values[i], row_weight_at(edge_fit, i));
  }
  if (!fg_normal_solve(&system, ROUNDNESS_SINGULAR, x, NULL)) return;
  for (size_t i = first; i < last; i++) {
    roundness_basis(edge_fit, i, of, basis);
    for (size_t k = 0; k < unknowns; k++)
      values[i] -= x[k] * basis[k];
  }
}

static void remove_roundness_errors(const fg_edge_fit *edge_fit, roundness of, double *values) {
  for (size_t first = 0; first < edge_fit->row_count;) {
    size_t last = first;
    while (last < edge_fit->row_count && edge_fit->rows[last].view == edge_fit->rows[first].view)
      last++;
    remove_roundness_error(edge_fit, first, last, of, values);
    first = last;
  }
}

/* Normal equations of the effect in each group. */
static void fill_groups(confirmation *c, bool sides) {
  size_t rows = c->edge_fit->row_count;
  double row[FG_SMALL_MAX];
  for (size_t g = 0; g < c->group_count; g++)
    fg_normal_clear(&c->groups[g], c->columns_used);
  for (size_t i = 0; i < rows; i++) {
    const fg_edge_fit_row *at = &c->edge_fit->rows[i];
    size_t g = sides ? 2 * at->view + (at->normal.x > 0) : at->view;
    for (size_t k = 0; k < c->columns_used; k++)
      row[k] = c->columns[c->index[k] * rows + i];
    fg_normal_add(&c->groups[g], row, c->residual[i], row_weight_at(c->edge_fit, i));
  }
}

static void add_system(fg_normal_equations *to, const fg_normal_equations *from, double sign) {
  for (size_t a = 0; a < to->unknowns; a++) {
    to->right[a] += sign * from->right[a];
    for (size_t b = 0; b <= a; b++)
      to->matrix[a][b] += sign * from->matrix[a][b];
  }
}

static double quadratic(const fg_normal_equations *s, const double *x) {
  double sum = 0;
  for (size_t a = 0; a < s->unknowns; a++)
    for (size_t b = 0; b <= a; b++)
      sum += (a == b ? 1 : 2) * x[a] * s->matrix[a][b] * x[b];
  return sum;
}

static double linear(const fg_normal_equations *s, const double *x) {
  double sum = 0;
  for (size_t a = 0; a < s->unknowns; a++)
    sum += x[a] * s->right[a];
  return sum;
}

/* Number of groups that the information would be spread over evenly. */
static double effective_groups(const confirmation *c, const double *x) {
  double sum = 0, squares = 0;
  for (size_t g = 0; g < c->group_count; g++) {
    double part = quadratic(&c->groups[g], x);
    sum += part;
    squares += part * part;
  }
  return squares > 0 ? sum * sum / squares : 0;
}

/* Gain in grouped cross-validation, in its own standard errors. */
static double validated_gain(const confirmation *c, const fg_normal_equations *whole) {
  double sum = 0, squares = 0, n = 0;
  for (size_t g = 0; g < c->group_count; g++) {
    fg_normal_equations others = *whole;
    double x[FG_SMALL_MAX];
    if (!(c->groups[g].matrix[0][0] > 0)) continue;
    add_system(&others, &c->groups[g], -1);
    if (!fg_normal_solve(&others, SINGULAR, x, NULL)) return -INFINITY;
    double gain = 2 * linear(&c->groups[g], x) - quadratic(&c->groups[g], x);
    sum += gain;
    squares += gain * gain;
    n++;
  }
  double variance = n > 1 ? (squares - sum * sum / n) * n / (n - 1) : 0;
  return variance > 0 ? sum / sqrt(variance) : -INFINITY;
}

/* Student's t of the amplitude along x, against its scatter from group to group. */
static double scatter_p(const confirmation *c, const double *x, double groups) {
  double amount = 0, scatter = 0, n = 0;
  for (size_t g = 0; g < c->group_count; g++) {
    double have = linear(&c->groups[g], x), expect = quadratic(&c->groups[g], x);
    if (!(expect > 0)) continue;
    amount += expect;
    scatter += (have - expect) * (have - expect);
    n++;
  }
  double t = amount / sqrt(fmax(scatter * n / fmax(n - 1, 1), SCATTER_MIN));
  return gsl_cdf_tdist_Q(t, fmax(groups - (double)c->columns_used, DOF_MIN));
}

/* Whole normal equations and their solution; false when there is nothing to solve. */
static bool solve_whole(confirmation *c, bool sides, fg_normal_equations *whole, double *x,
                        double inverse[FG_SMALL_MAX][FG_SMALL_MAX]) {
  c->group_count = (sides ? 2 : 1) * c->edge_fit->view_count;
  fill_groups(c, sides);
  fg_normal_clear(whole, c->columns_used);
  for (size_t g = 0; g < c->group_count; g++)
    add_system(whole, &c->groups[g], 1);
  return c->columns_used && fg_normal_solve(whole, SINGULAR, x, inverse);
}

/* Returns a positive number when discs confirm the effect, larger for stronger confirmation. */
static double confirm_by_discs(confirmation *c, double needed_p, double needed_errors) {
  fg_normal_equations whole;
  double x[FG_SMALL_MAX];
  if (!solve_whole(c, false, &whole, x, NULL)) return -INFINITY;
  double groups = effective_groups(c, x);
  if (groups < GROUPS_MIN) return -INFINITY;
  if (needed_p > 0 && scatter_p(c, x, groups) > needed_p) return -INFINITY;
  return validated_gain(c, &whole) - needed_errors;
}

/* Returns the variance of the residual beside the effect, per unit of weight, for correlated noise;
 * removes the effect from the residual. */
static double residual_variance(const confirmation *c, const double *x) {
  double square = 0, count = 0;
  size_t rows = c->edge_fit->row_count;
  for (size_t i = 0; i < rows; i++) {
    for (size_t k = 0; k < c->columns_used; k++)
      c->residual[i] -= x[k] * c->columns[c->index[k] * rows + i];
    c->residual[i] *= sqrt(row_weight_at(c->edge_fit, i));
    square += c->residual[i] * c->residual[i];
    count += c->residual[i] != 0;
  }
  return count > 0 ? square / count * fg_edge_fit_integral(c->edge_fit, NULL, rows, c->residual)
                   : INFINITY;
}

/* As the test by discs, for a step or a ripple beside the form error of every disc, from side to
 * side. */
static double confirm_by_sides(confirmation *c) {
  fg_normal_equations whole;
  double x[FG_SMALL_MAX];
  if (!solve_whole(c, true, &whole, x, NULL)) return -INFINITY;
  if (effective_groups(c, x) < GROUPS_MIN) return -INFINITY;
  double gain = validated_gain(c, &whole) - LISTED_ERRORS;
  return quadratic(&whole, x) <
                 fg_search_policy_of(c->edge_fit)->placed_chi2 * residual_variance(c, x)
             ? -INFINITY
             : gain;
}

/* Widens the standard uncertainties of the coefficients by the scatter between discs (a sandwich of
 * the groups' scores), where there are enough discs. */
static void widen_by_scatter(confirmation *c, fg_effect_found *effect) {
  fg_normal_equations whole;
  double x[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX], n = 0;
  double variance[FG_EFFECT_COLUMNS_MAX] = {0};
  if (!solve_whole(c, false, &whole, x, inverse)) return;
  if (effective_groups(c, x) < (double)c->columns_used + 1) return;
  for (size_t g = 0; g < c->group_count; g++) {
    const fg_normal_equations *own = &c->groups[g];
    double score[FG_EFFECT_COLUMNS_MAX];
    for (size_t a = 0; a < c->columns_used; a++) {
      score[a] = own->right[a];
      for (size_t b = 0; b < c->columns_used; b++)
        score[a] -= own->matrix[a > b ? a : b][a > b ? b : a] * x[b];
    }
    for (size_t a = 0; a < c->columns_used; a++) {
      double moved = 0;
      for (size_t b = 0; b < c->columns_used; b++)
        moved += inverse[a][b] * score[b];
      variance[a] += moved * moved;
    }
    n += own->matrix[0][0] > 0;
  }
  for (size_t a = 0; a < c->columns_used && n > 1; a++) {
    double *u = &effect->u_coefficient_um[c->index[a]];
    *u = fmax(*u, sqrt(variance[a] * n / (n - 1)));
  }
}

/* Widens a scale's uncertainty by that of the edges' common level: a wrong level imitates a scale
 * as far as the discs are of one size. */
static void widen_by_level(const confirmation *c, fg_effect_found *effect) {
  double along = 0, square = 0;
  for (size_t i = 0; i < c->edge_fit->row_count; i++) {
    const fg_edge_fit_row *row = &c->edge_fit->rows[i];
    if (!c->edge_fit->parts[row->part].radius_known) continue;
    along += row_weight_at(c->edge_fit, i) * c->columns[i];
    square += row_weight_at(c->edge_fit, i) * c->columns[i] * c->columns[i];
  }
  double uncertainty = fg_common_level_uncertainty(c->edge_fit, c->columns, c->residual);
  if (square > 0)
    effect->u_coefficient_um[0] = hypot(effect->u_coefficient_um[0], uncertainty * along / square);
}

static void prepare_confirmation(confirmation *c, const double *residual_um, size_t harmonics) {
  const fg_effect_found *effect = c->effect;
  const roundness of = {harmonics, effect->kind->scales};
  size_t rows = c->edge_fit->row_count;
  fg_effect_columns(c->edge_fit, effect->kind, effect->shape, c->columns);
  memcpy(c->residual, residual_um, rows * sizeof *c->residual);
  c->columns_used = 0;
  for (size_t k = 0; k < effect->columns; k++) {
    double *column = c->columns + k * rows, square = 0;
    for (size_t i = 0; i < rows; i++)
      c->residual[i] += effect->coefficient_um[k] * column[i];
    remove_roundness_errors(c->edge_fit, of, column);
    for (size_t i = 0; i < rows; i++)
      square += row_weight_at(c->edge_fit, i) * column[i] * column[i];
    if (square > NOTHING_UM2) c->index[c->columns_used++] = k;
  }
  remove_roundness_errors(c->edge_fit, of, c->residual);
}

/* Amplitude in its standard uncertainties. */
static double amplitude_errors(const fg_effect_found *effect) {
  double square = 0, noise = 0;
  for (size_t k = 0; k < effect->columns; k++) {
    double a = effect->coefficient_um[k], u = effect->u_coefficient_um[k];
    square += a * a;
    noise += a * a * u * u;
  }
  return noise > 0 ? square / sqrt(noise) : INFINITY;
}

static double judge_effect(confirmation *c, fg_effect_found *effect, const double *residual_um) {
  bool free_curve = fg_effect_is_free(effect->kind), shaped = effect->shapes > 0;
  prepare_confirmation(c, residual_um, 1);
  double confirmed = confirm_by_discs(c,
                                      free_curve ? 0
                                      : shaped   ? CONFIRM_SHAPED_P
                                                 : CONFIRM_P,
                                      free_curve ? FREE_ERRORS : LISTED_ERRORS);
  widen_by_scatter(c, effect);
  if (effect->kind->scales) widen_by_level(c, effect);
  if (shaped && !(confirmed > 0)) {
    prepare_confirmation(c, residual_um, ROUNDNESS_HARMONICS);
    confirmed = confirm_by_sides(c);
  }
  if (!free_curve && amplitude_errors(effect) < AMPLITUDE_ERRORS) return -INFINITY;
  return confirmed;
}

fg_status fg_search_confirm(fg_context *ctx, const fg_edge_fit *edge_fit, fg_effect_found *effect,
                            const double *residual_um, double *confirmed) {
  confirmation c = {.edge_fit = edge_fit, .effect = effect};
  fg_status status = FG_OK;
  size_t rows = edge_fit->row_count;
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, sizeof *c.residual, (void **)&c.residual));
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, FG_EFFECT_COLUMNS_MAX * sizeof *c.columns,
                                 (void **)&c.columns));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, edge_fit->view_count, 2 * sizeof *c.groups, (void **)&c.groups));
  *confirmed = judge_effect(&c, effect, residual_um);
exit:
  free(c.residual);
  free(c.columns);
  free(c.groups);
  return status;
}

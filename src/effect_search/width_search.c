/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect_search/width_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "core/memory.h"
#include "core/small_solve.h"
#include "core/spread.h"
#include "effect/columns.h"
#include "effect/midline.h"
#include "effect_search/shape_noise.h"

/* P-value of a claim: one test per effect, in every scan that is ever measured. */
#define CHANCE 0.001
/* Standard uncertainty of half the width at FG_FIELD_HALF_MM from the middle by the edge model's
 * error over the place. Tuned on the shaded renders of reports/loop_width.md (gamma, shading,
 * flare), where it was 0.02 rms and 0.04 at most. */
#define PLACE_UM 0.04
/* Rows this far off (dust, a burr) lose their weight. */
#define OUTLIER_SIGMAS 5.0
enum { OUTLIER_ROUNDS = 2 };
/* Minimum number of bumps and lands for a claim. */
enum { GROUPS_MIN = 6 };
/* Nuisances: twice and four times the direction of the edge's normal (a strip has two opposite
 * edges, so odd multiples cancel), and one that separates bumps from lands, which bend differently.
 */
enum { NUISANCES = 5, AXES = 2 };
/* Widths that nobody has named: over the foil, on bumps alone, and over the arc of every bump,
 * alike on all or growing with their numbers. */
enum { OVER_FOIL = 2, OVER_BUMPS = 1, OVER_ARC = 3 };
enum { SMOOTH_RIVALS = OVER_FOIL + OVER_BUMPS, RIVALS = SMOOTH_RIVALS + 2 * OVER_ARC };
enum { UNKNOWNS = FG_WIDTH_EFFECTS_MAX + RIVALS + NUISANCES };
/* A column of less mean square than this is none. */
#define VANISHED 1e-9

typedef struct width_row {
  size_t row, view, group;
  double weight, value_um, column[UNKNOWNS], place[AXES];
} width_row;

typedef struct width_view {
  double weight, value_um, column[UNKNOWNS], place[AXES];
} width_view;

typedef struct width_fit {
  const fg_edge_fit *edge_fit;
  width_row *rows;
  size_t count;
  width_view *views; /* means */
  size_t effects, unknowns;
  fg_normal_equations system;
  double x[UNKNOWNS], inverse[FG_SMALL_MAX][FG_SMALL_MAX];
} width_fit;

/* ---- rows ---- */

static size_t put_nuisances(const fg_edge_fit_row *row, double *column) {
  for (int k = 0; k < 2; k++) {
    column[2 * k] = cos((2 + 2 * k) * row->normal_rad);
    column[2 * k + 1] = sin((2 + 2 * k) * row->normal_rad);
  }
  column[4] = row->bump ? 1 : 0;
  return NUISANCES;
}

static void list_rows(width_fit *f) {
  const fg_edge_fit *edge_fit = f->edge_fit;
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    const fg_edge_fit_row *row = &edge_fit->rows[i];
    if (edge_fit->views[row->view].held_out || !(row->weight > 0) || !(row->half_width_mm > 0))
      continue;
    width_row *to = &f->rows[f->count++];
    *to = (width_row){.row = i,
                      .view = row->view,
                      .group = row->group,
                      .weight = row->weight,
                      .value_um = 1000 * row->half_width_mm};
    to->place[0] = (row->at.x - edge_fit->frame.centre_mm[0]) / FG_FIELD_HALF_MM;
    to->place[1] = (row->at.y - edge_fit->frame.centre_mm[1]) / FG_FIELD_HALF_MM;
    put_nuisances(row, to->column + f->effects);
  }
  f->unknowns = f->effects + NUISANCES;
}

static void put_rivals(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, double *column) {
  const fg_edge_fit_part *part = &edge_fit->parts[row->part];
  double u = part->end_to_end_rad > 0 ? 2 * row->psi / part->end_to_end_rad : 0,
         arc[OVER_ARC] = {0};
  column[0] = (3 * u * u - 1) / 2;
  column[1] = u * (5 * u * u - 3) / 2;
  column[2] = row->bump ? u : 0;
  if (row->bump) fg_midline_legendre(row, 1, 1, OVER_ARC, arc);
  for (int k = 0; k < OVER_ARC; k++) {
    column[SMOOTH_RIVALS + 2 * k] = arc[k];
    column[SMOOTH_RIVALS + 2 * k + 1] = u * arc[k];
  }
}

/* The rivals stand behind the effects as further ones. */
static void join_rivals(width_fit *f) {
  for (size_t i = 0; i < f->count; i++) {
    width_row *to = &f->rows[i];
    const fg_edge_fit_row *row = &f->edge_fit->rows[to->row];
    memmove(to->column + f->effects + RIVALS, to->column + f->effects,
            (f->unknowns - f->effects) * sizeof *to->column);
    put_rivals(f->edge_fit, row, to->column + f->effects);
  }
  f->effects += RIVALS;
  f->unknowns += RIVALS;
}

static void put_effects(width_fit *f, const fg_width_findings *findings, double *work) {
  for (size_t e = 0; e < f->effects; e++) {
    fg_effect_width_columns(f->edge_fit, findings->each[e].effect.kind, NULL, work);
    for (size_t i = 0; i < f->count; i++)
      f->rows[i].column[e] = work[f->rows[i].row];
  }
}

/* Removes the stretch by the scanner's fields: it is no effect of the width. */
static void remove_stretch(width_fit *f, const fg_effect_set *set, const double *stretch_um,
                           double *work) {
  for (size_t i = 0; stretch_um && i < f->count; i++)
    f->rows[i].value_um -= stretch_um[f->rows[i].row];
  if (stretch_um) return;
  for (size_t e = 0; e < set->count; e++) {
    const fg_effect_found *effect = &set->effects[e];
    size_t count = fg_effect_width_columns(f->edge_fit, effect->kind, effect->shape, work);
    for (size_t c = 0; c < count; c++)
      for (size_t i = 0; i < f->count; i++)
        f->rows[i].value_um -=
            effect->coefficient_um[c] * work[c * f->edge_fit->row_count + f->rows[i].row];
  }
}

/* ---- least squares beside a level of every view ---- */

static void add_to_mean(double *mean, double value, double share) {
  *mean += share * (value - *mean);
}

static void find_view_means(width_fit *f) {
  memset(f->views, 0, f->edge_fit->view_count * sizeof *f->views);
  for (size_t i = 0; i < f->count; i++) {
    const width_row *row = &f->rows[i];
    width_view *view = &f->views[row->view];
    if (!(row->weight > 0)) continue;
    view->weight += row->weight;
    double share = row->weight / view->weight;
    add_to_mean(&view->value_um, row->value_um, share);
    for (size_t c = 0; c < f->unknowns; c++)
      add_to_mean(&view->column[c], row->column[c], share);
    for (size_t a = 0; a < AXES; a++)
      add_to_mean(&view->place[a], row->place[a], share);
  }
}

/* A row beside its view's means. */
static width_row beside(const width_fit *f, const width_row *row) {
  const width_view *view = &f->views[row->view];
  width_row r = *row;
  r.value_um -= view->value_um;
  for (size_t c = 0; c < f->unknowns; c++)
    r.column[c] -= view->column[c];
  for (size_t a = 0; a < AXES; a++)
    r.place[a] -= view->place[a];
  return r;
}

/* Columns that are the same everywhere (no lands) go; those of effects stay, and the fit fails. */
static void drop_vanished(width_fit *f) {
  double weight = 0;
  size_t kept = f->effects;
  for (size_t v = 0; v < f->edge_fit->view_count; v++)
    weight += f->views[v].weight;
  for (size_t c = f->effects; c < f->unknowns; c++) {
    if (!(f->system.matrix[c][c] > VANISHED * weight)) continue;
    for (size_t i = 0; i < f->count; i++)
      f->rows[i].column[kept] = f->rows[i].column[c];
    kept++;
  }
  f->unknowns = kept;
}

static void fill_system(width_fit *f) {
  find_view_means(f);
  fg_normal_clear(&f->system, f->unknowns);
  for (size_t i = 0; i < f->count; i++) {
    width_row r = beside(f, &f->rows[i]);
    if (r.weight > 0) fg_normal_add(&f->system, r.column, r.value_um, r.weight);
  }
}

static bool fit_widths(width_fit *f) {
  fill_system(f);
  size_t before = f->unknowns;
  drop_vanished(f);
  if (f->unknowns < before) fill_system(f);
  return fg_normal_solve(&f->system, 0, f->x, f->inverse);
}

static double left_um(const width_fit *f, const width_row *row) {
  width_row r = beside(f, row);
  for (size_t c = 0; c < f->unknowns; c++)
    r.value_um -= f->x[c] * r.column[c];
  return r.value_um;
}

static fg_status drop_outliers(fg_context *ctx, width_fit *f) {
  double *size = NULL;
  size_t n = 0;
  FG_TRY(fg_memory_allocate(ctx, f->count, sizeof *size, (void **)&size));
  for (size_t i = 0; i < f->count; i++)
    if (f->rows[i].weight > 0) size[n++] = fabs(left_um(f, &f->rows[i]));
  double limit = fg_spread_limit(size, n, OUTLIER_SIGMAS);
  for (size_t i = 0; i < f->count; i++)
    if (fabs(left_um(f, &f->rows[i])) > limit) f->rows[i].weight = 0;
  free(size);
  return FG_OK;
}

/* ---- uncertainty ---- */

/* Removes the rows [from, to) of one view from the equations. Beside the mean of the remaining
 * rows, the sum of squares is that beside the old mean less the square of its sum over its weight;
 * about the old mean, the remaining rows sum to minus the removed ones. */
static void remove_view(const width_fit *f, size_t from, size_t to, fg_normal_equations *system) {
  double sum[UNKNOWNS] = {0}, value = 0, weight = 0;
  for (size_t i = from; i < to; i++) {
    width_row r = beside(f, &f->rows[i]);
    if (!(r.weight > 0)) continue;
    fg_normal_add(system, r.column, r.value_um, -r.weight);
    for (size_t c = 0; c < f->unknowns; c++)
      sum[c] += r.weight * r.column[c];
    value += r.weight * r.value_um;
    weight += r.weight;
  }
  double rest = f->views[f->rows[from].view].weight - weight;
  if (rest > 0 && weight > 0)
    for (size_t c = 0; c < f->unknowns; c++)
      sum[c] /= rest;
  if (rest > 0 && weight > 0) fg_normal_add(system, sum, value / rest, -rest);
}

/* Computes variances by leaving out one group after the other (jackknife, conservative with few
 * groups): variance of every effect, and the number of groups. */
static size_t find_variances(const width_fit *f, double *variance) {
  size_t groups = 0;
  for (size_t e = 0; e < f->effects; e++)
    variance[e] = 0;
  for (size_t from = 0, to; from < f->count; from = to, groups++) {
    fg_normal_equations system = f->system;
    double x[UNKNOWNS];
    for (to = from; to < f->count && f->rows[to].group == f->rows[from].group;) {
      size_t first = to;
      while (to < f->count && f->rows[to].group == f->rows[first].group &&
             f->rows[to].view == f->rows[first].view)
        to++;
      remove_view(f, first, to, &system);
    }
    bool solved = fg_normal_solve(&system, 0, x, NULL);
    for (size_t e = 0; e < f->effects; e++)
      variance[e] += solved ? (x[e] - f->x[e]) * (x[e] - f->x[e]) : INFINITY;
  }
  for (size_t e = 0; e < f->effects; e++)
    variance[e] *= (double)(groups - 1) / (double)groups;
  return groups;
}

/* Returns the change of an effect by an error of 1 um at FG_FIELD_HALF_MM along an axis of the
 * glass. */
static double change_by_place_error(const width_fit *f, size_t e, size_t axis) {
  double sum = 0;
  for (size_t i = 0; i < f->count; i++) {
    width_row r = beside(f, &f->rows[i]);
    for (size_t c = 0; c < f->unknowns && r.weight > 0; c++)
      sum += f->inverse[e][c] * r.weight * r.column[c] * r.place[axis];
  }
  return sum;
}

/* Returns the variance of an effect by the noise of one view's shape. */
static double find_view_shape_variance(const width_fit *f, size_t e, size_t view) {
  const fg_edge_fit_view *v = &f->edge_fit->views[view];
  if (!v->foil || v->held_out) return 0;
  double px_mm = 25.4 / sqrt(v->measurement->dpi[0] * v->measurement->dpi[1]);
  double noise_um2_mm = fg_shape_noise_um2_mm(&v->foil->strip, px_mm);
  double change[FG_SHAPE_FUNCTIONS] = {0},
         values[FG_SHAPE_FUNCTIONS + 1] = {[FG_SHAPE_FUNCTIONS] = 1};
  double unused[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX], variance = 0;
  fg_normal_equations shape;
  fg_normal_clear(&shape, FG_SHAPE_FUNCTIONS + 1);
  for (size_t i = 0; i < f->count; i++) {
    if (f->rows[i].view != view) continue;
    width_row r = beside(f, &f->rows[i]);
    const fg_edge_fit_row *row = &f->edge_fit->rows[r.row];
    double share = 0;
    fg_shape_functions(row->normal_rad, r.place, values);
    fg_normal_add(&shape, values, 0, row->weight * v->foil->strip.step_mm);
    for (size_t c = 0; c < f->unknowns && r.weight > 0; c++)
      share += f->inverse[e][c] * r.weight * r.column[c];
    for (size_t a = 0; a < FG_SHAPE_FUNCTIONS; a++)
      change[a] += share * values[a];
  }
  if (!fg_normal_solve(&shape, 0, unused, inverse)) return 0;
  for (size_t a = 0; a < FG_SHAPE_FUNCTIONS; a++)
    for (size_t b = 0; b < FG_SHAPE_FUNCTIONS; b++)
      variance += change[a] * inverse[a][b] * change[b];
  return noise_um2_mm * variance;
}

/* ---- claims ---- */

static double find_u(const width_fit *f, size_t e, double variance) {
  double place = PLACE_UM * hypot(change_by_place_error(f, e, 0), change_by_place_error(f, e, 1));
  double square = variance + place * place;
  for (size_t v = 0; v < f->edge_fit->view_count; v++)
    square += find_view_shape_variance(f, e, v);
  return sqrt(square);
}

static double find_p(const width_fit *f, size_t e, double variance, size_t groups) {
  return 2 * gsl_cdf_tdist_Q(fabs(f->x[e]) / find_u(f, e, variance), (double)groups - 1);
}

static void assess_width_effect(const width_fit *f, size_t e, double variance, size_t groups,
                                fg_width_effect *one) {
  double square = f->system.matrix[e][e], right = f->system.right[e];
  double dof = (double)groups - 1, u = find_u(f, e, variance);
  one->effect.coefficient_um[0] = f->x[e];
  one->effect.u_coefficient_um[0] = u;
  one->p_value = find_p(f, e, variance, groups);
  one->found = one->p_value < CHANCE;
  one->share = 1 / (f->inverse[e][e] * square);
  one->would_explain = right * right / (square * f->system.sum_squares);
  one->smallest_um = u * gsl_cdf_tdist_Qinv(0.5 * CHANCE, dof);
}

static double rms_um(const width_fit *f, const fg_width_findings *findings, bool after) {
  double sum = 0, weight = 0;
  for (size_t i = 0; i < f->count; i++) {
    const fg_edge_fit_row *row = &f->edge_fit->rows[f->rows[i].row];
    width_row r = beside(f, &f->rows[i]);
    for (size_t e = 0; after && e < f->effects; e++)
      if (findings->each[e].found) r.value_um -= f->x[e] * r.column[e];
    sum += row->weight * r.value_um * r.value_um;
    weight += row->weight;
  }
  return sqrt(sum / weight);
}

/* An effect beside a rival that shows is found only if it shows beside all of them, and leads those
 * that are as smooth: else it is their name for something else. */
static void judge_beside_rivals(const width_fit *f, size_t effects, fg_width_findings *findings) {
  double variance[FG_WIDTH_EFFECTS_MAX + RIVALS], smooth = 1, any = 1;
  size_t groups = find_variances(f, variance);
  for (size_t r = 0; r < RIVALS; r++) {
    double p_value = find_p(f, effects + r, variance[effects + r], groups);
    any = fmin(any, p_value);
    if (r < SMOOTH_RIVALS) smooth = fmin(smooth, p_value);
  }
  if (!(RIVALS * any < CHANCE)) return;
  for (size_t e = 0; e < effects; e++) {
    fg_width_effect *one = &findings->each[e];
    if (one->found && find_p(f, e, variance[e], groups) < fmin(CHANCE, smooth)) continue;
    findings->found -= one->found;
    one->found = false;
  }
}

/* The effects keep the sizes that they have without rivals. */
static void face_rivals(width_fit *f, fg_width_findings *findings) {
  size_t effects = f->effects;
  join_rivals(f);
  if (fit_widths(f)) judge_beside_rivals(f, effects, findings);
  f->effects = effects;
  for (size_t e = 0; e < effects; e++)
    f->x[e] = findings->each[e].effect.coefficient_um[0];
}

static fg_status search_widths(fg_context *ctx, width_fit *f, fg_width_findings *findings) {
  double variance[FG_WIDTH_EFFECTS_MAX + RIVALS];
  bool solved = fit_widths(f);
  for (int round = 0; solved && round < OUTLIER_ROUNDS; round++) {
    FG_TRY(drop_outliers(ctx, f));
    solved = fit_widths(f);
  }
  size_t groups = solved ? find_variances(f, variance) : 0;
  if (groups < GROUPS_MIN) return FG_OK;
  for (size_t e = 0; e < f->effects; e++) {
    assess_width_effect(f, e, variance[e], groups, &findings->each[e]);
    findings->found += findings->each[e].found;
  }
  if (findings->found) face_rivals(f, findings);
  return FG_OK;
}

static void list_effects(const fg_edge_fit *edge_fit, fg_width_findings *findings) {
  memset(findings, 0, sizeof *findings);
  if (edge_fit->discs) return;
  for (const fg_effect *kind = fg_effect_first(); kind; kind = fg_effect_next(kind)) {
    if (kind->sought != FG_EFFECT_OF_WIDTH || findings->count == FG_WIDTH_EFFECTS_MAX) continue;
    if (fg_effect_is_listed(edge_fit->left_out, kind)) continue;
    findings->each[findings->count++] = (fg_width_effect){
        .effect = {.kind = kind, .columns = 1}, .p_value = 1, .smallest_um = INFINITY};
  }
}

fg_status fg_search_width(fg_context *ctx, const fg_edge_fit *edge_fit, const fg_effect_set *set,
                          const double *stretch_um, fg_width_findings *findings) {
  width_fit *f = NULL;
  double *work = NULL;
  fg_status status = FG_OK;
  list_effects(edge_fit, findings);
  if (!findings->count) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *f, (void **)&f));
  f->edge_fit = edge_fit;
  f->effects = findings->count;
  size_t rows = edge_fit->row_count;
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, sizeof *f->rows, (void **)&f->rows));
  FG_TRY_EXIT(fg_memory_allocate(ctx, edge_fit->view_count, sizeof *f->views, (void **)&f->views));
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, FG_EFFECT_COLUMNS_MAX * sizeof *work, (void **)&work));
  list_rows(f);
  put_effects(f, findings, work);
  find_view_means(f);
  findings->rms_before_um = rms_um(f, findings, false);
  remove_stretch(f, set, stretch_um, work);
  FG_TRY_EXIT(search_widths(ctx, f, findings));
  findings->rms_after_um = rms_um(f, findings, true);
exit:
  if (f) free(f->rows);
  if (f) free(f->views);
  free(f);
  free(work);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect_search/joint_fit.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "effect/columns.h"
#include "rows/scatter.h"

enum {
  REFIT_ROUNDS = 12,
  UNKNOWNS_MAX = FG_EFFECT_SET_MAX * (FG_EFFECT_COLUMNS_MAX + FG_FIELD_SHAPES)
};
/* A coefficient's step that ends the fit, and its largest one, um. */
#define STEP_END_UM 1e-5
#define STEP_MAX_UM 60.0
/* Largest step of a shape: this share of itself, or this length for a place; the fit ends at a
 * hundredth of it. */
#define SHAPE_SHARE 0.02
#define SHAPE_MM    0.5
#define SHAPE_END   100
/* Half the span of a derivative by a shape, of itself; no shape counts as smaller, mm. */
#define DERIVE_SHARE 1e-5
#define SHAPE_MIN    1e-3
/* Rows of scans that only confirm weigh so much: enough to fit their own pose. */
#define HELD_OUT_WEIGHT 1e-6
/* Size of a free curve, um: typical of scanners and foils (reports/loop_scans.md). */
#define CURVE_UM 15.0
/* Damping for unknowns that no row determines: share of a diagonal, and absolute. */
#define DAMP_SHARE 1e-10
#define DAMP       1e-12
/* Rows of less than this share of the largest weight, and rows whose normal is farther from the
 * step's direction, do not determine its place. */
#define ROUGH_WEIGHT 0.1
#define ALONG_MIN    0.3

/* One unknown of the effects: a coefficient, or a shape by its numerical derivative. */
typedef struct unknown {
  size_t effect, index;
  bool shape;
} unknown;

static size_t list_unknowns(const fg_effect_set *set, unknown *list) {
  size_t n = 0;
  for (size_t e = 0; e < set->count; e++) {
    const fg_effect_found *effect = &set->effects[e];
    for (size_t c = 0; c < effect->columns; c++)
      list[n++] = (unknown){e, c, false};
    for (size_t s = 0; s < effect->shapes && !effect->kind->jumps; s++)
      list[n++] = (unknown){e, s, true};
  }
  return n;
}

/* Column of a shape, um of residual per unit of it, by its numerical derivative. */
static void shape_column(const fg_edge_fit *edge_fit, const fg_effect_found *effect, size_t index,
                         double *work, double *to) {
  size_t rows = edge_fit->row_count;
  double shape[FG_FIELD_SHAPES];
  double step = DERIVE_SHARE * fmax(fabs(effect->shape[index]), SHAPE_MIN);
  memset(to, 0, rows * sizeof *to);
  for (int side = -1; side <= 1; side += 2) {
    memcpy(shape, effect->shape, sizeof shape);
    shape[index] += side * step;
    fg_effect_columns(edge_fit, effect->kind, shape, work);
    for (size_t c = 0; c < effect->columns; c++)
      for (size_t i = 0; i < rows; i++)
        to[i] += side * effect->coefficient_um[c] * work[c * rows + i] / (2 * step);
  }
}

/* Columns of the effects' unknowns, um of residual per um or per unit of shape. An effect's
 * coefficients follow one another, and its columns are made once for all of them. */
static void effect_design(const fg_edge_fit *edge_fit, const fg_effect_set *set,
                          const unknown *list, size_t count, double *work, double *design) {
  size_t rows = edge_fit->row_count;
  for (size_t k = 0; k < count; k++) {
    const fg_effect_found *effect = &set->effects[list[k].effect];
    double *to = design + k * rows;
    if (list[k].shape) {
      shape_column(edge_fit, effect, list[k].index, work, to);
      continue;
    }
    if (list[k].index == 0) fg_effect_columns(edge_fit, effect->kind, effect->shape, work);
    memcpy(to, work + list[k].index * rows, rows * sizeof *to);
  }
}

typedef struct refit {
  fg_edge_fit *edge_fit;
  fg_effect_set *set;
  fg_joint_fit_part *parts; /* NULL: not wanted */
  unknown list[UNKNOWNS_MAX];
  size_t unknowns, parameters;
  double *residual, *jacobian, *design, *work; /* per row */
  double *white;                               /* residual, weighted and made independent */
  fg_whitening whitening;
  gsl_matrix *normal;
  gsl_vector *right;
} refit;

static const double *column_of(const refit *r, size_t k) {
  size_t rows = r->edge_fit->row_count;
  return k < r->parameters ? r->jacobian + k * rows : r->design + (k - r->parameters) * rows;
}

/* Rows of scans that only confirm fit their own pose, and nothing else of theirs counts: the weight
 * of unknown a beside those before it. */
static double row_weight(const refit *r, size_t i, size_t a) {
  if (!r->edge_fit->views[r->edge_fit->rows[i].view].held_out) return FG_EDGE_FIT_BLOCK;
  return a < r->parameters ? FG_EDGE_FIT_BLOCK * HELD_OUT_WEIGHT : 0;
}

static void whiten(const refit *r, double *values) {
  for (size_t i = 0; i < r->edge_fit->row_count; i++)
    values[i] *= fg_edge_fit_root_weight(&r->edge_fit->rows[i]);
  fg_whitening_apply(&r->whitening, values);
}

/* Whitens residual and all columns, for generalised least squares. */
static void whiten_all(refit *r) {
  size_t rows = r->edge_fit->row_count;
  memcpy(r->white, r->residual, rows * sizeof *r->white);
  whiten(r, r->white);
  for (size_t k = 0; k < r->parameters; k++)
    whiten(r, r->jacobian + k * rows);
  for (size_t k = 0; k < r->unknowns; k++)
    whiten(r, r->design + k * rows);
}

/* Returns the weight of a normal prior on a curve's coefficients, of this size, beside rows with
 * this noise: noise in smooth functions must not enlarge the coefficients. */
static double hold_of(const fg_edge_fit *edge_fit, const fg_effect_found *effect, bool shape) {
  const fg_scatter *s = &edge_fit->scatter;
  if (shape || effect->kind->hold == 0) return 0;
  double noise = FG_EDGE_FIT_BLOCK * s->row_um * s->row_um * s->integral * s->swell;
  return fmax(effect->kind->hold, noise / (CURVE_UM * CURVE_UM));
}

/* Adds the prior of free curves. They are nearly collinear with the geometry and extend to places
 * without rows: of all curves with the same residual the smallest one is chosen. */
static void hold_free(refit *r, size_t k) {
  const fg_effect_found *effect = &r->set->effects[r->list[k].effect];
  size_t a = r->parameters + k;
  double hold = hold_of(r->edge_fit, effect, r->list[k].shape);
  if (hold == 0) return;
  double held = hold * effect->coefficient_um[r->list[k].index];
  gsl_matrix_set(r->normal, a, a, gsl_matrix_get(r->normal, a, a) + hold);
  gsl_vector_set(r->right, a, gsl_vector_get(r->right, a) - held);
}

/* Variance of the rows, um² per unit of weight, for correlated noise. */
static double row_variance(const refit *r) {
  double sum = 0, rows = 0;
  for (size_t i = 0; i < r->edge_fit->row_count; i++) {
    if (r->edge_fit->views[r->edge_fit->rows[i].view].held_out) continue;
    sum += FG_EDGE_FIT_BLOCK * r->white[i] * r->white[i];
    rows++;
  }
  double dof = fmax(rows - (double)(r->parameters + r->unknowns), 1);
  double integral = fg_edge_fit_integral(r->edge_fit, NULL, r->edge_fit->row_count, r->white);
  return sum / dof * fmax(r->edge_fit->scatter.swell, integral);
}

/* Adds the gauges' radii, as data with their errors: a scale follows from them, and none of them
 * bends what rows show. */
static void add_gauges(refit *r) {
  const fg_edge_fit *edge_fit = r->edge_fit;
  double weight = row_variance(r) / (edge_fit->gauge_um * edge_fit->gauge_um) * 1e6; /* per mm² */
  for (size_t p = 0, at = 0; p < edge_fit->part_count; p++) {
    const fg_edge_fit_part *part = &edge_fit->parts[p];
    if (part->known_radius_mm > 0 && !part->radius_known) {
      *gsl_matrix_ptr(r->normal, at, at) += weight;
      *gsl_vector_ptr(r->right, at) += weight * (part->overall_radius_mm - part->known_radius_mm);
    }
    at += 1 + 3 * part->bump_count;
  }
}

/* Adds a row to the lower half of the normal equations; it depends on few numbers of the geometry,
 * and on all effects. */
static void add_row(refit *r, size_t i) {
  size_t own[FG_EDGE_FIT_ROW_PARAMETERS + UNKNOWNS_MAX];
  double value[FG_EDGE_FIT_ROW_PARAMETERS + UNKNOWNS_MAX];
  size_t count = fg_edge_fit_row_parameters(r->edge_fit, i, own), geometry = count;
  for (size_t k = 0; k < r->unknowns; k++)
    own[count++] = r->parameters + k;
  for (size_t a = 0; a < count; a++) /* geometry in mm */
    value[a] = column_of(r, own[a])[i] * (a < geometry ? 1000 : 1);
  for (size_t a = 0; a < count; a++) {
    double *line = gsl_matrix_ptr(r->normal, own[a], 0);
    double weight = row_weight(r, i, own[a]) * value[a];
    *gsl_vector_ptr(r->right, own[a]) += weight * r->white[i];
    for (size_t b = 0; b <= a; b++)
      line[own[b]] += weight * value[b];
  }
}

static void mirror(gsl_matrix *m) {
  for (size_t a = 0; a < m->size1; a++)
    for (size_t b = 0; b < a; b++)
      gsl_matrix_set(m, b, a, gsl_matrix_get(m, a, b));
}

/* Assembles the normal equations of geometry and effects, with the prior of free curves. */
static void assemble(refit *r) {
  size_t n = r->parameters + r->unknowns;
  gsl_matrix_set_zero(r->normal);
  gsl_vector_set_zero(r->right);
  for (size_t i = 0; i < r->edge_fit->row_count; i++)
    add_row(r, i);
  mirror(r->normal);
  for (size_t k = 0; k < r->unknowns; k++)
    hold_free(r, k);
  if (r->edge_fit->gauge_um > 0) add_gauges(r);
  for (size_t a = 0; a < n; a++) {
    double d = gsl_matrix_get(r->normal, a, a);
    gsl_matrix_set(r->normal, a, a, d * (1 + DAMP_SHARE) + DAMP);
  }
}

static fg_status solve_equations(fg_context *ctx, refit *r) {
  assemble(r);
  if (gsl_linalg_cholesky_decomp1(r->normal) || gsl_linalg_cholesky_svx(r->normal, r->right))
    return fg_fail(ctx, FG_ERR_NUMERIC, "geometry and effects cannot be told apart");
  return FG_OK;
}

/* Moves coefficients and shapes; returns the largest move in um of residual. */
static double move_effects(refit *r) {
  double largest = 0;
  for (size_t k = 0; k < r->unknowns; k++) {
    fg_effect_found *effect = &r->set->effects[r->list[k].effect];
    double step = gsl_vector_get(r->right, r->parameters + k);
    if (r->list[k].shape) {
      /* A period moves by its share; the middle of a lens, which may lie at 0, by its size. */
      double max = SHAPE_SHARE * fabs(effect->shape[r->list[k].index]) +
                   (effect->columns == 1 ? SHAPE_MM : 0);
      step = fmax(-max, fmin(max, step));
      effect->shape[r->list[k].index] += step;
      largest = fmax(largest, SHAPE_END * fabs(step) / max * STEP_END_UM);
    } else {
      step = fmax(-STEP_MAX_UM, fmin(STEP_MAX_UM, step));
      effect->coefficient_um[r->list[k].index] += step;
      largest = fmax(largest, fabs(step));
    }
  }
  return largest;
}

/* Returns the u of a step's place: between the nearest rows it may lie anywhere, with the sd of a
 * uniform distribution. Rows of small weight do not count. */
static double place_u(const fg_edge_fit *edge_fit, const fg_effect_found *step) {
  double above = -INFINITY, below = INFINITY, max = 0;
  for (size_t i = 0; i < edge_fit->row_count; i++)
    max = fmax(max, edge_fit->rows[i].weight);
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    const fg_edge_fit_row *row = &edge_fit->rows[i];
    double at = fg_point_along(row->ideal, step->kind->axis);
    bool rough =
        row->weight > 0 && row->weight < ROUGH_WEIGHT * max; /* 0: left out for the step itself */
    if (rough || fabs(fg_point_along(row->normal, step->kind->axis)) < ALONG_MIN) continue;
    if (at <= step->shape[0])
      above = fmax(above, at);
    else
      below = fmin(below, at);
  }
  return isfinite(below - above) ? (below - above) / sqrt(12) : 0;
}

/* Sensitivity of the least-squares geometry to the effects' coefficients. */
typedef struct sensitivity {
  gsl_matrix *alone;  /* normal equations of the geometry, then their inverse */
  gsl_matrix *direct; /* by every unknown of the scanner: -(N_gg)^-1 N_gs; 0 for the part's */
  gsl_matrix *spread; /* `direct` times the inverse of all normal equations */
} sensitivity;

/* Covariance of two numbers of the geometry by the uncertainty of the scanner's effects. With the
 * normal equations N and the prior H of the free curves: noise, V D (N + H)^-1 N (N + H)^-1 D';
 * bias by the prior, for coefficients of size t: D (N + H)^-1 H t² H (N + H)^-1 D'. */
static double effects_covariance(const refit *r, double variance, const double *size,
                                 const sensitivity *by, size_t a, size_t b) {
  double sum = 0;
  for (size_t k = 0; k < r->unknowns; k++) {
    double hold = hold_of(r->edge_fit, &r->set->effects[r->list[k].effect], r->list[k].shape);
    double t = hold * size[r->list[k].effect];
    double spread = gsl_matrix_get(by->spread, a, k);
    sum += variance * spread * gsl_matrix_get(by->direct, b, k);
    sum += spread * gsl_matrix_get(by->spread, b, k) * (t * t - variance * hold);
  }
  return sum;
}

static void find_effects_covariance(refit *r, double variance, const sensitivity *by) {
  double size[FG_EFFECT_SET_MAX] = {0};
  for (size_t e = 0; e < r->set->count; e++) {
    const fg_effect_found *effect = &r->set->effects[e];
    for (size_t c = 0; c < effect->columns; c++)
      size[e] = fmax(size[e], fabs(effect->coefficient_um[c]));
  }
  for (size_t p = 0, at = 0; p < r->edge_fit->part_count; p++) {
    size_t bumps = r->edge_fit->parts[p].bump_count;
    r->parts[p].overall = fmax(0, effects_covariance(r, variance, size, by, at, at));
    for (size_t b = 0; b < bumps; b++) {
      size_t index[3] = {at + 1 + 3 * b, at + 3 + 3 * b, at}; /* X, R, R0 */
      for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
          r->parts[p].bumps[b][i][k] =
              effects_covariance(r, variance, size, by, index[i], index[k]);
    }
    at += 1 + 3 * bumps;
  }
}

static bool open_sensitivity(const refit *r, sensitivity *by) {
  by->alone = gsl_matrix_alloc(r->parameters, r->parameters);
  by->direct = gsl_matrix_calloc(r->parameters, r->unknowns);
  by->spread = gsl_matrix_calloc(r->parameters, r->unknowns);
  return by->alone && by->direct && by->spread;
}

static void close_sensitivity(sensitivity *by) {
  gsl_matrix_free(by->alone);
  gsl_matrix_free(by->direct);
  gsl_matrix_free(by->spread);
}

/* Takes the geometry's block of the normal equations, and that beside the scanner's effects. */
static void take_blocks(const refit *r, sensitivity *by) {
  for (size_t a = 0; a < r->parameters; a++) {
    for (size_t b = 0; b < r->parameters; b++)
      gsl_matrix_set(by->alone, a, b, gsl_matrix_get(r->normal, a, b));
    for (size_t k = 0; k < r->unknowns; k++)
      if (r->set->effects[r->list[k].effect].kind->glass)
        gsl_matrix_set(by->spread, a, k, gsl_matrix_get(r->normal, a, r->parameters + k));
  }
}

/* Turns the blocks into sensitivities; `r->normal` is inverted. */
static bool solve_sensitivity(const refit *r, sensitivity *by) {
  if (gsl_linalg_cholesky_decomp1(by->alone) || gsl_linalg_cholesky_invert(by->alone)) return false;
  gsl_matrix_const_view whole =
      gsl_matrix_const_submatrix(r->normal, r->parameters, r->parameters, r->unknowns, r->unknowns);
  gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, -1, by->alone, by->spread, 0, by->direct);
  gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, by->direct, &whole.matrix, 0, by->spread);
  return true;
}

/* Finds the uncertainties of the effects, and of the geometry by them. */
static void find_uncertainties(refit *r, sensitivity *by) {
  double variance = row_variance(r);
  assemble(r);
  take_blocks(r, by);
  if (gsl_linalg_cholesky_decomp1(r->normal) || gsl_linalg_cholesky_invert(r->normal)) return;
  for (size_t e = 0; e < r->set->count; e++)
    if (r->set->effects[e].kind->jumps)
      r->set->effects[e].u_shape[0] = place_u(r->edge_fit, &r->set->effects[e]);
  for (size_t k = 0; k < r->unknowns; k++) {
    fg_effect_found *effect = &r->set->effects[r->list[k].effect];
    double u = sqrt(variance * gsl_matrix_get(r->normal, r->parameters + k, r->parameters + k));
    if (r->list[k].shape)
      effect->u_shape[r->list[k].index] = u;
    else
      effect->u_coefficient_um[r->list[k].index] = u;
  }
  if (r->parts && solve_sensitivity(r, by)) find_effects_covariance(r, variance, by);
}

/* Fits the geometry under the set's present correction; computes the residual in um and, unless
 * NULL, the Jacobian. */
static fg_status fit_geometry(fg_context *ctx, fg_edge_fit *edge_fit, const fg_effect_set *set,
                              double *residual_um, double *jacobian) {
  fg_field_list fields;
  double *shift = NULL;
  fg_effect_set_fields(edge_fit, set, &fields);
  fg_status status = FG_OK;
  for (int twice = 0; twice < 2 && status == FG_OK; twice++) {
    /* Repeated, because directions in the part's frame depend on the geometry, and the geometry on
     * the shift. */
    free(shift);
    shift = NULL;
    status = fg_effect_set_shift(ctx, edge_fit, set, &shift);
    fg_edge_fit_correction correction = {&fields, shift};
    if (status == FG_OK) status = fg_edge_fit_fit(ctx, edge_fit, &correction);
    if (status == FG_OK) fg_edge_fit_residual(edge_fit, &correction, residual_um, jacobian);
  }
  for (size_t i = 0; i < edge_fit->row_count; i++)
    residual_um[i] *= 1000;
  free(shift);
  return status;
}

fg_status fg_joint_fit_geometry(fg_context *ctx, fg_edge_fit *edge_fit, const fg_effect_set *set,
                                double *residual_um) {
  return fit_geometry(ctx, edge_fit, set, residual_um, NULL);
}

static fg_status evaluate(fg_context *ctx, refit *r) {
  return fit_geometry(ctx, r->edge_fit, r->set, r->residual, r->jacobian);
}

static fg_status allocate_refit(fg_context *ctx, refit *r) {
  size_t rows = r->edge_fit->row_count, n = r->parameters + r->unknowns;
  FG_TRY(fg_whitening_open(ctx, r->edge_fit, &r->whitening));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof(double), (void **)&r->white));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof(double), (void **)&r->residual));
  FG_TRY(fg_memory_allocate(ctx, rows * r->parameters, sizeof(double), (void **)&r->jacobian));
  FG_TRY(fg_memory_allocate(ctx, rows * (r->unknowns + 1), sizeof(double), (void **)&r->design));
  FG_TRY(fg_memory_allocate(ctx, rows * FG_EFFECT_COLUMNS_MAX, sizeof(double), (void **)&r->work));
  r->normal = gsl_matrix_alloc(n, n);
  r->right = gsl_vector_alloc(n);
  if (!r->normal || !r->right) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu unknowns", n);
  return FG_OK;
}

static void release(refit *r) {
  fg_whitening_close(&r->whitening);
  free(r->white);
  free(r->residual);
  free(r->jacobian);
  free(r->design);
  free(r->work);
  gsl_matrix_free(r->normal);
  gsl_vector_free(r->right);
}

static fg_status run_joint_fit(fg_context *ctx, fg_edge_fit *edge_fit, fg_effect_set *set,
                               double *residual_um, fg_joint_fit_part *parts) {
  refit r = {.edge_fit = edge_fit, .set = set, .parts = parts};
  sensitivity by = {.alone = NULL};
  fg_status status = FG_OK;
  fg_numerics_start();
  FG_TRY(fg_edge_fit_fit(ctx, edge_fit, NULL));
  r.parameters = edge_fit->parameters;
  r.unknowns = list_unknowns(set, r.list);
  FG_TRY_EXIT(allocate_refit(ctx, &r));
  for (int round = 0; round < REFIT_ROUNDS; round++) {
    FG_TRY_EXIT(evaluate(ctx, &r));
    if (!r.unknowns) break;
    effect_design(edge_fit, set, r.list, r.unknowns, r.work, r.design);
    whiten_all(&r);
    FG_TRY_EXIT(solve_equations(ctx, &r));
    if (move_effects(&r) < STEP_END_UM) break;
  }
  if (r.unknowns) {
    FG_TRY_EXIT(evaluate(ctx, &r));
    effect_design(edge_fit, set, r.list, r.unknowns, r.work, r.design);
    whiten_all(&r);
    if (open_sensitivity(&r, &by))
      find_uncertainties(&r, &by);
    else
      status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu numbers", r.parameters);
  }
  if (residual_um) memcpy(residual_um, r.residual, edge_fit->row_count * sizeof *residual_um);
exit:
  close_sensitivity(&by);
  release(&r);
  return status;
}

fg_status fg_joint_fit(fg_context *ctx, fg_edge_fit *edge_fit, fg_effect_set *set,
                       double *residual_um) {
  return run_joint_fit(ctx, edge_fit, set, residual_um, NULL);
}

static fg_status open_parts(fg_context *ctx, const fg_edge_fit *edge_fit,
                            fg_joint_fit_result *result) {
  FG_TRY(fg_memory_allocate(ctx, edge_fit->part_count, sizeof *result->parts,
                            (void **)&result->parts));
  for (size_t p = 0; p < edge_fit->part_count; p++)
    FG_TRY(fg_memory_allocate(ctx, edge_fit->parts[p].bump_count, sizeof *result->parts[p].bumps,
                              (void **)&result->parts[p].bumps));
  return FG_OK;
}

fg_status fg_joint_fit_open(fg_context *ctx, fg_edge_fit *edge_fit, const fg_effect_set *set,
                            fg_joint_fit_result *result) {
  *result = (fg_joint_fit_result){.edge_fit = edge_fit, .set = *set};
  fg_status status = FG_OK;
  FG_TRY_EXIT(open_parts(ctx, edge_fit, result));
  FG_TRY_EXIT(run_joint_fit(ctx, edge_fit, &result->set, NULL, result->parts));
  fg_effect_set_fields(edge_fit, &result->set, &result->fields);
exit:
  if (status != FG_OK) fg_joint_fit_close(result);
  return status;
}

void fg_joint_fit_close(fg_joint_fit_result *result) {
  for (size_t p = 0; result->parts && p < result->edge_fit->part_count; p++)
    free(result->parts[p].bumps);
  free(result->parts);
  *result = (fg_joint_fit_result){.edge_fit = NULL};
}

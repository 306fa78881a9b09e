/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geometry and effects fitted together, against a dense least squares of the same rows. */
#include <gsl/gsl_multifit.h>
#include <math.h>
#include <stdlib.h>

#include "effect/columns.h"
#include "effect_search/joint_fit.h"
#include "support/random.h"
#include "support/synthetic_foil.h"
#include "support/test.h"

#define NOISE_UM 0.03

static const double shear_um = 14, period_mm = 3.1, sine_um = 4, cosine_um = -3;

static fg_edge_fit open_points(fg_measurement *m) {
  fg_context ctx = {0};
  fg_edge_fit edge_fit;
  *m = (fg_measurement){.design = synthetic_design(), .dpi = {4800, 4800}, .foil_count = 1};
  m->nominal = synthetic_nominal(&m->design);
  m->file.width_px = m->file.height_px = 9000;
  m->foils = calloc(1, sizeof *m->foils);
  m->foils[0] = synthetic_foil(&m->design, &m->nominal);
  fg_edge_fit_view view = {.foil = &m->foils[0], .measurement = m};
  assert_ok(&ctx, fg_edge_fit_build(&ctx, &view, 1, &edge_fit));
  assert_ok(&ctx, fg_edge_fit_fit(&ctx, &edge_fit, NULL));
  return edge_fit;
}

static void add_effect(fg_effect_set *set, const char *id, double shape) {
  const fg_effect *kind = fg_effect_find(id);
  assert_non_null(kind);
  set->effects[set->count++] = (fg_effect_found){
      .kind = kind, .columns = kind->columns, .shapes = kind->shapes, .shape = {shape}};
}

/* Puts every row where a scanner with these effects, and noise, would have seen its circle. */
static void disturb(fg_edge_fit *edge_fit, const fg_field_list *fields) {
  uint64_t seed = 3;
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    fg_edge_fit_row *row = &edge_fit->rows[i];
    fg_point seen = row->ideal;
    for (int k = 0; k < 5; k++) { /* true = seen + d(seen) */
      fg_point at[FG_EDGE_FIT_PLACES], d = {0, 0};
      fg_edge_fit_places(row, seen, at);
      for (int p = 0; p < FG_EDGE_FIT_PLACES; p++) {
        fg_point one = fg_field_at(fields, at[p]);
        d.x += one.x / FG_EDGE_FIT_PLACES;
        d.y += one.y / FG_EDGE_FIT_PLACES;
      }
      seen = (fg_point){row->ideal.x - d.x, row->ideal.y - d.y};
    }
    double noise = 1e-3 * NOISE_UM * random_gaussian(&seed);
    row->at = (fg_point){seen.x + noise * row->normal.x, seen.y + noise * row->normal.y};
  }
}

/* Step that is left to go, and covariance for noise of 1, from all columns at once. */
static void solve_densely(fg_edge_fit *edge_fit, const fg_effect_set *set, gsl_vector *step,
                          gsl_matrix *covariance, double *square) {
  fg_context ctx = {0};
  size_t rows = edge_fit->row_count, geometry = edge_fit->parameters, at = geometry;
  double *residual = calloc(rows, sizeof(double)), *shift = NULL;
  double *jacobian = calloc(rows * geometry, sizeof(double));
  double *columns = calloc(rows * FG_FIELD_COLUMNS, sizeof(double));
  gsl_matrix *design = gsl_matrix_alloc(rows, step->size);
  gsl_vector *y = gsl_vector_alloc(rows), *weight = gsl_vector_alloc(rows);
  fg_field_list fields;
  fg_effect_set_fields(edge_fit, set, &fields);
  assert_ok(&ctx, fg_effect_set_shift(&ctx, edge_fit, set, &shift));
  fg_edge_fit_residual(edge_fit, &(fg_edge_fit_correction){&fields, shift}, residual, jacobian);
  for (size_t i = 0; i < rows; i++) {
    gsl_vector_set(y, i, 1000 * residual[i]);
    gsl_vector_set(weight, i, edge_fit->rows[i].weight);
    for (size_t k = 0; k < geometry; k++)
      gsl_matrix_set(design, i, k, 1000 * jacobian[k * rows + i]);
  }
  for (size_t e = 0; e < set->count; e++) {
    const fg_effect_found *effect = &set->effects[e];
    fg_effect_columns(edge_fit, effect->kind, effect->shape, columns);
    for (size_t c = 0; c < effect->columns; c++, at++)
      for (size_t i = 0; i < rows; i++)
        gsl_matrix_set(design, i, at, columns[c * rows + i]);
    for (size_t s = 0; s < effect->shapes; s++, at++) {
      double h = 1e-6 * effect->shape[s];
      for (int side = -1; side <= 1; side += 2) {
        double shape[FG_FIELD_SHAPES] = {effect->shape[0] + side * h};
        fg_effect_columns(edge_fit, effect->kind, shape, columns);
        for (size_t i = 0; i < rows; i++) {
          double sum = side < 0 ? 0 : gsl_matrix_get(design, i, at);
          for (size_t c = 0; c < effect->columns; c++)
            sum += side * effect->coefficient_um[c] * columns[c * rows + i] / (2 * h);
          gsl_matrix_set(design, i, at, sum);
        }
      }
    }
  }
  gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(rows, step->size);
  assert_int_equal(gsl_multifit_wlinear(design, weight, y, step, covariance, square, work), 0);
  gsl_multifit_linear_free(work);
  gsl_matrix_free(design);
  gsl_vector_free(y);
  gsl_vector_free(weight);
  free(residual);
  free(jacobian);
  free(columns);
  free(shift);
}

static void joint_fit_agrees_with_dense_least_squares(void **state) {
  (void)state;
  fg_context ctx = {0};
  fg_measurement m;
  fg_edge_fit edge_fit = open_points(&m);
  fg_effect_set truth = {0}, set = {0};
  fg_field_list fields;
  add_effect(&truth, "scan.shear", 0);
  add_effect(&truth, "scan.carriage_ripple", period_mm);
  truth.effects[0].coefficient_um[0] = shear_um;
  truth.effects[1].coefficient_um[0] = sine_um;
  truth.effects[1].coefficient_um[1] = cosine_um;
  fg_effect_set_fields(&edge_fit, &truth, &fields);
  disturb(&edge_fit, &fields);
  add_effect(&set, "scan.shear", 0);
  add_effect(&set, "scan.carriage_ripple", 1.003 * period_mm);
  assert_ok(&ctx, fg_joint_fit(&ctx, &edge_fit, &set, NULL));
  const fg_effect_found *shear = &set.effects[0], *ripple = &set.effects[1];
  assert_near(shear->coefficient_um[0], shear_um, 4 * shear->u_coefficient_um[0]);
  assert_near(ripple->coefficient_um[0], sine_um, 4 * ripple->u_coefficient_um[0]);
  assert_near(ripple->coefficient_um[1], cosine_um, 4 * ripple->u_coefficient_um[1]);
  assert_near(ripple->shape[0], period_mm, 4 * ripple->u_shape[0]);

  size_t unknowns = edge_fit.parameters + 4;
  gsl_vector *step = gsl_vector_alloc(unknowns);
  gsl_matrix *covariance = gsl_matrix_alloc(unknowns, unknowns);
  double square;
  solve_densely(&edge_fit, &set, step, covariance, &square);
  for (size_t k = 0; k < 4; k++) /* um; the period in mm */
    assert_near(gsl_vector_get(step, edge_fit.parameters + k), 0, 2e-4);
  /* White noise: the correlation's integral is 1, or what chance makes of it. */
  double variance = square / (double)(edge_fit.row_count - unknowns);
  const double u[4] = {shear->u_coefficient_um[0], ripple->u_coefficient_um[0],
                       ripple->u_coefficient_um[1], ripple->u_shape[0]};
  double ratio = 0;
  for (size_t k = 0; k < 4; k++) {
    size_t at = edge_fit.parameters + k;
    double dense = sqrt(variance * gsl_matrix_get(covariance, at, at));
    if (k == 0) ratio = u[0] / dense;
    assert_near(u[k] / dense, ratio, 1e-3);
  }
  assert_true(ratio > 0.999 && ratio < 1.3);
  gsl_vector_free(step);
  gsl_matrix_free(covariance);
  fg_edge_fit_free(&edge_fit);
  synthetic_free(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(joint_fit_agrees_with_dense_least_squares)};
  return cmocka_run_group_tests_name("joint fit", tests, NULL, NULL);
}

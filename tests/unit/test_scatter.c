/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Noise that neighbouring rows share: found by restricted likelihood, and taken out as dense
 * generalised least squares takes it out. */
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>

#include "rows/scatter.h"
#include "support/foil_rows.h"
#include "support/test.h"

static bool same_arc(const fg_edge_fit *edge_fit, size_t a, size_t b) {
  const fg_edge_fit_row *p = &edge_fit->rows[a], *q = &edge_fit->rows[b];
  return p->view == q->view && p->group == q->group;
}

static double rho(fg_scatter_model model, double d) {
  return exp(model == FG_SCATTER_GAUSSIAN ? -d * d : -d);
}

/* Correlation of rows a and b as rows/scatter.h says it. */
static double correlation(const fg_edge_fit *edge_fit, const fg_scatter *s, size_t a, size_t b) {
  if (a == b) return 1;
  if (!same_arc(edge_fit, a, b)) return 0;
  double d = fabs(edge_fit->rows[a].s_mm - edge_fit->rows[b].s_mm) / s->range_mm;
  return s->share * rho(s->model, d);
}

/* Lower root of the correlation of one arc's rows [from, to). */
static gsl_matrix *root_of(const fg_edge_fit *edge_fit, const fg_scatter *s, size_t from,
                           size_t to) {
  gsl_matrix *root = gsl_matrix_calloc(to - from, to - from);
  for (size_t a = from; a < to; a++)
    for (size_t b = from; b < to; b++)
      gsl_matrix_set(root, a - from, b - from, correlation(edge_fit, s, a, b));
  assert_int_equal(gsl_linalg_cholesky_decomp1(root), 0);
  return root;
}

static size_t end_of_arc(const fg_edge_fit *edge_fit, size_t from) {
  size_t to = from;
  while (to < edge_fit->row_count && same_arc(edge_fit, from, to))
    to++;
  return to;
}

/* Rows with noise of this kind and a standard deviation. */
static void put_scatter(foil_rows *f, const fg_scatter *s, double sd_um, uint64_t seed) {
  for (size_t from = 0, to; from < f->edge_fit.row_count; from = to) {
    to = end_of_arc(&f->edge_fit, from);
    gsl_matrix *root = root_of(&f->edge_fit, s, from, to);
    double *white = calloc(to - from, sizeof *white);
    for (size_t i = 0; i < to - from; i++)
      white[i] = random_gaussian(&seed);
    for (size_t i = 0; i < to - from; i++) {
      f->residual_um[from + i] = 0;
      for (size_t k = 0; k <= i; k++)
        f->residual_um[from + i] += sd_um * gsl_matrix_get(root, i, k) * white[k];
    }
    free(white);
    gsl_matrix_free(root);
  }
}

/* v' C^-1 v over all arcs. */
static double dense_square(const fg_edge_fit *edge_fit, const fg_scatter *s, const double *v) {
  double sum = 0;
  for (size_t from = 0, to; from < edge_fit->row_count; from = to) {
    to = end_of_arc(edge_fit, from);
    gsl_matrix *root = root_of(edge_fit, s, from, to);
    gsl_vector *x = gsl_vector_alloc(to - from);
    for (size_t i = from; i < to; i++)
      gsl_vector_set(x, i - from, v[i]);
    gsl_linalg_cholesky_svx(root, x);
    for (size_t i = from; i < to; i++)
      sum += v[i] * gsl_vector_get(x, i - from);
    gsl_vector_free(x);
    gsl_matrix_free(root);
  }
  return sum;
}

static const fg_scatter kinds[] = {
    {.share = 0.6, .range_mm = 0.05, .model = FG_SCATTER_GAUSSIAN, .integral = 2.5},
    {.share = 0.8, .range_mm = 0.1, .model = FG_SCATTER_GAUSSIAN, .integral = 4},
    {.share = 0.7, .range_mm = 0.06, .model = FG_SCATTER_EXPONENTIAL, .integral = 3},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static void whitened_squares_are_those_of_dense_least_squares(void **state) {
  (void)state;
  fg_context ctx = {0};
  for (size_t k = 0; k < KINDS; k++) {
    foil_rows f;
    fg_whitening whitening;
    foil_rows_open(&f);
    foil_rows_put_noise(&f, 1);
    f.edge_fit.scatter = kinds[k];
    double square = 0, dense = dense_square(&f.edge_fit, &kinds[k], f.residual_um);
    assert_ok(&ctx, fg_whitening_open(&ctx, &f.edge_fit, &whitening));
    fg_whitening_apply(&whitening, f.residual_um);
    for (size_t i = 0; i < f.edge_fit.row_count; i++)
      square += f.residual_um[i] * f.residual_um[i];
    fg_whitening_close(&whitening);
    assert_near(square, kinds[k].integral * dense, 2e-3 * square);
    foil_rows_close(&f);
  }
}

/* A row without weight is not there: what stands in it tells nothing. */
static void a_row_without_weight_tells_nothing(void **state) {
  (void)state;
  fg_context ctx = {0};
  for (size_t k = 0; k < KINDS; k++) {
    foil_rows f;
    fg_whitening whitening;
    double square[2] = {0, 0};
    foil_rows_open(&f);
    f.edge_fit.scatter = kinds[k];
    f.edge_fit.rows[20].weight = 0;
    assert_ok(&ctx, fg_whitening_open(&ctx, &f.edge_fit, &whitening));
    for (int large = 0; large < 2; large++) {
      foil_rows_put_noise(&f, 1);
      f.residual_um[20] = large ? 1e6 : 0;
      fg_whitening_apply(&whitening, f.residual_um);
      for (size_t i = 0; i < f.edge_fit.row_count; i++)
        square[large] += f.residual_um[i] * f.residual_um[i];
    }
    assert_true(square[0] == square[1]);
    fg_whitening_close(&whitening);
    foil_rows_close(&f);
  }
}

/* Noise at long waves, um² per row: what smooth effects are held against. */
static double long_waves(const fg_scatter *s) {
  return s->row_um * s->row_um * s->integral;
}

static double true_long_waves(const fg_edge_fit *edge_fit, const fg_scatter *s, double sd_um) {
  double spacing = 0, pairs = 0, sum = 1;
  for (size_t i = 1; i < edge_fit->row_count; i++) {
    if (!same_arc(edge_fit, i - 1, i)) continue;
    spacing += fabs(edge_fit->rows[i].s_mm - edge_fit->rows[i - 1].s_mm);
    pairs++;
  }
  spacing /= pairs;
  for (int lag = 1; lag < 1000; lag++)
    sum += 2 * s->share * rho(s->model, lag * spacing / s->range_mm);
  return sd_um * sd_um * sum;
}

static void noise_at_long_waves_is_found_from_short_ones(void **state) {
  (void)state;
  enum { SEEDS = 12 };
  const double sd_um = 0.7;
  fg_context ctx = {0};
  for (size_t k = 0; k < KINDS; k++) {
    double mean = 0;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
      foil_rows f;
      foil_rows_open(&f);
      put_scatter(&f, &kinds[k], sd_um, seed);
      /* A smooth curve along an arc is no noise. */
      double none = 0, much = 40;
      foil_rows_add_effect(&f, fg_effect_find("scan.shear"), &none, &much, 1);
      assert_ok(&ctx, fg_edge_fit_find_scatter(&ctx, &f.edge_fit, f.residual_um));
      mean +=
          long_waves(&f.edge_fit.scatter) / true_long_waves(&f.edge_fit, &kinds[k], sd_um) / SEEDS;
      foil_rows_close(&f);
    }
    assert_near(mean, 1, kinds[k].model == FG_SCATTER_GAUSSIAN ? 0.1 : 0.4);
  }
}

static void white_noise_stays_white(void **state) {
  (void)state;
  fg_context ctx = {0};
  foil_rows f;
  foil_rows_open(&f);
  foil_rows_put_noise(&f, 0.3);
  assert_ok(&ctx, fg_edge_fit_find_scatter(&ctx, &f.edge_fit, f.residual_um));
  assert_true(f.edge_fit.scatter.share == 0);
  assert_near(f.edge_fit.scatter.integral, 1, 1e-12);
  assert_near(f.edge_fit.scatter.row_um, 0.3, 0.02);
  foil_rows_close(&f);
}

/* Waves that every bump has are no noise, even when they are too short for polynomials along one
 * arc. */
static void waves_common_to_all_bumps_are_no_noise(void **state) {
  (void)state;
  fg_context ctx = {0};
  foil_rows f;
  foil_rows_open(&f);
  foil_rows_put_noise(&f, 0.3);
  double none = 0, waves[16] = {0};
  waves[11] = waves[12] = 1;
  foil_rows_add_effect(&f, fg_effect_find("free.bump.phi"), &none, waves, 16);
  assert_ok(&ctx, fg_edge_fit_find_scatter(&ctx, &f.edge_fit, f.residual_um));
  assert_true(f.edge_fit.scatter.share == 0);
  assert_near(f.edge_fit.scatter.row_um, 0.3, 0.02);
  foil_rows_close(&f);
}

/* Lost rows within an arc are no scatter of the edge. */
static void a_step_within_an_arc_is_no_noise(void **state) {
  (void)state;
  fg_context ctx = {0};
  foil_rows f;
  foil_rows_open(&f);
  foil_rows_put_noise(&f, 0.05);
  const fg_edge_fit_row *in_arc = &f.edge_fit.rows[f.edge_fit.row_count / 3];
  double much = 8, shape = in_arc->at.y;
  foil_rows_add_effect(&f, fg_effect_find("scan.row_step"), &shape, &much, 1);
  assert_ok(&ctx, fg_edge_fit_find_scatter(&ctx, &f.edge_fit, f.residual_um));
  assert_near(long_waves(&f.edge_fit.scatter), 0.05 * 0.05, 0.6 * 0.05 * 0.05);
  foil_rows_close(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(whitened_squares_are_those_of_dense_least_squares),
      cmocka_unit_test(a_row_without_weight_tells_nothing),
      cmocka_unit_test(noise_at_long_waves_is_found_from_short_ones),
      cmocka_unit_test(white_noise_stays_white),
      cmocka_unit_test(waves_common_to_all_bumps_are_no_noise),
      cmocka_unit_test(a_step_within_an_arc_is_no_noise),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whitening against the covariance that it claims to undo, and least squares against it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_linalg.h>

#include "effect/table_effects.h"
#include "support/random.h"
#include "support/test.h"
#include "table_loop/assess.h"
#include "table_loop/engine.h"

enum { ROWS = 12, GROUPS = 3 };

static size_t group[ROWS] = {0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2, 2};
static double residual[ROWS], jacobian[2 * ROWS];

static fg_loop_problem make_problem(void) {
  uint64_t seed = 5;
  for (size_t i = 0; i < ROWS; i++) {
    residual[i] = random_gaussian(&seed);
    jacobian[i] = 1;
    jacobian[ROWS + i] = random_gaussian(&seed);
  }
  return (fg_loop_problem){.rows = ROWS,
                           .parameters = 2,
                           .residual = residual,
                           .jacobian = jacobian,
                           .group = group,
                           .groups = GROUPS,
                           .group_level = true,
                           .series = group,
                           .correlated = true};
}

static double covariance(fg_engine_noise noise, size_t i, size_t k) {
  if (group[i] != group[k]) return 0;
  return pow(noise.rho, fabs((double)i - (double)k)) + noise.lambda;
}

static const fg_engine_noise noises[] = {{.rho = 0},
                                         {.rho = 0.6},
                                         {.lambda = 2},
                                         {.rho = 0.3, .lambda = 0.7},
                                         {.rho = 0.85, .lambda = 10}};

/* W C W' = 1, column by column: W applied to C, then to the transpose. */
static void whitening_undoes_the_covariance(void **state) {
  (void)state;
  fg_loop_problem problem = make_problem();
  fg_engine_training training;
  assert_ok(&test_context,
            fg_engine_training_build(&test_context, &problem, NULL, NULL, &training));
  for (size_t m = 0; m < sizeof noises / sizeof *noises; m++) {
    in_row("noises[%zu]", m);
    double c[ROWS][ROWS], column[ROWS];
    for (size_t k = 0; k < ROWS; k++) {
      for (size_t i = 0; i < ROWS; i++)
        column[i] = covariance(noises[m], i, k);
      fg_engine_whiten(&training, noises[m], column);
      for (size_t i = 0; i < ROWS; i++)
        c[i][k] = column[i];
    }
    for (size_t i = 0; i < ROWS; i++) {
      fg_engine_whiten(&training, noises[m], c[i]);
      for (size_t k = 0; k < ROWS; k++)
        assert_near(c[i][k], i == k, 1e-12);
    }
  }
  fg_engine_training_free(&training);
}

static void colouring_undoes_whitening(void **state) {
  (void)state;
  fg_loop_problem problem = make_problem();
  fg_engine_training training;
  double y[ROWS];
  assert_ok(&test_context,
            fg_engine_training_build(&test_context, &problem, NULL, NULL, &training));
  for (size_t m = 0; m < sizeof noises / sizeof *noises; m++) {
    in_row("noises[%zu]", m);
    memcpy(y, residual, sizeof y);
    fg_engine_whiten(&training, noises[m], y);
    fg_engine_colour(&training, noises[m], y);
    for (size_t i = 0; i < ROWS; i++)
      assert_near(y[i], residual[i], 1e-12);
  }
  fg_engine_training_free(&training);
}

static void the_determinant_is_the_covariance_s(void **state) {
  (void)state;
  fg_loop_problem problem = make_problem();
  fg_engine_training training;
  assert_ok(&test_context,
            fg_engine_training_build(&test_context, &problem, NULL, NULL, &training));
  for (size_t m = 0; m < sizeof noises / sizeof *noises; m++) {
    in_row("noises[%zu]", m);
    gsl_matrix *c = gsl_matrix_alloc(ROWS, ROWS);
    double log_det = 0;
    for (size_t i = 0; i < ROWS; i++)
      for (size_t k = 0; k < ROWS; k++)
        gsl_matrix_set(c, i, k, covariance(noises[m], i, k));
    assert_int_equal(gsl_linalg_cholesky_decomp1(c), 0);
    for (size_t i = 0; i < ROWS; i++)
      log_det += 2 * log(gsl_matrix_get(c, i, i));
    assert_near(fg_engine_log_det(&training, noises[m]), log_det, 1e-10);
    gsl_matrix_free(c);
  }
  fg_engine_training_free(&training);
}

/* At the solution the whitened residual is orthogonal to the whitened columns. */
static void least_squares_solves_the_normal_equations(void **state) {
  (void)state;
  fg_loop_problem problem = make_problem();
  fg_engine_training training;
  fg_engine_fit fit;
  assert_ok(&test_context,
            fg_engine_training_build(&test_context, &problem, NULL, NULL, &training));
  for (size_t m = 0; m < sizeof noises / sizeof *noises; m++) {
    in_row("noises[%zu]", m);
    double r[ROWS], x[ROWS], sum = 0;
    assert_ok(&test_context, fg_engine_least_squares(&test_context, &training, noises[m], &fit));
    for (size_t i = 0; i < ROWS; i++)
      r[i] = residual[i] - fit.beta[0] - fit.beta[1] * jacobian[ROWS + i];
    fg_engine_whiten(&training, noises[m], r);
    for (size_t k = 0; k < 2; k++) {
      double dot = 0;
      memcpy(x, jacobian + k * ROWS, sizeof x);
      fg_engine_whiten(&training, noises[m], x);
      for (size_t i = 0; i < ROWS; i++)
        dot += x[i] * r[i];
      assert_near(dot, 0, 1e-10);
    }
    for (size_t i = 0; i < ROWS; i++)
      sum += r[i] * r[i];
    assert_near(fit.rss, sum, 1e-10);
    fg_engine_fit_free(&fit);
  }
  fg_engine_training_free(&training);
}

static void deviates_and_ratios_agree(void **state) {
  (void)state;
  for (double k = 1; k <= 4; k++)
    for (double nu = 5; nu <= 500; nu *= 10)
      for (double f = 0.5; f < 50; f *= 2) {
        double z = fg_engine_deviate(1 / (1 + f * k / nu), k, nu + k);
        assert_near(fg_engine_deviate_to_f(z, k, nu) / f, 1, 1e-4);
      }
}

enum { LEVELS = 6, EACH = 4 };

/* 1 - r² of the groups' means against a column that is constant in groups. */
static double left_of_means(const double *y, const double *of_group) {
  double mean[LEVELS] = {0}, xx = 0, xy = 0, yy = 0, x0 = 0, y0 = 0;
  for (size_t i = 0; i < LEVELS * EACH; i++)
    mean[i / EACH] += y[i] / EACH;
  for (size_t g = 0; g < LEVELS; g++) {
    x0 += of_group[g] / LEVELS;
    y0 += mean[g] / LEVELS;
  }
  for (size_t g = 0; g < LEVELS; g++) {
    xx += (of_group[g] - x0) * (of_group[g] - x0);
    xy += (of_group[g] - x0) * (mean[g] - y0);
    yy += (mean[g] - y0) * (mean[g] - y0);
  }
  return 1 - xy * xy / (xx * yy);
}

/* However many rows a group has: its F ratio is that of the means, with the groups' freedom. */
static void effects_constant_within_groups_are_tested_between_groups(void **state) {
  (void)state;
  double y[LEVELS * EACH], one[LEVELS * EACH], value[LEVELS * EACH], of_group[LEVELS];
  size_t in_group[LEVELS * EACH];
  uint64_t seed = 11;
  for (size_t i = 0; i < LEVELS * EACH; i++) {
    if (i % EACH == 0) of_group[i / EACH] = random_gaussian(&seed);
    value[i] = of_group[i / EACH];
    y[i] = 2 * value[i] + random_gaussian(&seed);
    one[i] = 1;
    in_group[i] = i / EACH;
  }
  fg_loop_coordinate column = {
      .name = "x", .value = value, .distinct = LEVELS, .low = -3, .high = 3};
  fg_loop_problem problem = {.rows = LEVELS * EACH,
                             .parameters = 1,
                             .residual = y,
                             .jacobian = one,
                             .group = in_group,
                             .groups = LEVELS,
                             .group_level = true,
                             .series = in_group,
                             .coordinate = &column,
                             .coordinates = 1};
  const fg_loop_candidate trend = {.effect = fg_loop_table_effects()};
  fg_engine_training training;
  fg_score_workspace workspace = {0};
  fg_engine_score score;
  size_t null;
  assert_ok(&test_context,
            fg_engine_training_build(&test_context, &problem, NULL, NULL, &training));
  assert_ok(&test_context,
            fg_score_workspace_build(&test_context, &training, &trend, 1, &workspace));
  fg_score_workspace_score_data(&workspace, &score, &null);
  assert_near(score.own, left_of_means(y, of_group), 1e-9);
  assert_near(score.z, fg_engine_deviate(score.own, 1, LEVELS - 1), 1e-9);
  fg_score_workspace_free(&workspace);
  fg_engine_training_free(&training);
}

/* Rows of normal errors get the noise's covariance. */
static void coloured_rows_have_the_covariance(void **state) {
  enum { DRAWS = 4000 };
  (void)state;
  fg_loop_problem problem = make_problem();
  fg_engine_training training;
  uint64_t seed = 3;
  assert_ok(&test_context,
            fg_engine_training_build(&test_context, &problem, NULL, NULL, &training));
  for (size_t m = 0; m < sizeof noises / sizeof *noises; m++) {
    in_row("noises[%zu]", m);
    double y[ROWS], sum[ROWS][ROWS] = {{0}}, own = 1 + noises[m].lambda;
    for (size_t b = 0; b < DRAWS; b++) {
      for (size_t i = 0; i < ROWS; i++)
        y[i] = random_gaussian(&seed);
      fg_engine_colour_rows(&training, noises[m], &seed, y);
      for (size_t i = 0; i < ROWS; i++)
        for (size_t k = 0; k < ROWS; k++)
          sum[i][k] += y[i] * y[k] / DRAWS;
    }
    for (size_t i = 0; i < ROWS; i++)
      for (size_t k = 0; k < ROWS; k++)
        assert_near(sum[i][k], covariance(noises[m], i, k), 5 * own * sqrt(2.0 / DRAWS));
  }
  fg_engine_training_free(&training);
}

enum { FOILS = 14, BUMPS = 9, LOT = FOILS * BUMPS };

/* P-value of the best exchange, over exchanges alone, in a lot whose bumps scatter by Student's t
 * of 3 dof around the level of their foil. */
static double exchange_p_of_clean_lot(uint64_t *seed) {
  double y[LOT], one[LOT], level = 0, share[FG_LOOP_KINDS];
  size_t foil[LOT];
  for (size_t i = 0; i < LOT; i++) {
    double squares = 0;
    if (i % BUMPS == 0) level = random_gaussian(seed);
    for (int k = 0; k < 3; k++)
      squares += pow(random_gaussian(seed), 2);
    y[i] = 0.01 * (level + random_gaussian(seed) / sqrt(squares));
    one[i] = 1;
    foil[i] = i / BUMPS;
  }
  fg_loop_problem problem = {.rows = LOT,
                             .parameters = 1,
                             .residual = y,
                             .response = y,
                             .jacobian = one,
                             .group = foil,
                             .groups = FOILS,
                             .group_level = true,
                             .series = foil,
                             .exchangeable = true};
  fg_loop_kind_shares((const bool[FG_LOOP_KINDS]){false}, share);
  const fg_engine_null null = {399, 1, 0.01, share};
  fg_engine_training training;
  fg_score_workspace workspace = {0};
  fg_engine_judgement judgement = {0};
  assert_ok(&test_context,
            fg_engine_training_build(&test_context, &problem, NULL, NULL, &training));
  assert_ok(&test_context, fg_score_workspace_build(&test_context, &training, NULL, 0, &workspace));
  assert_ok(&test_context, fg_engine_judge(&test_context, &workspace, NULL, 0, &null, &judgement));
  double p = fg_engine_family_kind_p(&judgement.family, FG_LOOP_KIND_EXCHANGES,
                                     judgement.z[judgement.candidates]);
  fg_engine_judgement_free(&judgement);
  fg_score_workspace_free(&workspace);
  fg_engine_training_free(&training);
  return p;
}

/* A tail beside group levels is as far out in the draws as in the data: were it shrunk or spread
 * over its group, nearly a third of the tables would have such a p-value. */
static void heavy_tails_in_groups_are_no_exchange(void **state) {
  enum { TABLES = 60 };
  (void)state;
  uint64_t seed = 9;
  size_t small = 0;
  for (size_t t = 0; t < TABLES; t++)
    small += exchange_p_of_clean_lot(&seed) < 0.05;
  assert_true(small <= 9);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(whitening_undoes_the_covariance),
      cmocka_unit_test(colouring_undoes_whitening),
      cmocka_unit_test(the_determinant_is_the_covariance_s),
      cmocka_unit_test(least_squares_solves_the_normal_equations),
      cmocka_unit_test(deviates_and_ratios_agree),
      cmocka_unit_test(effects_constant_within_groups_are_tested_between_groups),
      cmocka_unit_test(coloured_rows_have_the_covariance),
      cmocka_unit_test(heavy_tails_in_groups_are_no_exchange),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

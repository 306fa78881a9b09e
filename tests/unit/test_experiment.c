/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The optimum in a region against dense search and closed forms; weights; predictions. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/experiment.h"
#include "support/random.h"
#include "support/test.h"

/* An arbitrary quadratic in two factors. */
static fg_surface random_surface(uint64_t *state) {
  fg_surface s = {.factors = 2};
  for (int i = 0; i < 2; i++) {
    s.linear[i] = random_uniform(state) * 4 - 2;
    s.quadratic[i][i] = random_uniform(state) * 4 - 2;
  }
  s.quadratic[0][1] = s.quadratic[1][0] = random_uniform(state) * 2 - 1;
  return s;
}

static fg_region unit_region(void) {
  fg_region r = {.factors = 2, .radius = 1.2, .planes = 1};
  for (int i = 0; i < 2; i++) {
    r.low[i] = -1;
    r.high[i] = 1;
  }
  r.normal[0][0] = 1;
  r.normal[0][1] = 0.5;
  r.limit[0] = 0.4;
  return r;
}

/* No point of a dense grid in the region is better than the optimum, which lies in it. */
static void optimum_beats_a_grid(void **state) {
  fg_context ctx = {0};
  uint64_t seed = 20;
  fg_region r = unit_region();
  (void)state;
  for (int trial = 0; trial < 60; trial++) {
    fg_surface s = random_surface(&seed);
    double sign = trial % 2 ? -1 : 1, x[FG_SURFACE_FACTORS] = {0}, best = INFINITY;
    assert_ok(&ctx, fg_surface_optimum_region(
                        &ctx, &s, trial % 2 ? FG_GOAL_HIGHEST : FG_GOAL_LOWEST, 0, &r, x));
    assert_true(fg_region_contains(&r, x, 1e-7));
    for (int i = 0; i <= 400; i++)
      for (int k = 0; k <= 400; k++) {
        const double grid[FG_SURFACE_FACTORS] = {-1 + i / 200.0, -1 + k / 200.0};
        if (fg_region_contains(&r, grid, 0)) best = fmin(best, sign * fg_surface_value(&s, grid));
      }
    double found = sign * fg_surface_value(&s, x);
    if (!(found <= best + 1e-9))
      fail_msg("trial %d: %.12g, the grid has %.12g", trial, found, best);
    assert_true(found > best - 0.05);
  }
}

/* In the box alone the exact search over faces gives the same. */
static void optimum_of_a_box_is_exact(void **state) {
  fg_context ctx = {0};
  uint64_t seed = 7;
  fg_region r = unit_region();
  (void)state;
  r.radius = INFINITY;
  r.planes = 0;
  for (int trial = 0; trial < 50; trial++) {
    fg_surface s = random_surface(&seed);
    double x[FG_SURFACE_FACTORS] = {0}, exact[FG_SURFACE_FACTORS] = {0};
    assert_ok(&ctx, fg_surface_optimum_region(&ctx, &s, FG_GOAL_LOWEST, 0, &r, x));
    assert_ok(&ctx, fg_surface_optimum_box(&ctx, &s, false, r.low, r.high, exact));
    assert_true(fabs(fg_surface_value(&s, x) - fg_surface_value(&s, exact)) < 1e-10);
  }
}

/* A target that the surface takes is met; the region keeps its limits. */
static void target_is_met(void **state) {
  fg_context ctx = {0};
  fg_region r = unit_region();
  fg_surface s = {.factors = 2, .constant = 1, .linear = {1, 0.2}};
  double x[FG_SURFACE_FACTORS] = {0};
  (void)state;
  assert_ok(&ctx, fg_surface_optimum_region(&ctx, &s, FG_GOAL_TARGET, 0.7, &r, x));
  assert_true(fabs(fg_surface_value(&s, x) - 0.7) < 1e-6);
  assert_true(fg_region_contains(&r, x, 1e-7));
}

/* The corner between ball and half-space: the projection of a far point, by the closed form. */
static void projection_is_the_nearest_point(void **state) {
  fg_context ctx = {0};
  fg_region r = unit_region();
  double x[FG_SURFACE_FACTORS] = {5, 5}, best = INFINITY;
  (void)state;
  assert_ok(&ctx, fg_region_project(&ctx, &r, x));
  double found = hypot(x[0] - 5, x[1] - 5);
  for (int i = 0; i <= 2000; i++)
    for (int k = 0; k <= 2000; k++) {
      const double grid[FG_SURFACE_FACTORS] = {-1 + i / 1000.0, -1 + k / 1000.0};
      if (fg_region_contains(&r, grid, 0)) best = fmin(best, hypot(grid[0] - 5, grid[1] - 5));
    }
  assert_true(fg_region_contains(&r, x, 1e-8));
  assert_true(found <= best + 1e-8 && found > best - 5e-3);
  r.limit[0] = -9;
  assert_status(&ctx, fg_region_project(&ctx, &r, x), FG_ERR_USAGE);
}

enum { RUNS = 12 };

static void make_table(fg_table *table, double far, double far_u) {
  fg_context ctx = {0};
  uint64_t seed = 3;
  double a[RUNS], y[RUNS], u[RUNS];
  *table = (fg_table){0};
  for (int i = 0; i < RUNS; i++) {
    a[i] = i % 2 ? 1 : -1;
    y[i] = 5 + 2 * a[i] + 0.1 * (random_uniform(&seed) - 0.5);
    u[i] = 0.02;
  }
  y[RUNS - 1] += far;
  u[RUNS - 1] = far_u;
  assert_ok(&ctx, fg_table_add_numbers(&ctx, table, "a", a, RUNS));
  assert_ok(&ctx, fg_table_add_numbers(&ctx, table, "y", y, RUNS));
  assert_ok(&ctx, fg_table_add_numbers(&ctx, table, "u", u, RUNS));
}

static void analyse(const fg_table *table, fg_experiment *e) {
  const fg_experiment_options options = {.response = "y", .formula = "a", .uncertainty = "u"};
  fg_context ctx = {0};
  if (fg_experiment_analyse(&ctx, table, &options, e) != FG_OK) fail_msg("%s", ctx.message);
}

/* A run that is known to be far less certain does not spoil the others. */
static void uncertain_runs_weigh_less(void **state) {
  fg_table table;
  fg_experiment e;
  (void)state;
  make_table(&table, 50, 80);
  analyse(&table, &e);
  assert_non_null(e.measurement.weight);
  assert_true(fabs(e.regression.coefficient[1].estimate - 2) < 0.05);
  assert_true(e.regression.residual_sd < 0.1);
  fg_experiment_free(&e);
  fg_table_free(&table);
}

/* The scatter of the process is told by the precise runs, and their number decides how well. */
static void dof_is_that_of_the_precise_runs(void **state) {
  enum { PRECISE = 4 };
  fg_context ctx = {0};
  fg_table table = {0};
  fg_experiment e;
  uint64_t seed = 5;
  double a[RUNS], y[RUNS], u[RUNS];
  (void)state;
  for (int i = 0; i < RUNS; i++) {
    u[i] = i < PRECISE ? 1e-4 : 100;
    a[i] = i % 2 ? 1 : -1;
    y[i] = 5 + 2 * a[i] + (i < PRECISE ? 0.1 : 100) * random_gaussian(&seed);
  }
  assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "a", a, RUNS));
  assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "y", y, RUNS));
  assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "u", u, RUNS));
  analyse(&table, &e);
  assert_non_null(e.measurement.weight);
  assert_true(fabs(e.effect[1].dof - (PRECISE - 2)) < 0.01);
  assert_true(e.effect[1].low < 2 && 2 < e.effect[1].high);
  fg_experiment_free(&e);
  fg_table_free(&table);
}

/* Uncertainties over a factor of 100 about the scatter: Student's with the residual dof hold 90 %.
 */
static void intervals_of_unequal_runs_hold(void **state) {
  enum { TABLES = 300 };
  size_t held = 0;
  uint64_t seed = 9;
  (void)state;
  for (size_t t = 0; t < TABLES; t++) {
    fg_context ctx = {0};
    fg_table table = {0};
    fg_experiment e;
    double a[RUNS], y[RUNS], u[RUNS];
    for (int i = 0; i < RUNS; i++) {
      u[i] = pow(100, random_uniform(&seed) - 0.5);
      a[i] = i % 2 ? 1 : -1;
      y[i] = 5 + 2 * a[i] + sqrt(1 + u[i] * u[i]) * random_gaussian(&seed);
    }
    assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "a", a, RUNS));
    assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "y", y, RUNS));
    assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "u", u, RUNS));
    analyse(&table, &e);
    held += e.effect[0].low <= 5 && 5 <= e.effect[0].high;
    held += e.effect[1].low <= 2 && 2 <= e.effect[1].high;
    fg_experiment_free(&e);
    fg_table_free(&table);
  }
  assert_true((double)held > 0.94 * 2 * TABLES);
}

/* All centre runs are of a day whose runs are higher: no curvature. */
static void blocks_are_no_curvature(void **state) {
  static const char *const runs =
      "a,b,day,y\n-1,-1,Mon,49.1\n-1,-1,Mon,48.7\n-1,1,Mon,47.2\n-1,1,Mon,46.9\n1,-1,Mon,53.2\n"
      "1,-1,Tue,56.8\n1,1,Tue,55.1\n1,1,Tue,54.8\n0,0,Tue,54.1\n0,0,Tue,53.8\n0,0,Tue,54.3\n";
  const fg_experiment_options options = {.response = "y", .formula = "a + b", .block = "day"};
  const fg_experiment_options without = {.response = "y", .formula = "a + b"};
  fg_context ctx = {0};
  fg_table table = {0};
  fg_experiment e;
  size_t told = 0;
  (void)state;
  assert_ok(&ctx, fg_table_parse(&ctx, "runs", runs, strlen(runs), &table));
  assert_ok(&ctx, fg_experiment_analyse(&ctx, &table, &options, &e));
  assert_false(e.has_curvature);
  for (size_t i = 0; i < e.notes; i++)
    told += strstr(e.note[i], "the centre runs are not compared") != NULL;
  assert_int_equal(told, 1);
  fg_experiment_free(&e);
  assert_ok(&ctx, fg_experiment_analyse(&ctx, &table, &without, &e));
  assert_true(e.has_curvature);
  fg_experiment_free(&e);
  fg_table_free(&table);
}

/* With one uncertainty for all, u of a coefficient is u / sqrt(n), and nothing is weighed. */
static void measurement_is_propagated(void **state) {
  fg_table table;
  fg_experiment e;
  (void)state;
  make_table(&table, 0, 0.02);
  analyse(&table, &e);
  assert_null(e.measurement.weight);
  assert_true(fabs(e.effect[1].u_measurement - 0.02 / sqrt(RUNS)) < 1e-12);
  fg_experiment_free(&e);
  fg_table_free(&table);
}

/* Without strata or blocks the prediction is regression.h's. */
static void predictions_agree(void **state) {
  fg_context ctx = {0};
  fg_table table;
  fg_experiment e;
  fg_prediction ours, theirs;
  const double setting[] = {0.3}, row[] = {1, 0.3};
  (void)state;
  make_table(&table, 0, 0.02);
  analyse(&table, &e);
  assert_ok(&ctx, fg_experiment_predict(&ctx, &e, setting, &ours));
  assert_ok(&ctx, fg_regression_predict(&ctx, &e.regression, row, &theirs));
  assert_true(fabs(ours.mean - theirs.mean) < 1e-12);
  assert_true(fabs(ours.low - theirs.low) < 1e-10 && fabs(ours.run_high - theirs.run_high) < 1e-10);
  fg_experiment_free(&e);
  fg_table_free(&table);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(optimum_beats_a_grid),
      cmocka_unit_test(optimum_of_a_box_is_exact),
      cmocka_unit_test(target_is_met),
      cmocka_unit_test(projection_is_the_nearest_point),
      cmocka_unit_test(uncertain_runs_weigh_less),
      cmocka_unit_test(dof_is_that_of_the_precise_runs),
      cmocka_unit_test(intervals_of_unequal_runs_hold),
      cmocka_unit_test(blocks_are_no_curvature),
      cmocka_unit_test(measurement_is_propagated),
      cmocka_unit_test(predictions_agree),
  };
  return cmocka_run_group_tests_name("experiment", tests, NULL, NULL);
}

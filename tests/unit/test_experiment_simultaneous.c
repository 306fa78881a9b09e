/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Intervals at a setting that the same runs chose. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "foilgauge/distribution.h"
#include "foilgauge/experiment.h"
#include "support/random.h"
#include "support/test.h"

enum { COMPOSITE = 13, EXPERIMENTS = 60, LINE = 8 };

static void analyse(const char *text, const char *formula, fg_goal goal, fg_experiment *e) {
  fg_context ctx = {0};
  fg_table table = {0};
  const fg_coding coding[] = {{.name = "a", .low = {-1, 0}, .high = {1, 0}},
                              {.name = "b", .low = {-1, 0}, .high = {1, 0}}};
  const fg_experiment_options options = {.response = "y",
                                         .formula = formula,
                                         .coding = coding,
                                         .codings = strchr(formula, 'b') ? 2 : 1,
                                         .goal = goal,
                                         .target = 9.5};
  assert_ok(&ctx, fg_table_parse(&ctx, "runs", text, strlen(text), &table));
  assert_ok(&ctx, fg_experiment_analyse(&ctx, &table, &options, e));
  fg_table_free(&table);
}

/* Of a straight line between two settings with the same number of runs each, the errors of the
 * predictions fill a quarter of the circle of directions (Wynn and Bloomfield 1971). */
static double probability_of_line(double factor, double dof) {
  enum { STEPS = 2000 };
  double sum = 0, whole = 1 - fg_distribution_f_upper(factor * factor / 2, 2, dof);
  for (int i = 0; i < STEPS; i++) {
    double angle = acos(-1) / 4 * (i + 0.5) / STEPS;
    sum += 1 - fg_distribution_f_upper(pow(factor / cos(angle), 2) / 2, 2, dof);
  }
  return (whole + sum / STEPS) / 2;
}

static void factor_of_a_line_is_exact(void **state) {
  fg_experiment e;
  (void)state;
  analyse("a,y\n-1,1\n-1,1.2\n-1,0.9\n-1,1.1\n1,3\n1,3.3\n1,2.9\n1,3.1\n", "a", FG_GOAL_LOWEST, &e);
  const fg_prediction *p = &e.best.optimum.prediction;
  assert_true(p->dof == LINE - 2);
  assert_true(fabs(probability_of_line(p->coverage_factor, p->dof) - 0.95) < 0.002);
  assert_true(fabs(p->high - p->mean - p->coverage_factor * p->standard_error) < 1e-9);
  fg_experiment_free(&e);
}

static void write_flat(uint64_t *seed, char *text, size_t size) {
  static const double run[COMPOSITE][2] = {{-1, -1},     {1, -1},     {-1, 1},      {1, 1},
                                           {-1.4142, 0}, {1.4142, 0}, {0, -1.4142}, {0, 1.4142}};
  size_t used = (size_t)snprintf(text, size, "a,b,y\n");
  for (size_t i = 0; i < COMPOSITE; i++)
    used += (size_t)snprintf(text + used, size - used, "%g,%g,%.9f\n", run[i][0], run[i][1],
                             10 + random_gaussian(seed));
}

/* The worst case: all structure of the surface is scatter, and its lowest point is chosen. */
static void intervals_hold_at_what_the_runs_chose(fg_goal goal, double student_at_most) {
  size_t student = 0, held = 0, run = 0;
  uint64_t seed = 7;
  for (size_t i = 0; i < EXPERIMENTS; i++) {
    char text[1024];
    fg_experiment e;
    write_flat(&seed, text, sizeof text);
    analyse(text, "a*b + a^2 + b^2", goal, &e);
    const fg_prediction *p = &e.best.optimum.prediction;
    double half = fg_distribution_t_quantile(0.975, p->dof) * p->standard_error;
    double one = 10 + random_gaussian(&seed);
    student += fabs(p->mean - 10) <= half;
    held += p->low <= 10 && 10 <= p->high;
    run += p->run_low <= one && one <= p->run_high;
    fg_experiment_free(&e);
  }
  assert_true((double)student < student_at_most * EXPERIMENTS);
  assert_true((double)held >= 0.93 * EXPERIMENTS);
  assert_true((double)run >= 0.93 * EXPERIMENTS);
}

static void intervals_hold_at_the_lowest_point(void **state) {
  (void)state;
  intervals_hold_at_what_the_runs_chose(FG_GOAL_LOWEST, 0.9);
}

static void intervals_hold_at_the_highest_point(void **state) {
  (void)state;
  intervals_hold_at_what_the_runs_chose(FG_GOAL_HIGHEST, 0.9);
}

static void intervals_hold_at_a_target(void **state) {
  (void)state;
  intervals_hold_at_what_the_runs_chose(FG_GOAL_TARGET, 1.01);
}

/* A setting of words alone: as many directions as levels. */
static void best_level_has_a_simultaneous_interval(void **state) {
  fg_experiment e;
  (void)state;
  analyse("a,die,y\n-1,A,1\n1,A,3.1\n-1,B,2\n1,B,4.2\n-1,A,1.1\n1,A,3\n-1,B,2.2\n1,B,4.1\n",
          "a + die", FG_GOAL_LOWEST, &e);
  const fg_prediction *p = &e.best.optimum.prediction;
  double one = fg_distribution_t_quantile(0.975, p->dof),
         all = sqrt(3 * fg_distribution_f_quantile(0.95, 3, p->dof));
  assert_true(p->coverage_factor > one && p->coverage_factor < all);
  fg_experiment_free(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(factor_of_a_line_is_exact),
      cmocka_unit_test(intervals_hold_at_the_lowest_point),
      cmocka_unit_test(intervals_hold_at_the_highest_point),
      cmocka_unit_test(intervals_hold_at_a_target),
      cmocka_unit_test(best_level_has_a_simultaneous_interval),
  };
  return cmocka_run_group_tests_name("experiment_simultaneous", tests, NULL, NULL);
}

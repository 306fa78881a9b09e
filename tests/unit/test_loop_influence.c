/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of high leverage: told with the parameter they move, and judged by the others' prediction.
 */
#include <math.h>

#include <gsl/gsl_cdf.h>

#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"
#include "support/random.h"
#include "support/test.h"
#include "table_loop/row_tails.h"

enum { ROWS = 25 };

typedef struct outcome {
  fg_context ctx;
  fg_table table;
  fg_loop_table_problem problem;
  fg_loop_result result;
} outcome;

static void search(const double *x, const double *y, outcome *out) {
  const fg_loop_options options = {.effects = fg_loop_table_effects()};
  const fg_loop_table_spec spec = {.response = "y", .model = "distance"};
  *out = (outcome){0};
  assert_ok(&out->ctx, fg_table_add_numbers(&out->ctx, &out->table, "distance", x, ROWS));
  assert_ok(&out->ctx, fg_table_add_numbers(&out->ctx, &out->table, "y", y, ROWS));
  assert_ok(&out->ctx, fg_loop_table_problem_build(&out->ctx, &out->table, &spec, &out->problem));
  assert_ok(&out->ctx, fg_loop_run(&out->ctx, &out->problem.problem, &options, &out->result));
}

static void clear_outcome(outcome *out) {
  fg_loop_result_free(&out->result);
  fg_loop_table_problem_free(&out->problem);
  fg_table_free(&out->table);
}

static double slope(const double *x, const double *y, size_t rows) {
  double mean[2] = {0}, product = 0, square = 0;
  for (size_t i = 0; i < rows; i++) {
    mean[0] += x[i] / (double)rows;
    mean[1] += y[i] / (double)rows;
  }
  for (size_t i = 0; i < rows; i++) {
    product += (x[i] - mean[0]) * (y[i] - mean[1]);
    square += (x[i] - mean[0]) * (x[i] - mean[0]);
  }
  return product / square;
}

/* In units of 1e6 and an origin far away: the engine scales and moves both. */
static void a_row_that_leads_the_slope_is_told_with_the_slope_without_it(void **state) {
  double x[ROWS], y[ROWS];
  uint64_t seed = 3;
  outcome out;
  (void)state;
  for (size_t i = 0; i < ROWS; i++) {
    x[i] = 100 * random_uniform(&seed);
    y[i] = 5e7 + 1e6 * (0.01 * x[i] + random_gaussian(&seed));
  }
  x[ROWS - 1] = 400;
  y[ROWS - 1] = 5e7 + 1e6 * (4 + 3);
  search(x, y, &out);
  assert_int_equal(out.result.influences, 1);
  const fg_loop_influence *influence = &out.result.influence[0];
  assert_int_equal(influence->row, ROWS - 1);
  assert_true(influence->leverage > 0.5 && influence->cook > 1 && influence->dfbetas > 1);
  double without = slope(x, y, ROWS - 1);
  assert_true(fabs(influence->without - without) < 1e-6 * fabs(without));
  assert_true(fabs(influence->without + influence->change - slope(x, y, ROWS)) < 1e-3);
  clear_outcome(&out);
}

static void rows_without_leverage_lead_nothing(void **state) {
  double x[ROWS], y[ROWS];
  uint64_t seed = 5;
  outcome out;
  (void)state;
  for (size_t i = 0; i < ROWS; i++) {
    x[i] = (double)i;
    y[i] = random_gaussian(&seed);
  }
  search(x, y, &out);
  assert_int_equal(out.result.influences, 0);
  clear_outcome(&out);
}

/* The prediction's own error is near normal, so a large difference is less likely to be a tail. */
static void leverage_makes_a_tail_less_likely(void **state) {
  const double heavy[FG_ENGINE_TAILS] = {0, 1}, normal[FG_ENGINE_TAILS] = {0, 0, 0, 0, 1};
  (void)state;
  double plain = fg_engine_tails_beyond(heavy, 5, 1, 20);
  assert_true(fabs(plain - 2 * gsl_cdf_tdist_Q(5 * sqrt(2), 4)) < 1e-12);
  assert_true(fg_engine_tails_beyond(heavy, 5, 0.5, 20) < plain / 2);
  assert_true(fg_engine_tails_beyond(normal, 5, 0.5, 20) ==
              fg_engine_tails_beyond(normal, 5, 1, 20));
  assert_true(fg_engine_tails_equivalent(5, 1) == 5);
  double as_rare = fg_engine_tails_equivalent(-5, 0.5);
  assert_true(as_rare < -6 && as_rare > -10);
}

/* sqrt(own) t + sqrt(1 - own) z, drawn. */
static void the_probability_beyond_is_that_of_draws(void **state) {
  enum { DRAWS = 200000 };
  const double heavy[FG_ENGINE_TAILS] = {0, 1};
  double own = 0.6, size = 3, error;
  uint64_t seed = 9;
  size_t beyond = 0;
  (void)state;
  for (size_t i = 0; i < DRAWS; i++) {
    fg_engine_tails_draw(heavy, 1, &seed, &error);
    double x = sqrt(own) * error + sqrt(1 - own) * random_gaussian(&seed);
    beyond += fabs(x) > size;
  }
  double p = fg_engine_tails_beyond(heavy, size, own, 20), count = DRAWS * p;
  assert_true(fabs((double)beyond - count) < 4 * sqrt(count));
}

/* Of heights and weights of people, one pair in each other's column: the row does not fit the
 * others, and does where they are put right. */
static void two_values_in_each_other_s_column_are_an_exchange(void **state) {
  double weight[ROWS], height[ROWS], said[ROWS];
  const fg_loop_options options = {.effects = fg_loop_table_effects()};
  const fg_loop_table_spec spec = {.response = "said", .model = "weight"};
  uint64_t seed = 8;
  outcome out = {0};
  (void)state;
  for (size_t i = 0; i < ROWS; i++) {
    weight[i] = 45 + 120 * random_uniform(&seed);
    height[i] = 100 + 0.5 * weight[i] + 10 * random_gaussian(&seed);
    said[i] = weight[i] + 2 * random_gaussian(&seed);
  }
  weight[7] = 152;
  height[7] = 110;
  said[7] = 111;
  assert_ok(&out.ctx, fg_table_add_numbers(&out.ctx, &out.table, "weight", weight, ROWS));
  assert_ok(&out.ctx, fg_table_add_numbers(&out.ctx, &out.table, "height", height, ROWS));
  assert_ok(&out.ctx, fg_table_add_numbers(&out.ctx, &out.table, "said", said, ROWS));
  assert_ok(&out.ctx, fg_loop_table_problem_build(&out.ctx, &out.table, &spec, &out.problem));
  assert_ok(&out.ctx, fg_loop_run(&out.ctx, &out.problem.problem, &options, &out.result));
  assert_int_equal(out.result.claims, 1);
  assert_string_equal(out.result.claim[0].name, "table.exchanged_columns(weight, height, 8)");
  clear_outcome(&out);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_row_that_leads_the_slope_is_told_with_the_slope_without_it),
      cmocka_unit_test(rows_without_leverage_lead_nothing),
      cmocka_unit_test(two_values_in_each_other_s_column_are_an_exchange),
      cmocka_unit_test(leverage_makes_a_tail_less_likely),
      cmocka_unit_test(the_probability_beyond_is_that_of_draws),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

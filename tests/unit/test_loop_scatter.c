/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop on tables beyond the mean: neighbours that are alike, a scatter that changes, wrong rows
 * that hide each other; and the order of the rows. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"
#include "support/random.h"
#include "support/test.h"
#include "table_loop/spread_likelihood.h"
#include "table_loop/tails.h"

enum { ROWS = 120 };

typedef struct series {
  double reading[ROWS], pressure[ROWS], y[ROWS];
} series;

typedef struct outcome {
  fg_context ctx;
  fg_table table;
  fg_loop_table_problem problem;
  fg_loop_result result;
} outcome;

static void make_noise(uint64_t seed, series *data) {
  for (size_t i = 0; i < ROWS; i++) {
    data->reading[i] = (double)i + 1;
    data->pressure[i] = 3 + 4 * random_uniform(&seed);
    data->y[i] = random_gaussian(&seed);
  }
}

static void search(const series *data, uint64_t seed, outcome *out) {
  const fg_loop_options options = {.effects = fg_loop_table_effects(), .seed = seed};
  const fg_loop_table_spec spec = {.response = "y", .model = "1", .seed = seed};
  *out = (outcome){0};
  fg_table *table = &out->table;
  assert_ok(&out->ctx, fg_table_add_numbers(&out->ctx, table, "reading", data->reading, ROWS));
  assert_ok(&out->ctx, fg_table_add_numbers(&out->ctx, table, "pressure", data->pressure, ROWS));
  assert_ok(&out->ctx, fg_table_add_numbers(&out->ctx, table, "y", data->y, ROWS));
  assert_ok(&out->ctx, fg_loop_table_problem_build(&out->ctx, table, &spec, &out->problem));
  assert_ok(&out->ctx, fg_loop_run(&out->ctx, &out->problem.problem, &options, &out->result));
}

static void clear(outcome *out) {
  fg_loop_result_free(&out->result);
  fg_loop_table_problem_free(&out->problem);
  fg_table_free(&out->table);
}

static void neighbours_that_are_alike_are_said(void **state) {
  series data;
  outcome out;
  (void)state;
  make_noise(11, &data);
  for (size_t i = 1; i < ROWS; i++)
    data.y[i] += 0.7 * data.y[i - 1];
  search(&data, 1, &out);
  assert_int_equal(out.result.claims, 1);
  assert_string_equal(out.result.claim[0].name, "table.serial_correlation(reading)");
  assert_true(fabs(out.result.claim[0].noise_value - 0.7) <
              4 * out.result.claim[0].noise_value_u + 0.1);
  assert_true(out.result.after.rms < 0.9 * out.result.before.rms);
  assert_true(out.result.after.held_out_rms < out.result.before.held_out_rms);
  assert_int_equal(out.result.verdict, FG_LOOP_EXPLAINED);
  clear(&out);
}

static void a_scatter_that_grows_is_said_and_is_no_error_that_fell(void **state) {
  series data;
  outcome out;
  (void)state;
  make_noise(22, &data);
  for (size_t i = 0; i < ROWS; i++)
    data.y[i] *= exp(0.5 * (data.pressure[i] - 5));
  search(&data, 1, &out);
  assert_int_equal(out.result.claims, 1);
  assert_string_equal(out.result.claim[0].name, "table.spread(pressure)");
  assert_true(out.result.claim[0].noise_value > 3 && out.result.claim[0].noise_value < 16);
  assert_int_equal(out.result.verdict, FG_LOOP_PARTLY);
  clear(&out);
}

static void wrong_rows_do_not_hide_each_other(void **state) {
  series data;
  outcome out;
  (void)state;
  make_noise(13, &data);
  data.y[7] += 12;
  data.y[80] -= 11;
  data.y[99] += 13;
  search(&data, 1, &out);
  assert_int_equal(out.result.claims, 1);
  assert_string_equal(out.result.claim[0].name, "table.outlier(8, 81, 100)");
  clear(&out);
}

/* Quantiles of Student's t with three degrees of freedom, in an order that means nothing. */
static void heavy_tails_are_noted_and_no_row_is_called_wrong(void **state) {
  series data;
  outcome out;
  (void)state;
  make_noise(16, &data);
  for (size_t i = 0; i < ROWS; i++)
    data.y[i] = gsl_cdf_tdist_Pinv(((double)i + 0.5) / ROWS, 3);
  uint64_t seed = 16;
  for (size_t i = ROWS; i > 1; i--) {
    size_t k = (size_t)(random_uniform(&seed) * (double)i);
    double other = data.y[k];
    data.y[k] = data.y[i - 1];
    data.y[i - 1] = other;
  }
  search(&data, 1, &out);
  assert_int_equal(out.result.claims, 0);
  assert_int_equal(out.result.notes, 1);
  assert_has(out.result.note[0], "heavy tails");
  clear(&out);
}

/* Beside normal scores one value of so many sd, and two. */
static void wrong_values_are_likelier_than_a_tail_where_they_are_far_out(void **state) {
  enum { REST = 23 };
  double rest[REST];
  (void)state;
  for (size_t i = 0; i < REST; i++)
    rest[i] = gsl_cdf_ugaussian_Pinv(((double)i + 0.5) / REST);
  double near[] = {4, -4}, far[] = {10, -10};
  assert_true(fg_engine_wrong_over_tail(REST, rest, 1, near) < 3);
  assert_true(fg_engine_wrong_over_tail(REST, rest, 1, far) > 5);
  assert_true(fg_engine_wrong_over_tail(REST, rest, 2, far) > 6);
  for (size_t i = 0; i < REST; i++)
    rest[i] = gsl_cdf_tdist_Pinv(((double)i + 1) / (REST + 2), 2.5);
  assert_true(fg_engine_wrong_over_tail(REST, rest, 1, near) < 2);
}

static void a_cycle_of_three_rows_is_found(void **state) {
  series data;
  outcome out;
  (void)state;
  make_noise(14, &data);
  for (size_t i = 0; i < ROWS; i++)
    data.y[i] += 1.2 * sin(2 * M_PI * (double)i / 3.3);
  search(&data, 1, &out);
  assert_int_equal(out.result.claims, 1);
  assert_string_equal(out.result.claim[0].name, "table.periodic(reading)");
  assert_true(fabs(out.result.claim[0].shape[0] - 3.3) < 0.05);
  clear(&out);
}

/* The same claims, whatever the seed, and with the response told from far away and in another unit.
 */
static void no_verdict_hangs_on_seed_origin_or_unit(void **state) {
  series data, far;
  outcome first, other;
  (void)state;
  make_noise(15, &data);
  for (size_t i = 0; i < ROWS; i++)
    data.y[i] += 0.6 * data.pressure[i];
  search(&data, 1, &first);
  assert_int_equal(first.result.claims, 1);
  for (int change = 0; change < 3; change++) {
    far = data;
    for (size_t i = 0; i < ROWS; i++)
      far.y[i] = change == 0 ? data.y[i] : change == 1 ? data.y[i] + 1e8 : 1e-12 * data.y[i];
    search(&far, change == 0 ? 77 : 1, &other);
    assert_int_equal(other.result.claims, 1);
    assert_string_equal(other.result.claim[0].name, first.result.claim[0].name);
    assert_int_equal(other.result.verdict, first.result.verdict);
    if (change == 1)
      assert_true(fabs(other.result.parameter[0] - first.result.parameter[0] - 1e8) < 1e-6);
    clear(&other);
  }
  clear(&first);
}

/* Rows that were sorted by a column: neighbours mean nothing, and no effect lives on their number.
 */
static void sorted_rows_have_no_order(void **state) {
  series data;
  outcome out;
  (void)state;
  make_noise(16, &data);
  for (size_t i = 0; i < ROWS; i++) {
    data.pressure[i] = floor((double)i / 20);
    data.reading[i] = fmod((double)i * 7, 20);
    data.y[i] += data.pressure[i];
  }
  search(&data, 1, &out);
  assert_false(out.problem.problem.correlated);
  for (size_t c = 0; c < out.problem.problem.coordinates; c++)
    assert_string_not_equal(out.problem.problem.coordinate[c].name, "row");
  assert_true(out.result.claims >= 1);
  assert_has(out.result.claim[0].name, "pressure");
  clear(&out);
}

enum { RUNS = 24 };

/* In few runs those of large scatter move the fit, and with it the residuals of the others: of 4
 * columns fitted to 24 runs each keeps five sixths of its own. */
static void a_spread_of_few_runs_is_found_beside_what_it_does_to_the_fit(void **state) {
  enum { TABLES = 12 };
  size_t found = 0;
  (void)state;
  for (uint64_t table = 0; table < TABLES; table++) {
    double hold[RUNS], heat[RUNS], y[RUNS];
    const char *machine[RUNS];
    uint64_t seed = 60 + table;
    outcome out = {0};
    const fg_loop_options options = {.effects = fg_loop_table_effects(), .seed = 1};
    const fg_loop_table_spec spec = {.response = "y", .model = "heat * hold", .seed = 1};
    for (size_t i = 0; i < RUNS; i++) {
      machine[i] = i % 2 ? "A" : "B";
      heat[i] = (double)(i / 2 % 4);
      hold[i] = (double)(i / 8);
      y[i] = heat[i] + hold[i] + (i % 2 ? 1 : 0.05) * random_gaussian(&seed);
    }
    assert_ok(&out.ctx, fg_table_add_numbers(&out.ctx, &out.table, "heat", heat, RUNS));
    assert_ok(&out.ctx, fg_table_add_numbers(&out.ctx, &out.table, "hold", hold, RUNS));
    assert_ok(&out.ctx, fg_table_add_words(&out.ctx, &out.table, "machine", machine, RUNS));
    assert_ok(&out.ctx, fg_table_add_numbers(&out.ctx, &out.table, "y", y, RUNS));
    assert_ok(&out.ctx, fg_loop_table_problem_build(&out.ctx, &out.table, &spec, &out.problem));
    assert_ok(&out.ctx, fg_loop_run(&out.ctx, &out.problem.problem, &options, &out.result));
    for (size_t m = 0; m < out.result.claims; m++)
      found += !strcmp(out.result.claim[m].name, "table.spread(machine)");
    clear(&out);
  }
  assert_true(found >= 9);
}

/* Twice the restricted log likelihood of rows about one constant, with sd exp(slope z). */
static double likelihood_of_slope(const double *z, const double *y, double slope) {
  double weights = 0, mean = 0, logs = 0, squares = 0;
  for (size_t i = 0; i < RUNS; i++) {
    double weight = exp(-2 * slope * z[i]);
    weights += weight;
    mean += weight * y[i];
    logs += 2 * slope * z[i];
  }
  mean /= weights;
  for (size_t i = 0; i < RUNS; i++)
    squares += exp(-2 * slope * z[i]) * (y[i] - mean) * (y[i] - mean);
  return -((RUNS - 1) * log(squares) + logs + log(weights / RUNS));
}

/* Were gains below some size 0, most tables would have none, and the least gain would be proof. */
static void a_small_gain_of_a_spread_is_not_zero(void **state) {
  enum { TABLES = 40, STEPS = 3000 };
  (void)state;
  for (uint64_t table = 0; table < TABLES; table++) {
    double basis[RUNS], kept[RUNS], z[RUNS], y[RUNS], best = -INFINITY;
    uint64_t seed = 90 + table;
    for (size_t i = 0; i < RUNS; i++) {
      basis[i] = 1 / sqrt(RUNS);
      kept[i] = 1 - 1.0 / RUNS;
      z[i] = i % 2 ? 1 : -1;
      y[i] = random_gaussian(&seed);
    }
    for (int k = -STEPS; k <= STEPS; k++)
      best = fmax(best, likelihood_of_slope(z, y, k / 1000.0));
    const fg_engine_span null = {.n = RUNS, .rank = 1, .basis = basis, .kept = kept};
    fg_engine_spread_grid grid;
    assert_int_equal(fg_engine_spread_grid_open(NULL, &null, z, &grid), FG_OK);
    double gain = fg_engine_spread_gain(&null, (fg_engine_spread_rows){.z = z, .grid = &grid}, y);
    fg_engine_spread_grid_close(&grid);
    assert_true(fabs(gain - (best - likelihood_of_slope(z, y, 0))) < 0.002);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(neighbours_that_are_alike_are_said),
      cmocka_unit_test(a_scatter_that_grows_is_said_and_is_no_error_that_fell),
      cmocka_unit_test(wrong_rows_do_not_hide_each_other),
      cmocka_unit_test(heavy_tails_are_noted_and_no_row_is_called_wrong),
      cmocka_unit_test(wrong_values_are_likelier_than_a_tail_where_they_are_far_out),
      cmocka_unit_test(a_cycle_of_three_rows_is_found),
      cmocka_unit_test(no_verdict_hangs_on_seed_origin_or_unit),
      cmocka_unit_test(sorted_rows_have_no_order),
      cmocka_unit_test(a_spread_of_few_runs_is_found_beside_what_it_does_to_the_fit),
      cmocka_unit_test(a_small_gain_of_a_spread_is_not_zero),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The advice on a tie, against the same question answered here: both models fitted by normal
 * equations, and their predictions compared at every setting. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"
#include "support/random.h"
#include "support/test.h"

enum { ROWS = 40, COLUMNS = 4, STEPS = 7 };

typedef struct rows_data {
  double a[ROWS], b[ROWS], y[ROWS];
} rows_data;

/* b follows a so closely that a·b, a² and b² cannot be told apart. */
static void make_rows(uint64_t seed, rows_data *data) {
  for (size_t i = 0; i < ROWS; i++) {
    data->a[i] = -1 + 0.05 * floor(41 * random_uniform(&seed));
    data->b[i] = data->a[i] + 0.02 * random_gaussian(&seed);
    data->y[i] = 5 + 0.5 * data->a[i] + 3 * data->a[i] * data->b[i] + 0.2 * random_gaussian(&seed);
  }
}

static double scaled(const double *column, double value) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < ROWS; i++) {
    low = fmin(low, column[i]);
    high = fmax(high, column[i]);
  }
  return (2 * value - low - high) / (high - low);
}

/* 1, a and the effect by its name at a setting. */
static void model_row(const char *name, const rows_data *data, double a, double b,
                      double row[COLUMNS]) {
  double x = scaled(data->a, a), z = scaled(data->b, b);
  row[0] = 1;
  row[1] = a;
  row[2] = row[3] = 0;
  if (!strcmp(name, "table.interaction(a, b)"))
    row[2] = x * z;
  else if (!strcmp(name, "table.quadratic(a)"))
    row[2] = x * x;
  else if (!strcmp(name, "table.quadratic(b)"))
    row[2] = z, row[3] = z * z;
  else
    fail_msg("%s was not expected in this tie", name);
}

static void solve(double m[COLUMNS][COLUMNS + 1], double *beta) {
  for (size_t k = 0; k < COLUMNS; k++) {
    if (fabs(m[k][k]) < 1e-12) m[k][k] = 1; /* a column that the model does not have */
    for (size_t i = 0; i < COLUMNS; i++) {
      double share = m[i][k] / m[k][k];
      for (size_t j = 0; i != k && j <= COLUMNS; j++)
        m[i][j] -= share * m[k][j];
    }
  }
  for (size_t k = 0; k < COLUMNS; k++)
    beta[k] = m[k][COLUMNS] / m[k][k];
}

static void fit(const char *name, const rows_data *data, double *beta) {
  double m[COLUMNS][COLUMNS + 1] = {{0}}, row[COLUMNS];
  for (size_t i = 0; i < ROWS; i++) {
    model_row(name, data, data->a[i], data->b[i], row);
    for (size_t j = 0; j < COLUMNS; j++) {
      for (size_t k = 0; k < COLUMNS; k++)
        m[j][k] += row[j] * row[k];
      m[j][COLUMNS] += row[j] * data->y[i];
    }
  }
  solve(m, beta);
}

static double predict(const char *name, const rows_data *data, const double *beta, double a,
                      double b) {
  double row[COLUMNS], sum = 0;
  model_row(name, data, a, b, row);
  for (size_t k = 0; k < COLUMNS; k++)
    sum += beta[k] * row[k];
  return sum;
}

/* The measured value that lies nearest to a step of the range: only such can be set. */
static double settable(const double *column, double low, double high, size_t step) {
  double at = low + (high - low) * (double)step / (STEPS - 1), best = column[0];
  for (size_t i = 1; i < ROWS; i++)
    if (fabs(column[i] - at) < fabs(best - at)) best = column[i];
  return best;
}

/* The largest change of the difference between two settings in the measured range. */
static double largest_step(const char *winner, const char *rival, const rows_data *data) {
  double of_winner[COLUMNS], of_rival[COLUMNS], low = INFINITY, high = -INFINITY;
  double a_low = INFINITY, a_high = -INFINITY, b_low = INFINITY, b_high = -INFINITY;
  for (size_t i = 0; i < ROWS; i++) {
    a_low = fmin(a_low, data->a[i]), a_high = fmax(a_high, data->a[i]);
    b_low = fmin(b_low, data->b[i]), b_high = fmax(b_high, data->b[i]);
  }
  fit(winner, data, of_winner);
  fit(rival, data, of_rival);
  for (size_t i = 0; i < STEPS; i++)
    for (size_t k = 0; k < STEPS; k++) {
      double a = settable(data->a, a_low, a_high, i);
      double b = settable(data->b, b_low, b_high, k);
      double apart = predict(winner, data, of_winner, a, b) - predict(rival, data, of_rival, a, b);
      low = fmin(low, apart);
      high = fmax(high, apart);
    }
  return high - low;
}

/* Compares the advice; false where the noise came out correlated: the fits here take it as white.
 */
static bool check_advice(const rows_data *data, const fg_loop_result *result) {
  const fg_loop_claim *claim = &result->claim[0];
  const fg_loop_advice *advice = &result->advice[0];
  const char *differ = strstr(advice->text, "differ by ");
  double said = 0;
  if (result->noise.rho != 0 || result->claims != 1 || claim->alias[0].sum) return false;
  assert_int_equal(result->advices, 1);
  assert_non_null(differ);
  assert_int_equal(sscanf(differ, "differ by %lf", &said), 1);
  double step = largest_step(claim->name, claim->alias[0].name, data);
  assert_near(said, step, 0.005 * step);
  double needed = ceil(2 * pow((3.09 + 0.8416) * result->noise.sd / step, 2));
  assert_near(advice->runs, fmax(needed, 2), 0.5);
  return strstr(claim->name, "(a, b)") || strstr(claim->alias[0].name, "(a, b)");
}

static void a_tie_is_parted_where_its_models_differ_most(void **state) {
  size_t compared = 0;
  (void)state;
  for (uint64_t seed = 1; seed <= 8; seed++) {
    rows_data data;
    fg_context ctx = {0};
    fg_table table = {0};
    fg_loop_table_problem problem;
    fg_loop_result result;
    fg_loop_table_spec spec = {.response = "y", .model = "1 + a", .hold_out = "0", .seed = 1};
    const fg_loop_options options = {.effects = fg_loop_table_effects(), .seed = 1};
    make_rows(seed, &data);
    assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "a", data.a, ROWS));
    assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "b", data.b, ROWS));
    assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "y", data.y, ROWS));
    assert_ok(&ctx, fg_loop_table_problem_build(&ctx, &table, &spec, &problem));
    assert_ok(&ctx, fg_loop_run(&ctx, &problem.problem, &options, &result));
    compared += check_advice(&data, &result);
    fg_loop_result_free(&result);
    fg_loop_table_problem_free(&problem);
    fg_table_free(&table);
  }
  print_message("%zu ties compared\n", compared);
  assert_true(compared >= 2);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_tie_is_parted_where_its_models_differ_most),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signals on charts of steady processes, and of processes that change. */
#include <math.h>
#include <string.h>

#include "foilgauge/control.h"
#include "support/random.h"
#include "support/test.h"

/* The share of charts of a steady process that are called not steady is the level. */
static void one_steady_chart_of_a_hundred_is_called_not_steady(void **state) {
  (void)state;
  enum { CHARTS = 4000, POINTS_MAX = 200, BUMPS = 6 };
  static const size_t counts[] = {25, 60, POINTS_MAX};
  fg_context ctx;
  fg_chart chart, deviations;
  fg_chart_chance chance;
  uint64_t seed = 9;
  double values[POINTS_MAX * BUMPS];
  size_t size[POINTS_MAX];
  for (size_t i = 0; i < POINTS_MAX; i++)
    size[i] = BUMPS;
  for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
    for (unsigned rules = 0xF; rules <= 0xFF; rules += 0xF0) {
      in_row("%zu points, rules %x", counts[c], rules);
      size_t not_steady = 0, uneven = 0, with_signals = 0;
      for (int k = 0; k < CHARTS; k++) {
        for (size_t i = 0; i < counts[c]; i++)
          values[i] = random_gaussian(&seed);
        assert_ok(&ctx, fg_chart_individuals(&ctx, values, counts[c], rules, &chart));
        fg_chart_judge_individuals(&chart, rules, 0.01, &chance);
        not_steady += !chance.steady;
        with_signals += chart.signals > 0;
        fg_chart_free(&chart);
      }
      for (int k = 0; k < CHARTS / 4; k++) {
        for (size_t i = 0; i < counts[c] * BUMPS; i++)
          values[i] = random_gaussian(&seed);
        assert_ok(&ctx, fg_chart_subgroups(&ctx, &(fg_subgroups){values, size, counts[c]},
                                           FG_SIGMA_FROM_SD, rules, NULL, &deviations));
        fg_chart_judge_deviations(&deviations, size, rules, 0.01, &chance);
        uneven += !chance.steady;
        fg_chart_free(&deviations);
      }
      assert_true(not_steady >= CHARTS / 500 && not_steady <= CHARTS / 50);
      assert_true(uneven <= CHARTS / 4 / 40);
      assert_true(with_signals > CHARTS / 10);
    }
}

/* One value far out, and a step of the mean, are no chance; a value just beyond three sigma is. */
static void what_chance_does_not_explain_is_not_steady(void **state) {
  (void)state;
  enum { POINTS = 200 };
  fg_context ctx;
  fg_chart chart;
  fg_chart_chance chance;
  uint64_t seed = 21;
  double base[POINTS], values[POINTS];
  for (int i = 0; i < POINTS; i++)
    base[i] = fmax(-2, fmin(2, random_gaussian(&seed)));
  static const struct {
    double value, step;
    bool steady;
    size_t outliers;
  } cases[] = {{0, 0, true, 0}, {3.3, 0, true, 0}, {6, 0, false, 1}, {0, 1.5, false, 0}};
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    in_row("cases[%zu]", c);
    memcpy(values, base, sizeof values);
    if (cases[c].value != 0) values[50] = cases[c].value;
    for (int i = POINTS / 2; i < POINTS; i++)
      values[i] += cases[c].step;
    assert_ok(&ctx, fg_chart_individuals(&ctx, values, POINTS, 0xF, &chart));
    fg_chart_judge_individuals(&chart, 0xF, 0.01, &chance);
    assert_int_equal(chance.steady, cases[c].steady);
    assert_int_equal(chance.outliers, cases[c].outliers);
    fg_chart_free(&chart);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_steady_chart_of_a_hundred_is_called_not_steady),
      cmocka_unit_test(what_chance_does_not_explain_is_not_steady),
  };
  return cmocka_run_group_tests_name("chance on control charts", tests, NULL, NULL);
}

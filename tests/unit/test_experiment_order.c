/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests of `doe` for the order of its runs: against the same numbers by another way, on noise, and
 * on effects that they must see. And the cost of taking an effect out beforehand. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/distribution.h"
#include "foilgauge/experiment.h"
#include "support/random.h"
#include "support/test.h"

enum { RUNS = 24 };

static uint64_t state_of_noise;

/* Three levels of T and two of D in random order; the response is y. */
typedef struct made {
  double run[RUNS], t[RUNS], d[RUNS], y[RUNS];
} made;

static void make_noise(made *m) {
  for (int i = 0; i < RUNS; i++) {
    m->run[i] = i + 1;
    m->t[i] = floor(3 * random_uniform(&state_of_noise));
    m->d[i] = i % 4 < 2 ? -1 : 1;
    m->y[i] = 5 + 2 * m->t[i] - m->d[i] + 0.3 * random_gaussian(&state_of_noise);
  }
}

static void analyse(const made *m, const char *formula, const fg_experiment_options *more,
                    fg_experiment *e) {
  fg_context ctx = {0};
  fg_table table = {0};
  fg_experiment_options options = more ? *more : (fg_experiment_options){0};
  options.response = "y";
  options.formula = formula;
  assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "run", m->run, RUNS));
  assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "T", m->t, RUNS));
  assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "D", m->d, RUNS));
  assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "y", m->y, RUNS));
  if (fg_experiment_analyse(&ctx, &table, &options, e) != FG_OK) fail_msg("%s", ctx.message);
  fg_table_free(&table);
}

/* Rows in another order than the runs: the run column says which came first. */
static void shuffle(made *m) {
  for (int i = RUNS - 1; i > 0; i--) {
    int k = (int)(random_uniform(&state_of_noise) * (i + 1));
    double *columns[] = {m->run, m->t, m->d, m->y};
    for (int c = 0; c < 4; c++) {
      double held = columns[c][i];
      columns[c][i] = columns[c][k];
      columns[c][k] = held;
    }
  }
}

static void tests_are_the_known_ones(void **state) {
  (void)state;
  made m;
  fg_experiment e, with_run;
  state_of_noise = 5;
  make_noise(&m);
  m.y[3] += 1.5;
  for (int i = 0; i < RUNS; i++)
    m.y[i] += 0.02 * i;
  shuffle(&m);
  analyse(&m, "T + D", NULL, &e);
  analyse(&m, "T + D + run", NULL, &with_run); /* coded: its coefficient is half the change */
  assert_true(e.has_order);
  assert_string_equal(e.order.column, "run");
  size_t at = 3;
  assert_string_equal(with_run.regression.coefficient[at].name, "run");
  const fg_experiment_effect *run = &with_run.effect[at];
  double twice = 2 * with_run.regression.coefficient[at].estimate;
  assert_true(fabs(e.order.drift - twice) < 1e-9 * fabs(twice));
  assert_true(fabs(e.order.u_drift - 2 * run->standard_error) < 1e-9 * run->standard_error);
  assert_true(fabs(e.order.drift_p - run->p_value) < 1e-9);
  double in_order[RUNS], squares = 0, products = 0, all = 0;
  for (int i = 0; i < RUNS; i++)
    in_order[(int)m.run[i] - 1] = e.regression.residual[i];
  for (int i = 0; i < RUNS; i++) {
    all += in_order[i] * in_order[i];
    if (i) squares += pow(in_order[i] - in_order[i - 1], 2);
    if (i) products += in_order[i] * in_order[i - 1];
  }
  assert_true(fabs(e.order.durbin_watson - squares / all) < 1e-9);
  assert_true(fabs(e.order.neighbours - products / all) < 1e-9);
  assert_true(m.run[e.order.farthest] == 4);
  double t = e.regression.external[e.order.farthest];
  assert_true(e.order.farthest_t == t);
  double p = RUNS * fg_distribution_t_two_sided(t, RUNS - 3 - 1);
  assert_true(fabs(e.order.farthest_p - fmin(1, p)) < 1e-12);
  fg_experiment_free(&e);
  fg_experiment_free(&with_run);
}

/* Settings in blocks, not in random order: fitted values are alike in neighbouring runs, and
 * residuals are not. */
static void slow_down(made *m) {
  for (int i = 0; i < RUNS; i++) {
    m->t[i] = i / 8;
    m->d[i] = i % 8 < 4 ? -1 : 1;
    m->y[i] = 0.3 * random_gaussian(&state_of_noise);
  }
}

/* On noise each test is told as often as its level says, whatever the model. */
static void noise_is_told_at_the_level(void **state) {
  enum { TABLES = 500 };
  static const char *const models[] = {"T + D", "T*D + T^2", "T*D + T^2"};
  (void)state;
  for (int k = 0; k < 3; k++) {
    int told[3] = {0}, tenth = 0;
    state_of_noise = k ? 11 : 12;
    for (int i = 0; i < TABLES; i++) {
      made m;
      fg_experiment e;
      make_noise(&m);
      if (k == 2) slow_down(&m);
      analyse(&m, models[k], NULL, &e);
      told[0] += e.order.drift_p < FG_ORDER_LEVEL;
      told[1] += e.order.neighbours_p < FG_ORDER_LEVEL;
      told[2] += e.order.farthest_p < FG_ORDER_LEVEL;
      tenth += e.order.neighbours_p < 0.1;
      fg_experiment_free(&e);
    }
    /* 8.3 of 500 expected, with a standard deviation of 2.9: within four of them. */
    for (int test = 0; test < 3; test++)
      if (told[test] < 1 || told[test] > 20)
        fail_msg("%s: test %d is told in %d of %d", models[k], test, told[test], TABLES);
    if (tenth < 23 || tenth > 77) fail_msg("%s: %d below 0.1", models[k], tenth);
  }
}

static int times_told(int what, double size) {
  enum { TABLES = 60 };
  int told = 0;
  state_of_noise = 23;
  for (int i = 0; i < TABLES; i++) {
    made m;
    fg_experiment e;
    double walk = 0;
    make_noise(&m);
    for (int r = 0; r < RUNS; r++) {
      walk = 0.8 * walk + 0.3 * random_gaussian(&state_of_noise);
      m.y[r] += what == 0 ? size * r / (RUNS - 1) : what == 1 ? size * walk : 0;
    }
    if (what == 2) m.y[9] -= size;
    analyse(&m, "T + D", NULL, &e);
    double p[] = {e.order.drift_p, e.order.neighbours_p, e.order.farthest_p};
    told += p[what] < FG_ORDER_LEVEL && (what != 2 || e.order.farthest == 9) &&
            (what != 0 || e.order.drift > 0) && (what != 1 || e.order.neighbours > 0);
    fg_experiment_free(&e);
  }
  return told;
}

static void real_order_effects_are_found(void **state) {
  (void)state;
  int drift = times_told(0, 1.2), alike = times_told(1, 2), slip = times_told(2, 2.1);
  if (drift < 54 || slip < 54) fail_msg("a drift is told in %d, a slip in %d of 60", drift, slip);
  if (alike < 24) fail_msg("correlation of 0.8 is told in %d of 60", alike);
}

/* An effect that was taken out costs degrees of freedom of the residual, and of the error of
 * repeated runs where it differs between them. */
static void subtracted_effects_cost_their_dof(void **state) {
  (void)state;
  made m;
  fg_experiment plain, paid, between;
  double within[RUNS], same[RUNS];
  state_of_noise = 31;
  make_noise(&m);
  for (int i = 0; i < RUNS; i++) {
    within[i] = 0.1 * m.run[i];
    same[i] = 0.1 * m.t[i];
  }
  const fg_subtracted_effect effects[] = {
      {.id = "a", .words = "a", .parameters = 2, .applied = true},
      {.id = "b", .words = "b", .parameters = 1, .applied = false},
  };
  fg_experiment_options options = {
      .subtracted = effects, .subtracted_count = 2, .subtracted_sum = within};
  analyse(&m, "T + D", NULL, &plain);
  analyse(&m, "T + D", &options, &paid);
  options.subtracted_sum = same;
  analyse(&m, "T + D", &options, &between);
  const fg_regression *a = &plain.regression, *b = &paid.regression, *c = &between.regression;
  assert_int_equal(paid.subtracted.dof, 2);
  assert_int_equal(a->residual_dof, RUNS - 3);
  assert_int_equal(b->residual_dof, RUNS - 5);
  assert_true(fabs(b->residual_sd - sqrt(a->residual_ss / (RUNS - 5))) < 1e-12);
  assert_int_equal(b->pure_dof, a->pure_dof - 2);
  assert_int_equal(b->lack_dof, a->lack_dof);
  assert_int_equal(c->pure_dof, a->pure_dof);
  assert_int_equal(c->lack_dof, a->lack_dof - 2);
  double grown = sqrt((RUNS - 3.0) / (RUNS - 5.0));
  assert_true(fabs(paid.effect[1].standard_error / plain.effect[1].standard_error - grown) < 1e-12);
  double p = fg_distribution_t_two_sided(paid.effect[1].t, RUNS - 5);
  assert_true(fabs(paid.effect[1].p_value - p) < 1e-12);
  fg_experiment_free(&plain);
  fg_experiment_free(&paid);
  fg_experiment_free(&between);
}

/* An effect that is the same within whole plots is paid by their error, another by the runs'. */
static void strata_pay_their_own(void **state) {
  (void)state;
  made m;
  fg_experiment plain, whole, runs;
  double constant[RUNS], varying[RUNS];
  state_of_noise = 37;
  make_noise(&m);
  for (int i = 0; i < RUNS; i++) {
    m.run[i] = i / 4; /* six plots */
    m.t[i] = i / 8;
    m.d[i] = i % 2;
    constant[i] = i / 4;
    varying[i] = i;
  }
  const fg_subtracted_effect effects[] = {
      {.id = "a", .words = "a", .parameters = 1, .applied = true}};
  fg_experiment_options options = {.whole_plot = "run"};
  analyse(&m, "T + D", &options, &plain);
  options.subtracted = effects;
  options.subtracted_count = 1;
  options.subtracted_sum = constant;
  analyse(&m, "T + D", &options, &whole);
  options.subtracted_sum = varying;
  analyse(&m, "T + D", &options, &runs);
  assert_false(plain.has_order);
  assert_int_equal(whole.split_plot.plot_dof, plain.split_plot.plot_dof - 1);
  assert_int_equal(whole.split_plot.run_dof, plain.split_plot.run_dof);
  assert_int_equal(runs.split_plot.plot_dof, plain.split_plot.plot_dof);
  assert_int_equal(runs.split_plot.run_dof, plain.split_plot.run_dof - 1);
  double ratio = (double)plain.split_plot.plot_dof / (double)whole.split_plot.plot_dof;
  assert_true(fabs(whole.split_plot.plot_ms / plain.split_plot.plot_ms - ratio) < 1e-12);
  assert_true(fabs(plain.split_plot.term[0].row.f / whole.split_plot.term[0].row.f - ratio) <
              1e-12);
  fg_experiment_free(&plain);
  fg_experiment_free(&whole);
  fg_experiment_free(&runs);
}

static void no_residual_dof_is_reported(void **state) {
  (void)state;
  made m;
  fg_context ctx = {0};
  fg_table table = {0};
  fg_experiment e;
  state_of_noise = 41;
  make_noise(&m);
  const fg_subtracted_effect effects[] = {
      {.id = "a", .words = "a", .parameters = 3, .applied = true}};
  const fg_experiment_options options = {.response = "y",
                                         .formula = "T + D",
                                         .subtracted = effects,
                                         .subtracted_count = 1,
                                         .subtracted_sum = m.run};
  assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "T", m.t, 6));
  assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "D", m.d, 6));
  assert_ok(&ctx, fg_table_add_numbers(&ctx, &table, "y", m.y, 6));
  assert_status(&ctx, fg_experiment_analyse(&ctx, &table, &options, &e), FG_ERR_DATA);
  if (!strstr(ctx.message, "no freedom is left")) fail_msg("%s", ctx.message);
  fg_table_free(&table);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(tests_are_the_known_ones),
      cmocka_unit_test(noise_is_told_at_the_level),
      cmocka_unit_test(real_order_effects_are_found),
      cmocka_unit_test(subtracted_effects_cost_their_dof),
      cmocka_unit_test(strata_pay_their_own),
      cmocka_unit_test(no_residual_dof_is_reported),
  };
  return cmocka_run_group_tests_name("experiment_order", tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regression where it gets difficult: no freedom, aliases, weights, one run; split plots; optima.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/anova.h"
#include "foilgauge/doe.h"
#include "foilgauge/surface.h"
#include "support/test.h"

typedef struct experiment {
  fg_context ctx;
  fg_table table;
  fg_model model;
  fg_regression reg;
} experiment;

static void fit(experiment *e, const char *text, const char *formula, const double *weights) {
  const fg_regression_options options = {.weights = weights};
  *e = (experiment){0};
  assert_ok(&e->ctx, fg_table_parse(&e->ctx, "runs.csv", text, strlen(text), &e->table));
  if (fg_regression_analyse(&e->ctx, &e->table, formula, NULL, &options, &e->model, &e->reg) !=
      FG_OK)
    fail_msg("%s", e->ctx.message);
}

static void drop(experiment *e) {
  fg_regression_free(&e->reg);
  fg_model_free(&e->model);
  fg_table_free(&e->table);
}

static void one_run(void **state) {
  experiment e;
  (void)state;
  fit(&e, "x,y\n3,5\n", "y ~ x", NULL);
  assert_int_equal(e.reg.rank, 1);
  assert_near(e.reg.coefficient[0].estimate, 5, 0);
  assert_true(e.reg.coefficient[1].aliased && isnan(e.reg.coefficient[1].estimate));
  assert_near(e.reg.alias[0].factor[0], 3, 0);
  assert_has(e.reg.note[0], "no residual freedom");
  drop(&e);
}

static void equal_responses(void **state) {
  experiment e;
  (void)state;
  fit(&e, "x,y\n1,0.7\n2,0.7\n3,0.7\n5,0.7\n", "y ~ x", NULL);
  assert_near(e.reg.coefficient[0].estimate, 0.7, 1e-16);
  assert_true(e.reg.total_ss == 0 && isnan(e.reg.r2));
  assert_has(e.reg.note[0], "all responses are equal");
  drop(&e);
}

static void exact_fit(void **state) {
  experiment e;
  (void)state;
  fit(&e, "x,y\n1,0.3\n2,0.6\n3,0.9\n5,1.5\n", "y ~ x", NULL);
  assert_near(e.reg.coefficient[1].estimate, 0.3, 0);
  assert_true(e.reg.residual_ss == 0 && e.reg.r2 == 1 && e.reg.coefficient[1].p_value == 0);
  assert_has(e.reg.note[0], "reproduces the response exactly");
  drop(&e);
}

/* c = a + 2 b: reported so, and the fit is that of a and b alone. */
static void aliases_are_named(void **state) {
  experiment e;
  (void)state;
  fit(&e, "a,b,c,y\n1,0.1,1.2,1\n2,0.3,2.6,3\n3,0.2,3.4,2\n4,0.7,5.4,6\n5,0.1,5.2,4\n",
      "y ~ a + b + c", NULL);
  assert_int_equal(e.reg.rank, 3);
  assert_int_equal(e.reg.aliases, 1);
  const fg_alias *alias = &e.reg.alias[0];
  assert_int_equal(alias->column, 3);
  assert_int_equal(alias->count, 2);
  assert_int_equal(alias->with[0], 1);
  assert_near(alias->factor[0], 1, 1e-14);
  assert_near(alias->factor[1], 2, 1e-14);
  assert_int_equal(e.reg.sequential[2].dof, 0);
  assert_true(isnan(e.reg.coefficient[3].estimate));
  assert_has(e.reg.note[0], "c cannot be told apart from others (it is 1 × a + 2 × b)");
  fg_prediction p;
  assert_ok(&e.ctx, fg_regression_predict(&e.ctx, &e.reg, (double[]){1, 3, 0.2, 3.4}, &p));
  assert_near(p.mean, e.reg.fitted[2], 1e-14);
  assert_near(p.standard_error, e.reg.residual_sd * sqrt(e.reg.leverage[2]), 1e-14);
  drop(&e);
}

/* c = a + b, in tenths that binary numbers round: the constant has no share but rounding's. */
static void an_alias_has_no_share_of_rounding_size(void **state) {
  experiment e;
  (void)state;
  fit(&e,
      "a,b,c,y\n0.1,1.1,1.2,1\n0.2,1.3,1.5,2\n0.3,1.7,2,4\n0.4,1.1,1.5,3\n0.6,1.9,2.5,7\n"
      "0.7,1.4,2.1,5\n",
      "y ~ a + b + c", NULL);
  assert_int_equal(e.reg.aliases, 1);
  assert_int_equal(e.reg.alias[0].count, 2);
  assert_has(e.reg.note[0], "(it is 1 × a + 1 × b)");
  drop(&e);
}

/* A half fraction 2^(3-1) with C = AB: the interaction is the factor. */
static void a_fraction_has_its_alias(void **state) {
  experiment e;
  (void)state;
  fit(&e, "A,B,C,y\n-1,-1,1,3\n1,-1,-1,5\n-1,1,-1,4\n1,1,1,9\n", "y ~ A + B + C + A:B", NULL);
  assert_int_equal(e.reg.aliases, 1);
  assert_int_equal(e.reg.alias[0].with[0], 3);
  assert_near(e.reg.alias[0].factor[0], 1, 1e-15);
  drop(&e);
}

/* A weight of 2 counts as the run twice, for everything but the freedom. */
static void weights_repeat_runs(void **state) {
  experiment weighted, repeated;
  static const double weights[] = {1, 2, 1, 3, 1};
  (void)state;
  fit(&weighted, "x,y\n1,2\n2,3\n3,7\n4,6\n6,9\n", "y ~ x", weights);
  fit(&repeated, "x,y\n1,2\n2,3\n2,3\n3,7\n4,6\n4,6\n4,6\n6,9\n", "y ~ x", NULL);
  assert_near(weighted.reg.coefficient[1].estimate, repeated.reg.coefficient[1].estimate, 1e-15);
  assert_near(weighted.reg.residual_ss, repeated.reg.residual_ss, 1e-14);
  assert_near(weighted.reg.total_ss, repeated.reg.total_ss, 1e-14);
  assert_near(weighted.reg.residual[1], repeated.reg.residual[1], 1e-15);
  assert_near(weighted.reg.leverage[3], 3 * repeated.reg.leverage[4], 1e-15);
  drop(&weighted);
  drop(&repeated);
  fg_table table;
  fg_model model;
  fg_regression reg;
  fg_context ctx = {0};
  const fg_regression_options bad = {.weights = (double[]){1, 0}};
  assert_ok(&ctx, fg_table_parse(&ctx, "t", "x,y\n1,2\n2,3\n", 12, &table));
  assert_status(&ctx, fg_regression_analyse(&ctx, &table, "y~x", NULL, &bad, &model, &reg),
                FG_ERR_USAGE);
  assert_has(ctx.message, "row 2: the weight");
  fg_table_free(&table);
}

/* Leaving every run out in turn and fitting again gives the same PRESS, external residuals and
 * Cook's distances. */
static void leave_one_out_residuals_agree_with_refits(void **state) {
  enum { ROWS = 7 };
  static const char text[] = "x,y\n1,2\n2,3\n3,7\n4,6\n6,9\n7,7\n11,20\n";
  experiment all;
  double press = 0;
  (void)state;
  fit(&all, text, "y ~ x + x^2", NULL);
  for (size_t left = 0; left < ROWS; left++) {
    experiment e = {0};
    fg_prediction p;
    size_t rows[ROWS - 1], count = 0;
    for (size_t i = 0; i < ROWS; i++)
      if (i != left) rows[count++] = i;
    assert_ok(&e.ctx, fg_table_select(&e.ctx, &all.table, rows, count, &e.table));
    assert_ok(&e.ctx,
              fg_regression_analyse(&e.ctx, &e.table, "y ~ x + x^2", NULL, NULL, &e.model, &e.reg));
    double x = all.table.column[0].number[left].value, y = all.table.column[1].number[left].value;
    assert_ok(&e.ctx, fg_regression_predict(&e.ctx, &e.reg, (double[]){1, x, x * x}, &p));
    press += (y - p.mean) * (y - p.mean);
    assert_near(all.reg.external[left], (y - p.mean) / p.run_standard_error, 1e-11);
    double cook = 0;
    for (size_t i = 0; i < ROWS; i++) {
      double at = all.table.column[0].number[i].value;
      assert_ok(&e.ctx, fg_regression_predict(&e.ctx, &e.reg, (double[]){1, at, at * at}, &p));
      cook += pow(all.reg.fitted[i] - p.mean, 2) / (3 * pow(all.reg.residual_sd, 2));
    }
    assert_near(all.reg.cook[left], cook, 1e-11 * (1 + cook));
    drop(&e);
  }
  assert_near(all.reg.press, press, 1e-11 * press);
  drop(&all);
}

static void a_lever_run_is_noted(void **state) {
  experiment e;
  (void)state;
  fit(&e, "g,y\na,1\na,2\nb,7\na,4\n", "y ~ g", NULL);
  assert_near(e.reg.leverage[2], 1, 1e-15);
  assert_true(isnan(e.reg.press) && isnan(e.reg.internal[2]) && isnan(e.reg.cook[2]));
  assert_has(e.reg.note[0], "run 3 alone determines");
  drop(&e);
}

/* Partial squares are the rise of the residual when the term's columns leave. */
static void partial_squares_are_drops(void **state) {
  static const char text[] = "g,x,y\na,1,2\na,2,3\nb,3,7\nb,4,6\nc,6,9\nc,7,7\nc,9,20\na,4,8\n";
  experiment full, without;
  (void)state;
  fit(&full, text, "y ~ g + x", NULL);
  fit(&without, text, "y ~ x", NULL);
  assert_near(full.reg.partial[0].sum_of_squares, without.reg.residual_ss - full.reg.residual_ss,
              1e-11);
  assert_int_equal(full.reg.partial[0].dof, 2);
  drop(&without);
  fit(&without, text, "y ~ g", NULL);
  assert_near(full.reg.partial[1].sum_of_squares, without.reg.residual_ss - full.reg.residual_ss,
              1e-11);
  assert_near(full.reg.partial[1].f, pow(full.reg.coefficient[3].t, 2), 1e-10);
  drop(&full);
  drop(&without);
}

/* Two oven loads per temperature, two times in each: the load error judges T. With plot effects
 * +-1 (a1, a2) and +-2, and the run pattern below, all squares are small whole numbers. */
/* Beside T:die the coefficient of T is that of the first die, which T does nothing to. The sums are
 * those of a least squares fit with contrasts that add up to zero, less that without the term. */
static const char *const dies = "T,die,oven,y\n"
                                "-1,A,p,10.1\n"
                                "0,A,q,9.8\n"
                                "1,A,p,10.3\n"
                                "1,A,q,9.9\n"
                                "-1,B,p,8.2\n"
                                "0,B,q,10.4\n"
                                "1,B,p,11.9\n"
                                "-1,B,q,7.7\n"
                                "-1,C,p,5.8\n"
                                "1,C,q,14.4\n"
                                "1,C,p,13.7\n"
                                "0,C,p,10.2\n"
                                "-1,C,q,6.5\n";

static void partial_squares_are_of_the_mean_over_levels(void **state) {
  static const double sums[] = {33.867935880544564, 0.03151313327845284, 0.030913472070095205,
                                23.837100930897495, 0.017430830039521394};
  static const char *const terms[] = {"T", "die", "oven", "T:die", "T:oven"};
  experiment e;
  (void)state;
  fit(&e, dies, "y ~ T*die + T*oven", NULL);
  for (size_t i = 0; i < e.reg.terms; i++) {
    assert_string_equal(e.reg.partial[i].name, terms[i]);
    assert_near(e.reg.partial[i].sum_of_squares, sums[i], 1e-10);
  }
  drop(&e);
}

static void split_plot_has_two_errors(void **state) {
  static const char text[] = "T,D,load,y\n-1,-1,1,11\n-1,1,1,15\n-1,-1,2,15\n-1,1,2,15\n"
                             "1,-1,3,20\n1,1,3,26\n1,-1,4,24\n1,1,4,26\n";
  fg_context ctx = {0};
  fg_table table;
  fg_formula formula;
  fg_split_plot s;
  (void)state;
  assert_ok(&ctx, fg_table_parse(&ctx, "t", text, strlen(text), &table));
  assert_ok(&ctx, fg_formula_parse(&ctx, "T*D", &formula));
  assert_ok(&ctx, fg_split_plot_analyse(&ctx, &table, &formula, "y", "load", &s));
  /* loads: 13, 15, 23, 25; T: 14 against 24 */
  assert_int_equal(s.terms, 3);
  assert_string_equal(s.term[0].row.name, "T");
  assert_int_equal(s.term[0].whole_plot, 1);
  assert_near(s.term[0].row.sum_of_squares, 200, 1e-12);
  assert_near(s.plot_ss, 8, 1e-12);
  assert_int_equal(s.plot_dof, 2);
  assert_near(s.term[0].row.f, 50, 1e-11);
  /* differences over D within loads: 4, 0, 6, 2 */
  assert_near(s.term[1].row.sum_of_squares, 18, 1e-12);
  assert_near(s.term[2].row.sum_of_squares, 2, 1e-12);
  assert_near(s.run_ss, 8, 1e-12);
  assert_int_equal(s.run_dof, 2);
  assert_near(s.term[1].row.f, 4.5, 1e-12);
  assert_near(s.plot_variance, 0, 1e-12);
  assert_int_equal(s.balanced, 1);
  fg_split_plot_free(&s);
  assert_ok(&ctx, fg_split_plot_analyse(&ctx, &table, &formula, "y", "y", &s));
  fg_split_plot_free(&s);
  assert_status(&ctx, fg_split_plot_analyse(&ctx, &table, &formula, "y", "none", &s), FG_ERR_DATA);
  fg_formula_free(&formula);
  fg_table_free(&table);
}

/* y = 5 + x1 - 2 x2 + 3 x1² + x2² - x1 x2 by its own coefficients, against a fine grid. */
static void optima_beat_a_grid(void **state) {
  static const double signs[] = {1, -1};
  (void)state;
  for (size_t shape = 0; shape < 2; shape++) {
    fg_context ctx = {0};
    /* a bowl, and a saddle */
    fg_surface s = {.factors = 2, .constant = 5, .linear = {1, -2}};
    s.quadratic[0][0] = 3;
    s.quadratic[1][1] = signs[shape];
    s.quadratic[0][1] = s.quadratic[1][0] = -0.5;
    experiment e;
    char text[4000] = "x1,x2,y\n";
    for (int i = -2; i <= 2; i++)
      for (int k = -2; k <= 2; k++) {
        double x[] = {i, k};
        sprintf(text + strlen(text), "%d,%d,%.17g\n", i, k, fg_surface_value(&s, x));
      }
    fit(&e, text, "y ~ x1*x2 + x1^2 + x2^2", NULL);
    assert_ok(&ctx, fg_surface_make(&ctx, &e.model, &e.reg, NULL, &s));
    assert_int_equal(s.kind, shape ? FG_SURFACE_SADDLE : FG_SURFACE_MINIMUM);
    assert_near(2 * (3 * s.stationary[0] - 0.5 * s.stationary[1]) + 1, 0, 1e-12);
    for (int highest = 0; highest < 2; highest++) {
      double low[] = {-1, 0.2}, high[] = {0.5, 1.5}, x[2], ball[2], turn = highest ? -1 : 1;
      double radius = 1.2, best_box = INFINITY, best_ball = INFINITY;
      assert_ok(&ctx, fg_surface_optimum_box(&ctx, &s, highest, low, high, x));
      assert_ok(&ctx, fg_surface_optimum_ball(&ctx, &s, highest, radius, ball));
      for (int i = 0; i <= 400; i++)
        for (int k = 0; k <= 400; k++) {
          double p[] = {low[0] + (high[0] - low[0]) * i / 400,
                        low[1] + (high[1] - low[1]) * k / 400};
          best_box = fmin(best_box, turn * fg_surface_value(&s, p));
          double angle = 6.283185307179586 * i / 400, r = radius * k / 400;
          double q[] = {r * cos(angle), r * sin(angle)};
          best_ball = fmin(best_ball, turn * fg_surface_value(&s, q));
        }
      double box_value = turn * fg_surface_value(&s, x), tolerance = 2e-3;
      assert_true(box_value <= best_box + 1e-12 && box_value > best_box - tolerance);
      double ball_value = turn * fg_surface_value(&s, ball);
      assert_true(hypot(ball[0], ball[1]) <= radius * (1 + 1e-9));
      assert_true(ball_value <= best_ball + 1e-9 && ball_value > best_ball - tolerance);
    }
    drop(&e);
  }
}

/* On a plane the ridge path is steepest descent: -b / |b| times the radius. */
static void planes_are_walked_straight(void **state) {
  experiment e;
  fg_surface s;
  double path[4];
  (void)state;
  fit(&e, "a,b,y\n-1,-1,0\n1,-1,6\n-1,1,8\n1,1,14\n", "y ~ a + b", NULL);
  assert_ok(&e.ctx, fg_surface_make(&e.ctx, &e.model, &e.reg, NULL, &s));
  assert_int_equal(s.kind, FG_SURFACE_PLANE);
  assert_false(s.has_stationary);
  assert_ok(&e.ctx, fg_surface_ridge_path(&e.ctx, &s, false, (double[]){1, 2}, 2, path));
  assert_near(path[0], -0.6, 1e-9);
  assert_near(path[1], -0.8, 1e-9);
  assert_near(path[3], -1.6, 1e-9);
  double low[] = {-1, 3}, high[] = {1, 2}, x[2];
  assert_status(&e.ctx, fg_surface_optimum_box(&e.ctx, &s, false, low, high, x), FG_ERR_USAGE);
  drop(&e);
}

/* The symmetric hard case: y = x2² - x1² is lowest on the ball at (±r, 0), where b = 0. */
static void the_hard_case_has_its_radius(void **state) {
  experiment e;
  fg_surface s;
  double x[2];
  (void)state;
  fit(&e, "a,b,y\n0,0,0\n1,0,-1\n-1,0,-1\n0,1,1\n0,-1,1\n2,1,-3\n", "y ~ a + b + a^2 + b^2", NULL);
  assert_ok(&e.ctx, fg_surface_make(&e.ctx, &e.model, &e.reg, NULL, &s));
  assert_ok(&e.ctx, fg_surface_optimum_ball(&e.ctx, &s, false, 1.5, x));
  assert_near(fabs(x[0]), 1.5, 1e-9);
  assert_near(x[1], 0, 1e-9);
  drop(&e);
}

static void oneway_groups(void **state) {
  fg_context ctx = {0};
  fg_table table;
  fg_anova_oneway a;
  (void)state;
  assert_ok(&ctx, fg_table_parse(&ctx, "t", "g,y\n1,1\n1,3\n2,5\n2,7\n", 20, &table));
  assert_ok(&ctx, fg_anova_oneway_compute(&ctx, &table, "y", "g", &a));
  assert_near(a.between_ss, 16, 0);
  assert_near(a.within_ss, 4, 0);
  assert_near(a.f, 8, 0);
  assert_near(a.group[1].mean, 6, 0);
  assert_near(a.p_value, 0.105572809, 1e-9); /* 1 - sqrt(F / (F + 2)) on 1 and 2 */
  fg_anova_oneway_free(&a);
  assert_status(&ctx, fg_anova_oneway_compute(&ctx, &table, "g", "z", &a), FG_ERR_DATA);
  fg_table_free(&table);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_run),
      cmocka_unit_test(equal_responses),
      cmocka_unit_test(exact_fit),
      cmocka_unit_test(aliases_are_named),
      cmocka_unit_test(an_alias_has_no_share_of_rounding_size),
      cmocka_unit_test(a_fraction_has_its_alias),
      cmocka_unit_test(weights_repeat_runs),
      cmocka_unit_test(leave_one_out_residuals_agree_with_refits),
      cmocka_unit_test(a_lever_run_is_noted),
      cmocka_unit_test(partial_squares_are_drops),
      cmocka_unit_test(partial_squares_are_of_the_mean_over_levels),
      cmocka_unit_test(split_plot_has_two_errors),
      cmocka_unit_test(optima_beat_a_grid),
      cmocka_unit_test(planes_are_walked_straight),
      cmocka_unit_test(the_hard_case_has_its_radius),
      cmocka_unit_test(oneway_groups),
  };
  return cmocka_run_group_tests_name("regression", tests, NULL, NULL);
}

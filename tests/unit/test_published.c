/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Published experiments, to the digits that their authors print: Montgomery, Design and Analysis
 * of Experiments; Box, Hunter and Hunter, Statistics for Experimenters (pilot plant, penicillin);
 * Lenth, Response-surface methods in R, JSS 32-7 (2009); Montgomery, Peck and Vining (acetylene).
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/doe.h"
#include "foilgauge/surface.h"
#include "support/data.h"
#include "support/test.h"

/* One experiment on its way from file to fit. */
typedef struct experiment {
  fg_context ctx;
  fg_table table;
  fg_model model;
  fg_regression reg;
} experiment;

static void check(fg_status status, const experiment *e) {
  if (status != FG_OK) fail_msg("%s", e->ctx.message);
}

static void load(experiment *e, const char *name) {
  char path[120];
  *e = (experiment){0};
  snprintf(path, sizeof path, "doe/%s.csv", name);
  char *text = data_read(path);
  check(fg_table_parse(&e->ctx, name, text, strlen(text), &e->table), e);
  free(text);
}

static void code(experiment *e, const char *text) {
  fg_coding coding;
  check(fg_coding_parse(&e->ctx, text, &coding), e);
  check(fg_coding_apply(&e->ctx, &coding, &e->table), e);
}

static void fit(experiment *e, const char *formula) {
  fg_regression_free(&e->reg);
  fg_model_free(&e->model);
  check(fg_regression_analyse(&e->ctx, &e->table, formula, NULL, NULL, &e->model, &e->reg), e);
}

static void drop(experiment *e) {
  fg_regression_free(&e->reg);
  fg_model_free(&e->model);
  fg_table_free(&e->table);
}

static void near(const char *what, double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance))
    fail_msg("%s: %.10g, %.10g is published", what, value, expected);
}

static const fg_coefficient *coefficient(const experiment *e, const char *name) {
  for (size_t i = 0; i < e->reg.columns; i++)
    if (strcmp(e->reg.coefficient[i].name, name) == 0) return &e->reg.coefficient[i];
  fail_msg("no coefficient %s", name);
  return NULL;
}

static double sequential_ss(const experiment *e, const char *term) {
  for (size_t i = 0; i < e->reg.terms; i++)
    if (strcmp(e->reg.sequential[i].name, term) == 0) return e->reg.sequential[i].sum_of_squares;
  fail_msg("no term %s", term);
  return NAN;
}

typedef struct published {
  const char *name;
  double value;
} published;

/* In a 2^k design coded ±1 an effect is twice the coefficient. */
static void check_effects(const experiment *e, const published *effects, size_t count,
                          double tolerance) {
  for (size_t i = 0; i < count; i++)
    near(effects[i].name, 2 * coefficient(e, effects[i].name)->estimate, effects[i].value,
         tolerance);
}

#define COUNT(array) (sizeof(array) / sizeof *(array))

static void montgomery_etch(void **state) {
  static const published effects[] = {{"A", -101.625},  {"B", 7.375},      {"C", 306.125},
                                      {"A:B", -24.875}, {"A:C", -153.625}, {"B:C", -2.125},
                                      {"A:B:C", 5.625}};
  (void)state;
  experiment e;
  load(&e, "montgomery_etch_2p3x2");
  fit(&e, "y ~ A*B*C");
  check_effects(&e, effects, COUNT(effects), 1e-12);
  near("SS A", sequential_ss(&e, "A"), 41310.5625, 1e-9);
  near("SS C", sequential_ss(&e, "C"), 374850.0625, 1e-9);
  near("SS AC", e.reg.partial[4].sum_of_squares, 94402.5625, 1e-9);
  near("SSE", e.reg.residual_ss, 18020.5, 1e-9);
  near("SST", e.reg.total_ss, 531420.9375, 1e-9);
  near("SE of an effect", 2 * coefficient(&e, "A")->standard_error, 23.7306, 5e-5);
  assert_int_equal(e.reg.residual_dof, 8);
  assert_int_equal(e.reg.pure_dof, 8);
  assert_int_equal(e.reg.lack_dof, 0);
  drop(&e);
}

static void montgomery_filtration(void **state) {
  static const published effects[] = {{"A", 21.625},   {"B", 3.125},     {"C", 9.875},
                                      {"D", 14.625},   {"A:C", -18.125}, {"A:D", 16.625},
                                      {"A:B:D", 4.125}};
  (void)state;
  experiment e;
  load(&e, "montgomery_filtration_2p4");
  fit(&e, "y ~ A*B*C*D");
  check_effects(&e, effects, COUNT(effects), 1e-12);
  near("SS A", sequential_ss(&e, "A"), 1870.56, 5e-3);
  near("SS C", sequential_ss(&e, "C"), 390.06, 5e-3);
  near("SS D", sequential_ss(&e, "D"), 855.56, 5e-3);
  near("SS AC", sequential_ss(&e, "A:C"), 1314.06, 5e-3);
  near("SS AD", sequential_ss(&e, "A:D"), 1105.56, 5e-3);
  assert_int_equal(e.reg.residual_dof, 0);
  assert_true(isnan(e.reg.residual_sd) && isnan(coefficient(&e, "A")->p_value));
  assert_int_equal(e.reg.notes, 1);
  assert_has(e.reg.note[0], "Lenth");
  drop(&e);
}

/* Sorted |effect|: 0.375 0.625 1.125 1.375 1.625 1.875 2.375 2.625 3.125 4.125 9.875 14.625 16.625
 * 18.125 21.625; s0 = 1.5 × 2.625 = 3.9375, cut at 9.84, the median of ten is 1.75: PSE 2.625. */
static void filtration_by_lenth(void **state) {
  (void)state;
  experiment e;
  fg_lenth lenth;
  double effects[15];
  fg_half_normal points[15];
  load(&e, "montgomery_filtration_2p4");
  fit(&e, "y ~ A*B*C*D");
  for (size_t i = 0; i < 15; i++)
    effects[i] = 2 * e.reg.coefficient[i + 1].estimate;
  check(fg_lenth_compute(&e.ctx, effects, 15, 0.95, &lenth), &e);
  near("PSE", lenth.pseudo_standard_error, 2.625, 1e-12);
  near("margin", lenth.margin, 2.570582 * 2.625, 1e-5);
  near("simultaneous margin", lenth.simultaneous_margin, 5.2186514 * 2.625, 1e-6);
  check(fg_half_normal_points(&e.ctx, effects, 15, points), &e);
  assert_int_equal(points[14].effect, 0);
  near("largest", points[14].magnitude, 21.625, 1e-12);
  near("quantile", points[14].quantile, 2.1280452, 1e-6);
  near("median quantile", points[7].quantile, 0.6744898, 1e-6);
  assert_status(&e.ctx, fg_lenth_compute(&e.ctx, effects, 2, 0.95, &lenth), FG_ERR_DATA);
  drop(&e);
}

static void pilot_plant(void **state) {
  static const published effects[] = {{"T", 23},   {"C", -5},  {"K", 1.5},    {"T:C", 1.5},
                                      {"T:K", 10}, {"C:K", 0}, {"T:C:K", 0.5}};
  (void)state;
  experiment e;
  load(&e, "bhh_pilotplant_2p3x2");
  fit(&e, "y ~ T*C*K");
  check_effects(&e, effects, COUNT(effects), 1e-12);
  near("s²", e.reg.residual_sd * e.reg.residual_sd, 8, 1e-12);
  near("SE of an effect", 2 * coefficient(&e, "T")->standard_error, 1.414214, 1e-6);
  drop(&e);
}

static void montgomery_yield(void **state) {
  static const published coefficients[] = {{"(constant)", 79.94}, {"x1", 0.995},
                                           {"x2", 0.515},         {"x1^2", -1.376},
                                           {"x2^2", -1.001},      {"x1:x2", 0.25}};
  (void)state;
  experiment e;
  fg_surface s;
  load(&e, "montgomery_ccd_yield");
  fit(&e, "y ~ x1*x2 + x1^2 + x2^2");
  for (size_t i = 0; i < COUNT(coefficients); i++)
    near(coefficients[i].name, coefficient(&e, coefficients[i].name)->estimate,
         coefficients[i].value, 5e-4);
  near("SSE", e.reg.residual_ss, 0.4964, 6e-5);
  near("lack of fit", e.reg.lack_ss, 0.2844, 6e-5);
  near("pure error", e.reg.pure_ss, 0.2120, 5e-5);
  near("F", e.reg.lack_f, 1.79, 5e-3);
  assert_int_equal(e.reg.lack_dof, 3);
  assert_int_equal(e.reg.pure_dof, 4);
  near("PRESS", e.reg.press, 2.3535, 5e-4);
  near("predicted R²", e.reg.predicted_r2, 0.9181, 5e-5);
  check(fg_surface_make(&e.ctx, &e.model, &e.reg, NULL, &s), &e);
  assert_int_equal(s.kind, FG_SURFACE_MAXIMUM);
  near("x1", s.stationary[0], 0.389, 5e-4);
  near("x2", s.stationary[1], 0.306, 5e-4);
  near("value", s.stationary_value, 80.21, 5e-3);
  near("eigenvalue", s.eigenvalue[0], -0.9634, 2e-4);
  near("eigenvalue", s.eigenvalue[1], -1.4141, 2e-4);
  drop(&e);
}

/* Block 1 alone is a first-order design with centre points; its lack of fit is the curvature. */
static void chemreact_first_block(void **state) {
  (void)state;
  experiment e;
  fg_table first;
  fg_curvature curvature;
  static const size_t rows[] = {0, 1, 2, 3, 4, 5, 6};
  static const char *const factors[] = {"Time", "Temp"};
  load(&e, "rsm_ChemReact");
  code(&e, "Time=80:90");
  code(&e, "Temp=170:180");
  check(fg_table_select(&e.ctx, &e.table, rows, 7, &first), &e);
  fg_table_free(&e.table);
  e.table = first;
  fit(&e, "Yield ~ Time + Temp");
  near("constant", coefficient(&e, "(constant)")->estimate, 82.81429, 5e-6);
  near("its error", coefficient(&e, "(constant)")->standard_error, 0.54719, 5e-6);
  near("Time", coefficient(&e, "Time")->estimate, 0.875, 1e-12);
  near("its error", coefficient(&e, "Time")->standard_error, 0.72386, 5e-6);
  near("Temp", coefficient(&e, "Temp")->estimate, 0.625, 1e-12);
  near("F", e.reg.lack_f, 95.7335, 5e-5);
  near("p", e.reg.lack_p_value, 0.01034, 5e-6);
  /* Lack of fit has two degrees of freedom, the interaction and the curvature. */
  check(fg_curvature_compute(&e.ctx, &e.table, factors, 2, "Yield", &curvature), &e);
  assert_int_equal(curvature.corners, 4);
  assert_int_equal(curvature.centres, 3);
  assert_int_equal(curvature.error_dof, 2);
  fit(&e, "Yield ~ Time*Temp");
  near("curvature", curvature.sum_of_squares, e.reg.lack_ss, 1e-10);
  near("curvature F", curvature.f, e.reg.lack_f, 1e-9);
  drop(&e);
}

static void chemreact_second_order(void **state) {
  static const struct {
    const char *name;
    double estimate, standard_error;
  } published_rows[] = {{"(constant)", 84.095427, 0.079631}, {"BlockB2", -4.457530, 0.087226},
                        {"Time", 0.932541, 0.057699},        {"Temp", 0.577712, 0.057699},
                        {"Time:Temp", 0.125, 0.081592},      {"Time^2", -1.308555, 0.060064},
                        {"Temp^2", -0.933442, 0.060064}};
  (void)state;
  experiment e;
  fg_surface s;
  fg_coding time, temperature;
  load(&e, "rsm_ChemReact");
  code(&e, "Time=80:90");
  code(&e, "Temp=170:180");
  fit(&e, "Yield ~ Block + Time + Temp + Time:Temp + Time^2 + Temp^2");
  for (size_t i = 0; i < COUNT(published_rows); i++) {
    in_row("published_rows[%zu]", i);
    const fg_coefficient *c = coefficient(&e, published_rows[i].name);
    near(c->name, c->estimate, published_rows[i].estimate, 6e-7);
    near(c->name, c->standard_error, published_rows[i].standard_error, 6e-7);
  }
  near("SS Block", sequential_ss(&e, "Block"), 69.531, 5e-4);
  near("SS FO", sequential_ss(&e, "Time") + sequential_ss(&e, "Temp"), 9.626, 6e-4);
  near("SS TWI", sequential_ss(&e, "Time:Temp"), 0.063, 6e-4);
  near("SS PQ", sequential_ss(&e, "Time^2") + sequential_ss(&e, "Temp^2"), 17.791, 6e-4);
  near("residual", e.reg.residual_ss, 0.186, 5e-4);
  near("lack of fit", e.reg.lack_ss, 0.053, 5e-4);
  near("pure error", e.reg.pure_ss, 0.133, 5e-4);
  near("F", e.reg.lack_f, 0.5307, 5e-5);
  near("p", e.reg.lack_p_value, 0.6851, 5e-5);
  check(fg_surface_make(&e.ctx, &e.model, &e.reg, NULL, &s), &e);
  near("Time", s.stationary[0], 0.3722954, 5e-8);
  near("Temp", s.stationary[1], 0.3343802, 5e-8);
  near("eigenvalue", s.eigenvalue[0], -0.9233027, 5e-8);
  near("eigenvalue", s.eigenvalue[1], -1.3186949, 5e-8);
  check(fg_coding_parse(&e.ctx, "Time=80:90", &time), &e);
  check(fg_coding_parse(&e.ctx, "Temp=170:180", &temperature), &e);
  near("Time", fg_coding_to_real(&time, s.stationary[0]), 86.86148, 5e-6);
  near("Temp", fg_coding_to_real(&temperature, s.stationary[1]), 176.67190, 5e-6);
  drop(&e);
}

static void helicopter(void **state) {
  static const published coefficients[] = {
      {"x1", -.083333},  {"x2", 5.083333},  {"x3", .25},       {"x4", -6.083333}, {"x1:x2", -2.875},
      {"x1:x3", -3.75},  {"x1:x4", 4.375},  {"x2:x3", 4.625},  {"x2:x4", -1.5},   {"x3:x4", -2.125},
      {"x1^2", -2.0375}, {"x2^2", -1.6625}, {"x3^2", -2.5375}, {"x4^2", -.1625}};
  static const double stationary[] = {.8607107, -.3307115, -.8394866, -.1161465};
  static const double eigenvalues[] = {3.258222, -1.198324, -3.807935, -4.651963};
  (void)state;
  experiment e;
  fg_surface s;
  load(&e, "rsm_heli");
  fit(&e, "ave ~ factor(block) + (x1+x2+x3+x4)^2 + x1^2 + x2^2 + x3^2 + x4^2");
  for (size_t i = 0; i < COUNT(coefficients); i++)
    near(coefficients[i].name, coefficient(&e, coefficients[i].name)->estimate,
         coefficients[i].value, 5e-7);
  near("SE", coefficient(&e, "x1")->standard_error, .636560, 5e-7);
  near("SE", coefficient(&e, "x1:x2")->standard_error, .779623, 5e-7);
  near("SE", coefficient(&e, "x1^2")->standard_error, .603894, 5e-7);
  near("SS block", sequential_ss(&e, "factor(block)"), 16.81, 5e-3);
  near("SS first order",
       sequential_ss(&e, "x1") + sequential_ss(&e, "x2") + sequential_ss(&e, "x3") +
           sequential_ss(&e, "x4"),
       1510, 0.5);
  near("residual", e.reg.residual_ss, 136.15, 5e-3);
  near("lack of fit", e.reg.lack_ss, 125.40, 5e-3);
  near("pure error", e.reg.pure_ss, 10.75, 5e-3);
  near("F", e.reg.lack_f, 4.6660, 5e-5);
  near("p", e.reg.lack_p_value, 0.0755, 5e-5);
  check(fg_surface_make(&e.ctx, &e.model, &e.reg, NULL, &s), &e);
  assert_int_equal(s.kind, FG_SURFACE_SADDLE);
  for (size_t i = 0; i < 4; i++) {
    near("stationary", s.stationary[i], stationary[i], 6e-8);
    near("eigenvalue", s.eigenvalue[i], eigenvalues[i], 6e-7);
  }
  drop(&e);
}

/* Standardised to mean 0 and sd 1, then squared and multiplied. */
static void acetylene_vif(void **state) {
  static const char *const names[] = {"T", "H2ratio", "contact"};
  static const published vif[] = {
      {"T", 375.25},        {"H2ratio", 1.74},      {"contact", 680.28},
      {"T:H2ratio", 31.04}, {"T:contact", 6563.35}, {"H2ratio:contact", 35.61},
      {"T^2", 1762.58},     {"H2ratio^2", 3.16},    {"contact^2", 1156.77}};
  (void)state;
  experiment e;
  load(&e, "acetylene_vif");
  for (size_t k = 0; k < 3; k++) {
    const fg_extended *x = NULL;
    double mean = 0, sd = 0;
    fg_coding coding = {0};
    check(fg_table_numbers(&e.ctx, &e.table, names[k], &x), &e);
    for (size_t i = 0; i < e.table.rows; i++)
      mean += x[i].value / (double)e.table.rows;
    for (size_t i = 0; i < e.table.rows; i++)
      sd += (x[i].value - mean) * (x[i].value - mean);
    sd = sqrt(sd / (double)(e.table.rows - 1));
    snprintf(coding.name, sizeof coding.name, "%s", names[k]);
    coding.low.value = mean - sd;
    coding.high.value = mean + sd;
    check(fg_coding_apply(&e.ctx, &coding, &e.table), &e);
  }
  fit(&e, "conv ~ (T+H2ratio+contact)^2 + T^2 + H2ratio^2 + contact^2");
  for (size_t i = 0; i < COUNT(vif); i++)
    near(vif[i].name, coefficient(&e, vif[i].name)->vif, vif[i].value, 5.1e-3);
  drop(&e);
}

static void box_cox_powers(void **state) {
  (void)state;
  experiment e;
  fg_box_cox power;
  const fg_extended *y = NULL;
  load(&e, "bhh2_poison.data");
  char formula[80];
  snprintf(formula, sizeof formula, "%s ~ %s + %s", "y", "factor(poison)", "factor(treat)");
  fit(&e, formula);
  check(fg_table_numbers(&e.ctx, &e.table, "y", &y), &e);
  check(fg_box_cox_compute(&e.ctx, &e.model, y, &power), &e);
  near("poison", power.lambda, -0.75, 0.02);
  assert_true(power.low < -0.75 && power.high > -0.75 && power.high < 0);
  assert_true(power.log_likelihood > power.log_likelihood_one + 2);
  drop(&e);
  load(&e, "bhh2_woolen.data");
  fit(&e, "y ~ x1 + x2 + x3");
  check(fg_table_numbers(&e.ctx, &e.table, "y", &y), &e);
  check(fg_box_cox_compute(&e.ctx, &e.model, y, &power), &e);
  near("woolen", power.lambda, -0.06, 0.005);
  drop(&e);
}

static void penicillin(void **state) {
  (void)state;
  experiment e;
  load(&e, "bhh2_penicillin.data");
  fit(&e, "yield ~ factor(blend) + factor(treat)");
  near("SS blends", sequential_ss(&e, "factor(blend)"), 264, 1e-9);
  near("SS treatments", sequential_ss(&e, "factor(treat)"), 70, 1e-9);
  near("SS residual", e.reg.residual_ss, 226, 1e-9);
  near("F blends", e.reg.partial[0].f, 3.51, 6e-3);
  near("F treatments", e.reg.sequential[1].f, 1.24, 5e-3);
  drop(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(montgomery_etch),
      cmocka_unit_test(montgomery_filtration),
      cmocka_unit_test(filtration_by_lenth),
      cmocka_unit_test(pilot_plant),
      cmocka_unit_test(montgomery_yield),
      cmocka_unit_test(chemreact_first_block),
      cmocka_unit_test(chemreact_second_order),
      cmocka_unit_test(helicopter),
      cmocka_unit_test(acetylene_vif),
      cmocka_unit_test(box_cox_powers),
      cmocka_unit_test(penicillin),
  };
  return cmocka_run_group_tests_name("published", tests, NULL, NULL);
}

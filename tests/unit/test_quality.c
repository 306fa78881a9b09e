/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Density, control charts, capability, comparison, gauge study: against R and published answers. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/capability.h"
#include "foilgauge/comparison.h"
#include "foilgauge/control.h"
#include "foilgauge/density.h"
#include "foilgauge/distribution.h"
#include "foilgauge/table.h"
#include "support/data.h"
#include "support/random.h"
#include "support/test.h"

static const double x[] = {3.1, 2.7, 4.4, 5.2, 3.9, 4.8, 2.2, 3.3,
                           6.1, 4.0, 3.6, 5.5, 4.1, 2.9, 3.8};
static const double y[] = {4.9, 5.6, 3.8, 7.9, 6.2, 8.4, 5.1, 4.4, 6.6, 7.2};
enum { NX = sizeof x / sizeof *x, NY = sizeof y / sizeof *y };

/* bw.nrd0, bw.nrd and bw.SJ(method = "ste") of R 4.2. */
static void bandwidths_are_r_s(void **state) {
  (void)state;
  fg_context ctx;
  const struct {
    fg_bandwidth_rule rule;
    double bandwidth, tolerance;
  } expected[] = {{FG_BANDWIDTH_SILVERMAN, 0.547075788457005, 1e-12},
                  {FG_BANDWIDTH_SCOTT, 0.644333706404917, 1e-12},
                  {FG_BANDWIDTH_SHEATHER_JONES, 0.755226846142903, 2e-3}};
  for (size_t i = 0; i < 3; i++) {
    fg_density density;
    assert_ok(&ctx, fg_density_fit(&ctx, x, NX, expected[i].rule, &density));
    assert_near(density.bandwidth, expected[i].bandwidth, expected[i].tolerance);
    fg_density_free(&density);
  }
}

static void density_is_r_s_and_integrates_to_one(void **state) {
  (void)state;
  fg_context ctx;
  fg_density density;
  assert_ok(&ctx, fg_density_fit(&ctx, x, NX, FG_BANDWIDTH_SILVERMAN, &density));
  density.bandwidth = 0.5;
  assert_near(fg_density_at(&density, 4.0), 0.339311221143906, 1e-12);
  double sum = 0;
  for (int i = 0; i < 4000; i++)
    sum += fg_density_at(&density, -6 + 0.005 * i) * 0.005;
  assert_near(sum, 1, 1e-9);
  for (double p = 0.01; p < 1; p += 0.07)
    assert_near(fg_density_probability(&density, fg_density_quantile(&density, p)), p, 1e-9);
  double mode = fg_density_mode(&density);
  assert_true(fg_density_at(&density, mode) >= fg_density_at(&density, mode + 1e-3));
  assert_true(fg_density_at(&density, mode) >= fg_density_at(&density, mode - 1e-3));
  fg_density_free(&density);
}

/* Binning a large sample moves its density by less than the eye or a test could see. */
static void binned_density_is_the_same(void **state) {
  (void)state;
  enum { MANY = 20000 };
  fg_context ctx;
  double *values = malloc(MANY * sizeof *values);
  uint64_t seed = 3;
  for (int i = 0; i < MANY; i++)
    values[i] = random_gaussian(&seed) + (i % 3 ? 0 : 4);
  fg_density density;
  assert_ok(&ctx, fg_density_fit(&ctx, values, MANY, FG_BANDWIDTH_SHEATHER_JONES, &density));
  for (double at = -2; at < 7; at += 0.5) {
    double exact = 0, h = density.bandwidth;
    for (int i = 0; i < MANY; i++)
      exact += exp(-pow((at - values[i]) / h, 2) / 2) / (MANY * h * sqrt(2 * 3.14159265358979));
    assert_near(fg_density_at(&density, at), exact, 1e-4);
  }
  double mean = 0, squares = 0;
  uint64_t draw = 9;
  for (int i = 0; i < MANY; i++)
    mean += fg_density_draw(&density, &draw) / MANY;
  draw = 9;
  for (int i = 0; i < MANY; i++)
    squares += pow(fg_density_draw(&density, &draw) - mean, 2) / MANY;
  assert_near(mean, 4.0 / 3, 0.06);
  assert_near(squares, 1 + 16 * 2.0 / 9 + pow(density.bandwidth, 2), 0.12);
  fg_density_free(&density);
  free(values);
}

static void equal_values_have_no_density(void **state) {
  (void)state;
  fg_context ctx;
  fg_density density;
  const double same[] = {2, 2, 2};
  assert_status(&ctx, fg_density_fit(&ctx, same, 3, FG_BANDWIDTH_SCOTT, &density), FG_ERR_DATA);
  assert_status(&ctx, fg_density_fit(&ctx, same, 0, FG_BANDWIDTH_SCOTT, &density), FG_ERR_DATA);
}

/* Tables of Montgomery, Introduction to Statistical Quality Control. */
static void unbiasing_factors(void **state) {
  (void)state;
  assert_near(fg_chart_c4(2), 0.7979, 5e-5);
  assert_near(fg_chart_c4(9), 0.9693, 5e-5);
  assert_near(fg_chart_d2(2), 1.128, 5e-4);
  assert_near(fg_chart_d2(5), 2.326, 5e-4);
  assert_near(fg_chart_d2(10), 3.078, 5e-4);
}

/* Rules on a long steady series with the pattern at its end, so that the centre stays put. */
static void rules_end_where_they_should(void **state) {
  (void)state;
  enum { STEADY = 400, LONGEST = 16 };
  static const struct {
    unsigned rule;
    double before; /* so that the pattern does not start earlier */
    size_t count, at;
    double values[LONGEST];
  } patterns[] = {
      {1, 0, 1, 0, {3.8}},
      {2, -.5, 9, 8, {.4, .3, .6, .2, .5, .3, .7, .2, .4}},
      {3, -.5, 6, 5, {-1.5, -.8, -.2, .3, .7, 1.6}},
      {4, 1.5, 14, 13, {.4, -.4, .5, -.3, .6, -.5, .3, -.4, .6, -.3, .4, -.6, .5, -.4}},
      {5, 0, 3, 2, {2.5, -.3, 2.6}},
      {6, -.5, 5, 4, {1.4, 1.5, -.2, 1.6, 1.4}},
      {7, 1.5, 15, 14, {.2, -.3, .4, -.2, .3, .1, -.5, .2, .4, -.3, -.2, .3, -.1, .2, -.2}},
      {8, .2, 8, 7, {1.5, -1.4, 1.6, 1.5, -1.4, -1.6, 1.3, -1.5}},
  };
  fg_context ctx;
  uint64_t seed = 11;
  double base[STEADY];
  for (int i = 0; i < STEADY; i++)
    base[i] = random_gaussian(&seed);
  for (size_t p = 0; p < sizeof patterns / sizeof *patterns; p++) {
    in_row("patterns[%zu]", p);
    double values[STEADY + LONGEST];
    fg_chart chart;
    memcpy(values, base, sizeof base);
    values[STEADY - 1] = patterns[p].before;
    memcpy(values + STEADY, patterns[p].values, patterns[p].count * sizeof *values);
    assert_ok(&ctx, fg_chart_individuals(&ctx, values, STEADY + patterns[p].count, 0xFF, &chart));
    unsigned bit = 1u << (patterns[p].rule - 1);
    assert_true(chart.point[STEADY + patterns[p].at].rules & bit);
    if (patterns[p].at > 0) assert_false(chart.point[STEADY + patterns[p].at - 1].rules & bit);
    fg_chart_free(&chart);
  }
  assert_string_equal(fg_run_rule_words(9), "");
}

/* Signals of a steady process, rule by rule, as often as stated. */
static void chance_has_as_many_signals_as_stated(void **state) {
  (void)state;
  enum { POINTS = 400000 };
  fg_context ctx;
  fg_chart chart;
  uint64_t seed = 5;
  double *values = calloc(POINTS, sizeof *values);
  for (int i = 0; i < POINTS; i++)
    values[i] = random_gaussian(&seed);
  for (unsigned rule = 1; rule <= FG_RUN_RULES; rule++) {
    in_row("rule %u", rule);
    unsigned bit = 1u << (rule - 1);
    assert_ok(&ctx, fg_chart_individuals(&ctx, values, POINTS, bit, &chart));
    double stated = fg_chart_chance_signals(POINTS, bit);
    assert_near((double)chart.signals, stated, 0.05 * stated + 8 * sqrt(stated) / 2);
    fg_chart_free(&chart);
  }
  assert_near(fg_chart_chance_signals(200, 0x17), 2.25, 0.03);
  assert_true(fg_chart_chance_signals(8, 0x02) == 0);
  free(values);
}

static void limits_follow_the_subgroups(void **state) {
  (void)state;
  fg_context ctx;
  const double values[] = {1, 2, 3, 2, 4, 1, 3, 2, 2.5};
  const size_t size[] = {3, 2, 0, 4};
  fg_chart means, deviations;
  assert_ok(&ctx, fg_chart_subgroups(&ctx, &(fg_subgroups){values, size, 4}, FG_SIGMA_FROM_SD, 1,
                                     &means, &deviations));
  double sigma = means.sigma;
  assert_near(deviations.sigma, sigma, 0);
  double squares = pow(1 - 2.125, 2) + pow(3 - 2.125, 2) + pow(2 - 2.125, 2) + pow(2.5 - 2.125, 2);
  double s[3] = {1, sqrt(2), sqrt(squares / 3)};
  double expected = (s[0] / fg_chart_c4(3) + s[1] / fg_chart_c4(2) + s[2] / fg_chart_c4(4)) / 3;
  assert_near(sigma, expected, 1e-12);
  assert_int_equal(means.count, 3);
  assert_near(means.point[1].upper - means.point[1].lower, 6 * sigma / sqrt(2), 1e-12);
  assert_near(deviations.point[2].value, s[2], 1e-12);
  fg_chart_free(&means);
  fg_chart_free(&deviations);
}

static fg_table load(const char *name) {
  fg_context ctx;
  fg_table table = {0};
  char *text = data_read(name);
  assert_ok(&ctx, fg_table_parse(&ctx, name, text, strlen(text), &table));
  free(text);
  return table;
}

static double *numbers_of(const fg_table *table, const char *name) {
  fg_context ctx;
  const fg_extended *numbers;
  assert_ok(&ctx, fg_table_numbers(&ctx, table, name, &numbers));
  double *values = malloc(table->rows * sizeof *values);
  for (size_t i = 0; i < table->rows; i++)
    values[i] = numbers[i].value;
  return values;
}

/* qcc's piston rings, samples 1 to 25 of 5: limits and capability as published. */
static void piston_rings(void **state) {
  (void)state;
  fg_context ctx;
  fg_table table = load("doe/qcc_pistonrings.csv");
  double *values = numbers_of(&table, "diameter");
  size_t size[25] = {0};
  fg_chart chart;
  for (int i = 0; i < 25; i++)
    size[i] = 5;
  assert_ok(&ctx, fg_chart_subgroups(&ctx, &(fg_subgroups){values, size, 25}, FG_SIGMA_FROM_RANGE,
                                     1, &chart, NULL));
  double sigma = chart.sigma;
  assert_near(chart.centre, 74.001176, 5e-7);
  assert_near(sigma, 0.0097853, 5e-7);
  assert_near(chart.point[0].lower, 73.98805, 5e-6);
  assert_near(chart.point[0].upper, 74.01430, 5e-6);
  assert_int_equal(chart.signals, 0);
  const fg_capability_input input = {.values = values,
                                     .count = 125,
                                     .lower = 73.95,
                                     .upper = 74.05,
                                     .sigma = sigma,
                                     .sigma_dof = 100,
                                     .stable = true};
  fg_capability result;
  assert_ok(&ctx, fg_capability_compute(&ctx, &input, &result));
  assert_near(result.c.value, 1.7032, 1e-4);
  assert_near(result.ck.value, 1.6632, 1e-4);
  assert_near(result.p.value, 1.6551, 1e-4);
  assert_near(result.pk.value, 1.6162, 1e-4);
  assert_true(result.normal);
  assert_true(result.p.low < result.p.value && result.p.value < result.p.high);
  fg_chart_free(&chart);
  fg_table_free(&table);
  free(values);
}

static void capability_needs_stability(void **state) {
  (void)state;
  fg_context ctx;
  fg_capability result;
  fg_capability_input input = {
      .values = x, .count = NX, .lower = 0, .upper = INFINITY, .sigma = 1, .sigma_dof = 14};
  assert_ok(&ctx, fg_capability_compute(&ctx, &input, &result));
  assert_true(isnan(result.ck.value) && isnan(result.p.value));
  assert_near(result.pk.value, result.mean / (3 * result.sd), 1e-12);
  input.lower = -INFINITY;
  assert_status(&ctx, fg_capability_compute(&ctx, &input, &result), FG_ERR_USAGE);
}

/* 400 lots of 12 groups of 9 values, whose groups have levels of their own: the intervals of Pp and
 * Ppk hold the truth in 95 %, and normal values are called normal in 95 %. */
static void capability_counts_groups(void **state) {
  (void)state;
  enum { LOTS = 400, GROUPS = 12, SIZE = 9, COUNT = GROUPS * SIZE };
  fg_context ctx;
  uint64_t seed = 12;
  double within = 0.3, sigma = hypot(1, within), limit = 4 * sigma, mean = 0.3 * limit;
  size_t size[GROUPS + 1], p = 0, pk = 0, normal = 0;
  double values[COUNT];
  for (size_t i = 0; i <= GROUPS; i++)
    size[i] = i == 3 ? 0 : SIZE;
  for (int lot = 0; lot < LOTS; lot++) {
    for (size_t i = 0; i < GROUPS; i++) {
      double level = mean + random_gaussian(&seed);
      for (size_t k = 0; k < SIZE; k++)
        values[i * SIZE + k] = level + within * random_gaussian(&seed);
    }
    const fg_capability_input input = {.values = values,
                                       .count = COUNT,
                                       .groups = {size, GROUPS + 1},
                                       .lower = -limit,
                                       .upper = limit,
                                       .sigma = NAN};
    fg_capability c;
    assert_ok(&ctx, fg_capability_compute(&ctx, &input, &c));
    double true_pk = (limit - mean) / (3 * sigma);
    p += c.p.low <= limit / (3 * sigma) && limit / (3 * sigma) <= c.p.high;
    pk += c.pk.low <= true_pk && true_pk <= c.pk.high;
    normal += c.normal;
  }
  assert_in_range(p, 0.92 * LOTS, 0.98 * LOTS);
  assert_in_range(pk, 0.92 * LOTS, 0.98 * LOTS);
  assert_in_range(normal, 0.92 * LOTS, LOTS);
}

/* Groups of one value are independent values. */
static void capability_of_groups_of_one(void **state) {
  (void)state;
  fg_context ctx;
  fg_capability alone, grouped;
  size_t size[NX];
  for (size_t i = 0; i < NX; i++)
    size[i] = 1;
  fg_capability_input input = {
      .values = x, .count = NX, .lower = -1, .upper = 30, .sigma = 1, .sigma_dof = 14};
  assert_ok(&ctx, fg_capability_compute(&ctx, &input, &alone));
  input.groups = (fg_value_groups){size, NX};
  assert_ok(&ctx, fg_capability_compute(&ctx, &input, &grouped));
  assert_near(grouped.p.low, alone.p.low, 0);
  assert_near(grouped.pk.high, alone.pk.high, 0);
  assert_near(grouped.normality.a2, alone.normality.a2, 0);
  size[0] = NX; /* one group of all: how groups differ is not known */
  input.groups = (fg_value_groups){size, 1};
  assert_ok(&ctx, fg_capability_compute(&ctx, &input, &grouped));
  assert_near(grouped.p.value, alone.p.value, 0);
  assert_true(isnan(grouped.p.low) && isnan(grouped.pk.high));
}

/* The quantile method on a density that is nearly one normal kernel agrees with the other. */
static void quantiles_agree_where_normal(void **state) {
  (void)state;
  enum { MANY = 4000 };
  fg_context ctx;
  fg_density density;
  fg_capability result;
  double *values = malloc(MANY * sizeof *values);
  for (int i = 0; i < MANY; i++)
    values[i] = fg_distribution_normal_quantile((i + 0.5) / MANY);
  assert_ok(&ctx, fg_density_fit(&ctx, values, MANY, FG_BANDWIDTH_SILVERMAN, &density));
  const fg_capability_input input = {
      .values = values, .count = MANY, .lower = -4, .upper = 5, .sigma = NAN, .density = &density};
  assert_ok(&ctx, fg_capability_compute(&ctx, &input, &result));
  assert_near(result.quantile_p / result.p.value, 1, 0.03);
  assert_near(result.quantile_pk / result.pk.value, 1, 0.03);
  assert_true(result.normal);
  for (int i = 0; i < MANY; i++)
    values[i] = exp(values[i]);
  fg_normality normality;
  assert_ok(&ctx, fg_normality_test(&ctx, values, MANY, &normality));
  assert_true(normality.p_value < 1e-6);
  fg_density_free(&density);
  free(values);
}

/* A² by R: 0.161227772888307. */
static void anderson_darling_is_r_s(void **state) {
  (void)state;
  fg_context ctx;
  fg_normality normality;
  assert_ok(&ctx, fg_normality_test(&ctx, x, NX, &normality));
  assert_near(normality.a2, 0.161227772888307, 1e-12);
  assert_true(normality.p_value > 0.9);
}

/* t.test, var.test and an analysis of variance of the distances from the medians, by R. */
static void comparison_is_r_s(void **state) {
  (void)state;
  fg_context ctx;
  fg_comparison result;
  assert_ok(&ctx,
            fg_comparison_compute(&ctx, (fg_sample){x, NX}, (fg_sample){y, NY}, 0.95, &result));
  assert_near(result.t, -3.65916999921187, 1e-11);
  assert_near(result.dof, 15.0616131999752, 1e-10);
  assert_near(result.p_means, 0.00231174070569478, 1e-12);
  assert_near(result.low, -3.222593003306090, 1e-10);
  assert_near(result.variance_ratio, 0.511754155700473, 1e-12);
  assert_near(result.p_variances, 0.252075038439558, 1e-11);
  assert_near(result.f_high, 1.642372786344825, 1e-10);
  assert_near(result.levene, 2.08364, 5e-6);
  assert_near(result.p_levene, 0.16237, 5e-6);
}

/* AIAG's study of 10 parts, 3 appraisers, 3 trials. */
static void published_gauge_study(void **state) {
  (void)state;
  fg_context ctx;
  fg_table table = load("doe/aiag_grr_10x3x3.csv");
  double *values = numbers_of(&table, "y"), *parts = numbers_of(&table, "part");
  double *trials = numbers_of(&table, "trial"), ordered[90];
  fg_levels who;
  assert_ok(&ctx, fg_table_levels(&ctx, &table, "appraiser", false, &who));
  for (size_t i = 0; i < table.rows; i++)
    ordered[((size_t)parts[i] - 1) * 9 + who.index[i] * 3 + (size_t)trials[i] - 1] = values[i];
  fg_gauge_study study;
  assert_ok(&ctx, fg_gauge_study_compute(&ctx, ordered, 10, 3, 3, &study));
  assert_true(study.pooled);
  assert_near(study.f_interaction, 0.434, 5e-4);
  assert_near(study.ss_operator, 3.1673, 5e-5);
  assert_near(study.ss_part, 88.3619, 5e-5);
  assert_near(study.ss_interaction, 0.3590, 5e-5);
  assert_near(study.ss_repeat, 2.7589, 5e-5);
  assert_near(study.repeatability, 0.199933, 5e-7);
  assert_near(study.reproducibility, 0.226838, 5e-7);
  assert_near(study.grr, 0.302373, 2e-6);
  assert_near(study.part, 1.042327, 5e-7);
  assert_near(study.grr_pct, 27.9, 0.05);
  assert_near(study.distinct_categories, 4.861, 5e-4);
  /* Means and ranges: K1 = 1 / d2, K2 and K3 = 1 / d2* of one set. */
  assert_near(study.range_repeatability, 0.20186, 5e-4);
  assert_near(study.range_reproducibility, 0.22967, 5e-4);
  assert_near(study.range_grr, 0.30577, 5e-4);
  assert_near(study.range_part, 1.1046, 5e-4);
  assert_near(study.range_total, 1.1461, 5e-4);
  fg_levels_free(&who);
  fg_table_free(&table);
  free(values);
  free(parts);
  free(trials);
}

/* GUM H.1: contributions in nm with their degrees of freedom; u 32 nm, nu 16, U at 99 % 93 nm. */
static void gum_end_gauge(void **state) {
  (void)state;
  const double u[] = {25, 5.8, 3.9, 6.7, 2.9, 16.6}, dof[] = {18, 24, 5, 8, 50, 2};
  double squares = 0;
  for (int i = 0; i < 6; i++)
    squares += u[i] * u[i];
  double nu = floor(fg_effective_dof(u, dof, 6));
  assert_near(round(sqrt(squares)), 32, 0);
  assert_near(nu, 16, 0);
  assert_near(fg_distribution_t_quantile(0.995, nu) * 32, 93, 0.6);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bandwidths_are_r_s),
      cmocka_unit_test(density_is_r_s_and_integrates_to_one),
      cmocka_unit_test(binned_density_is_the_same),
      cmocka_unit_test(equal_values_have_no_density),
      cmocka_unit_test(unbiasing_factors),
      cmocka_unit_test(rules_end_where_they_should),
      cmocka_unit_test(chance_has_as_many_signals_as_stated),
      cmocka_unit_test(limits_follow_the_subgroups),
      cmocka_unit_test(piston_rings),
      cmocka_unit_test(capability_needs_stability),
      cmocka_unit_test(capability_counts_groups),
      cmocka_unit_test(capability_of_groups_of_one),
      cmocka_unit_test(quantiles_agree_where_normal),
      cmocka_unit_test(anderson_darling_is_r_s),
      cmocka_unit_test(comparison_is_r_s),
      cmocka_unit_test(published_gauge_study),
      cmocka_unit_test(gum_end_gauge),
  };
  return cmocka_run_group_tests_name("quality statistics", tests, NULL, NULL);
}

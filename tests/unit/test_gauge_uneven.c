/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gauge studies with scans missing, against R's lmer and the analysis of variance. */
#include <math.h>

#include "foilgauge/gauge_uneven.h"
#include "support/test.h"

/* Eight parts, three operators, up to three trials; one cell is empty. */
static const fg_gauge_trial uneven[] = {
    {0, 0, 9.383},  {0, 0, 9.249},  {0, 0, 9.595},  {0, 1, 8.424},  {0, 1, 8.476},  {0, 1, 8.219},
    {0, 2, 9.005},  {0, 2, 9.179},  {1, 0, 9.841},  {1, 1, 9.773},  {1, 1, 9.673},  {1, 2, 9.582},
    {1, 2, 9.465},  {2, 0, 8.831},  {2, 0, 8.763},  {2, 0, 8.84},   {2, 1, 7.992},  {2, 1, 8.202},
    {2, 2, 7.967},  {2, 2, 7.786},  {2, 2, 8.423},  {3, 0, 8.39},   {3, 0, 8.024},  {3, 0, 8.522},
    {3, 2, 8.052},  {3, 2, 8.324},  {3, 2, 8.264},  {4, 0, 11.241}, {4, 0, 11.113}, {4, 0, 11.312},
    {4, 1, 11.023}, {4, 1, 10.83},  {4, 2, 10.94},  {4, 2, 10.93},  {5, 0, 8.978},  {5, 0, 9.054},
    {5, 0, 8.87},   {5, 1, 8.253},  {5, 1, 8.887},  {5, 1, 8.314},  {5, 2, 8.769},  {6, 0, 10.709},
    {6, 0, 10.805}, {6, 1, 10.693}, {6, 2, 10.483}, {7, 0, 11.093}, {7, 0, 10.722}, {7, 1, 9.799},
    {7, 1, 9.869},  {7, 2, 9.619},  {7, 2, 10.15},  {7, 2, 10.13}};
enum { UNEVEN = sizeof uneven / sizeof *uneven };

/* lmer(y ~ 1 + (1|p) + (1|o) + (1|p:o)) of lme4 1.1, and anova() of lm with and without p:o. */
static void uneven_study_is_lmer_s(void **state) {
  (void)state;
  fg_context ctx;
  fg_gauge_study study;
  assert_ok(&ctx, fg_gauge_study_uneven(&ctx, uneven, UNEVEN, &study));
  assert_int_equal(study.parts, 8);
  assert_int_equal(study.operators, 3);
  assert_int_equal(study.trials, 3);
  assert_false(study.pooled);
  assert_near(study.repeatability, 0.193462036, 2e-6);
  assert_near(study.interaction, 0.205909303, 2e-6);
  assert_near(study.reproducibility, hypot(0.265668105, 0.205909303), 3e-6);
  assert_near(study.part, 1.074278282, 1e-5);
  assert_near(study.f_interaction, 3.4114, 5e-5);
  assert_near(study.p_interaction, 0.00291, 5e-6);
  assert_true(isnan(study.range_grr));
}

/* A complete study has the components of the analysis of variance. */
static void complete_study_is_analysis_of_variance(void **state) {
  (void)state;
  enum { PARTS = 5, OPERATORS = 3, TRIALS = 2, ALL = PARTS * OPERATORS * TRIALS };
  static const double part[PARTS] = {1.2, -0.7, 0.3, 2.1, -1.4}, who[OPERATORS] = {0.5, -0.6, 0.2};
  fg_context ctx;
  fg_gauge_study anova, study;
  fg_gauge_trial trial[ALL];
  double value[ALL];
  for (size_t i = 0; i < ALL; i++) {
    size_t p = i / (OPERATORS * TRIALS), o = i / TRIALS % OPERATORS;
    value[i] =
        part[p] + who[o] + 0.3 * sin(7.0 * (double)(p + 11 * o)) + 0.2 * sin(5.0 * (double)(i * i));
    trial[i] = (fg_gauge_trial){p + 3, o + 2, value[i]}; /* indices need not begin at 0 */
  }
  assert_ok(&ctx, fg_gauge_study_compute(&ctx, value, PARTS, OPERATORS, TRIALS, &anova));
  assert_ok(&ctx, fg_gauge_study_uneven(&ctx, trial, ALL, &study));
  assert_int_equal(study.pooled, anova.pooled);
  assert_near(study.p_interaction, anova.p_interaction, 1e-9);
  assert_near(study.repeatability, anova.repeatability, 1e-5);
  assert_near(study.reproducibility, anova.reproducibility, 1e-5);
  assert_near(study.part, anova.part, 1e-5);
}

static void too_little_is_refused(void **state) {
  (void)state;
  fg_context ctx;
  fg_gauge_study study;
  assert_int_equal(fg_gauge_study_uneven(&ctx, uneven, 3, &study), FG_ERR_DATA); /* one operator */
  assert_int_equal(fg_gauge_study_uneven(&ctx, uneven, 0, &study), FG_ERR_DATA);
  fg_gauge_trial alike[7];
  for (size_t i = 0; i < 7; i++)
    alike[i] = (fg_gauge_trial){.part = i / 4, .who = i / 2 % 2, .value = 63.1 + 1e-14 * (double)i};
  assert_int_equal(fg_gauge_study_uneven(&ctx, alike, 7, &study), FG_ERR_DATA);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(uneven_study_is_lmer_s),
      cmocka_unit_test(complete_study_is_analysis_of_variance),
      cmocka_unit_test(too_little_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

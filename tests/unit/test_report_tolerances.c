/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Verdicts of reports: values against tolerances, and missing ones. */
#include "core/json_writer.h"
#include "support/report_fixture.h"
#include "support/test.h"

static void verdict_considers_the_uncertainty(void **state) {
  (void)state;
  const fg_tolerance both = {"x", 1.0, 2.0}, upper = {"x", -INFINITY, 2.0};
  static const struct {
    double value, u;
    fg_verdict verdict, with_upper;
  } cases[] = {
      {1.5, 0.2, FG_VERDICT_PASS, FG_VERDICT_PASS},
      {1.5, 0.3, FG_VERDICT_UNDECIDED, FG_VERDICT_UNDECIDED},
      {1.9, 0.06, FG_VERDICT_UNDECIDED, FG_VERDICT_UNDECIDED},
      {2.1, 0.06, FG_VERDICT_UNDECIDED, FG_VERDICT_UNDECIDED},
      {2.1, 0.04, FG_VERDICT_FAIL, FG_VERDICT_FAIL},
      {0.9, 0.04, FG_VERDICT_FAIL, FG_VERDICT_PASS},
      {2.0, NAN, FG_VERDICT_PASS, FG_VERDICT_PASS},
      {2.0001, NAN, FG_VERDICT_FAIL, FG_VERDICT_FAIL},
      {NAN, 0.1, FG_VERDICT_NOT_MEASURED, FG_VERDICT_NOT_MEASURED},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    assert_int_equal(fg_judge_value(&both, cases[i].value, cases[i].u), cases[i].verdict);
    assert_int_equal(fg_judge_value(&upper, cases[i].value, cases[i].u), cases[i].with_upper);
  }
}

static fg_report_outcome outcome_of(const fixture *all) {
  fg_context ctx = {0};
  fg_report_outcome outcome;
  assert_ok(&ctx, fg_report_judge(&ctx, &all->report, &outcome));
  return outcome;
}

static void a_bump_beyond_its_limit_is_flagged(void **state) {
  fixture *all = *state;
  const fg_foil *foil = &all->measurement.foils[0];
  synthetic_tolerance(&all->design, "radius_error_pct", -INFINITY, 2.0); /* bump 1: 2.195 */
  synthetic_tolerance(&all->design, "overall.radius_mm", 20.9, 21.0);
  assert_int_equal(fg_bump_flags(&all->design, foil, &foil->bumps[0]), FG_BUMP_OUT_OF_TOLERANCE);
  assert_int_equal(fg_bump_flags(&all->design, foil, &foil->bumps[1]), 0);
  fg_report_outcome outcome = outcome_of(all);
  assert_int_equal(outcome.exceeded, 1);
  assert_int_equal(outcome.not_measured, 0);
  assert_int_equal(outcome.verdict, FG_VERDICT_FAIL);
  assert_int_equal(fg_outcome_exit_code(&outcome), 1);

  all->design.tolerances[0].upper = 2.5;
  assert_int_equal(outcome_of(all).verdict, FG_VERDICT_PASS);
  assert_int_equal(fg_bump_flags(&all->design, foil, &foil->bumps[0]), 0);
  all->design.tolerances[1].lower = 20.96;
  assert_int_equal(outcome_of(all).verdict, FG_VERDICT_FAIL);
}

/* Beyond its limit, but within U: neither exceeded nor passed, wherever it is told. */
static void a_value_within_its_uncertainty_is_not_exceeded(void **state) {
  fixture *all = *state;
  const fg_foil *foil = &all->measurement.foils[0];
  synthetic_tolerance(&all->design, "radius_error_pct", -INFINITY, 2.19); /* 2.195 ± 0.013 */
  fg_report_outcome outcome = outcome_of(all);
  assert_int_equal(outcome.exceeded, 0);
  assert_int_equal(outcome.undecided, 1);
  assert_int_equal(fg_outcome_exit_code(&outcome), 3);
  assert_int_equal(fg_bump_flags(&all->design, foil, &foil->bumps[0]), 0);
  cJSON *json = json_of(&all->report);
  assert_true(cJSON_IsFalse(member(first_foil(json), "in_tolerance")));
  const cJSON *first = cJSON_GetArrayItem(member(first_foil(json), "judgements"), 0);
  assert_true(cJSON_IsFalse(member(first, "exceeded")));
  assert_string_equal(member(first, "verdict")->valuestring, "cannot_tell");
  cJSON_Delete(json);
  char *table = text_of(fg_report_write_table, &all->report);
  assert_has(table, "CANNOT TELL: a limit lies within ± of 1 value(s)");
  assert_has_not(table, "out_of_tolerance");
  free(table);
}

static void lose_bump(fg_foil *foil, size_t index) {
  foil->bump_count--;
  memmove(&foil->bumps[index], &foil->bumps[index + 1],
          (foil->bump_count - index) * sizeof *foil->bumps);
}

static void a_missing_bump_rejects_the_foil(void **state) {
  fixture *all = *state;
  fg_context ctx = {0};
  fg_foil *foil = &all->measurement.foils[0];
  fg_decision decision;
  char words[200];
  synthetic_tolerance(&all->design, "height_mm", 0.5, 0.6);
  lose_bump(foil, 3); /* number 4 */
  assert_ok(&ctx, fg_foil_decide(&ctx, &all->design, foil, &decision));
  assert_int_equal(decision.count, 9);
  for (size_t i = 0; i < decision.count; i++) {
    assert_int_equal(decision.judgements[i].verdict, i == 3 ? FG_VERDICT_FAIL : FG_VERDICT_PASS);
    assert_int_equal(decision.judgements[i].missing, i == 3);
  }
  assert_int_equal(decision.outcome.verdict, FG_VERDICT_FAIL);
  assert_int_equal(decision.outcome.rejected, 1);
  assert_int_equal(decision.outcome.exceeded, 0);
  assert_int_equal(fg_outcome_exit_code(&decision.outcome), 1);
  fg_decision_free(&decision);
  assert_true(fg_foil_defect(&all->design, foil, words, sizeof words));
  assert_string_equal(words, "bump 4 is missing (8 found, the design has 9)");
}

/* A gap between bumps is judged without tolerances; another count is not. */
static void other_counts_without_tolerances_are_a_flag(void **state) {
  fixture *all = *state;
  fg_foil *foil = &all->measurement.foils[0];
  lose_bump(foil, 8);
  foil->flags = FG_FOIL_BUMP_COUNT;
  assert_int_equal(outcome_of(all).verdict, FG_VERDICT_NONE);
  lose_bump(foil, 4);
  foil->flags |= FG_FOIL_MISSING_BUMP;
  assert_int_equal(outcome_of(all).verdict, FG_VERDICT_FAIL);
}

/* A border may hide bumps behind the last one that was found. */
static void what_the_border_hides_is_not_measured(void **state) {
  fixture *all = *state;
  fg_foil *foil = &all->measurement.foils[0];
  lose_bump(foil, 8);
  foil->flags = FG_FOIL_BUMP_COUNT | FG_FOIL_TOUCHES_BORDER;
  synthetic_tolerance(&all->design, "thickness_mm", 0.09, 0.11);
  fg_report_outcome outcome = outcome_of(all);
  assert_int_equal(outcome.verdict, FG_VERDICT_NOT_MEASURED);
  assert_int_equal(fg_outcome_exit_code(&outcome), 2);
  synthetic_tolerance(&all->design, "height_mm", 0.5, 0.6);
  assert_int_equal(outcome_of(all).not_measured, 1);
  assert_int_equal(outcome_of(all).rejected, 0);
}

/* Values that were not measured are null, and never within tolerance. */
static void a_foil_that_was_given_up_has_no_values(void **state) {
  fixture *all = *state;
  fg_foil *foil = &all->measurement.foils[0];
  synthetic_tolerance(&all->design, "thickness_mm", 0.09, 0.11);
  foil->bump_count = 0;
  fg_foil_give_up(foil, "no arc was found");
  assert_false(fg_foil_is_measured(foil));
  cJSON *json = json_of(&all->report);
  const cJSON *overall = member(first_foil(json), "overall");
  assert_true(cJSON_IsFalse(member(first_foil(json), "in_tolerance")));
  assert_true(cJSON_IsNull(member(overall, "radius_mm")));
  assert_true(cJSON_IsNull(member(overall, "u_radius_mm")));
  assert_true(cJSON_IsNull(member(overall, "rms_um")));
  assert_true(cJSON_IsNull(member(first_foil(json), "thickness_mm")));
  assert_true(cJSON_IsNull(member(first_foil(json), "orientation")));
  cJSON_Delete(json);
  char *csv = text_of(fg_report_write_csv, &all->report);
  assert_has(csv, "\",1,,not_measured,,,,");
  free(csv);
}

/* Its values stand and are not judged. */
static void a_part_of_another_design_passes_nothing(void **state) {
  fixture *all = *state;
  fg_foil *foil = &all->measurement.foils[0];
  synthetic_tolerance(&all->design, "height_mm", 0.5, 0.6);
  foil->flags = FG_FOIL_NOT_THIS_DESIGN;
  snprintf(foil->error, sizeof foil->error, "47 bumps where the design has 9");
  fg_report_outcome outcome = outcome_of(all);
  assert_int_equal(outcome.verdict, FG_VERDICT_NOT_MEASURED);
  assert_int_equal(fg_bump_verdict(&all->design, foil, foil->bumps), FG_VERDICT_NOT_MEASURED);
  cJSON *json = json_of(&all->report);
  same_fields(first_foil(json), FG_QUANTITY_OF_FOIL, foil);
  assert_true(cJSON_IsFalse(member(first_foil(json), "in_tolerance")));
  assert_null(cJSON_GetObjectItem(first_foil(json), "judgements"));
  cJSON_Delete(json);
  char *table = text_of(fg_report_write_table, &all->report);
  assert_has(table, "NOT MEASURED: 47 bumps where the design has 9");
  free(table);
}

static void an_unknown_tolerance_is_refused(void **state) {
  fixture *all = *state;
  fg_context ctx = {0};
  synthetic_tolerance(&all->design, "thickness_mm", 0.09, 0.11);
  assert_ok(&ctx, fg_report_check_tolerances(&ctx, &all->design));
  synthetic_tolerance(&all->design, "hight_mm", 0, 1);
  assert_status(&ctx, fg_report_check_tolerances(&ctx, &all->design), FG_ERR_DATA);
  assert_has(ctx.message, "tolerances.hight_mm");
  assert_has(ctx.message, "height_mm,");
  assert_int_equal(fg_design_become(NULL, FG_FOIL_DISCS, &all->design), FG_OK);
  all->design.tolerance_count = 1;
  assert_status(&ctx, fg_report_check_tolerances(&ctx, &all->design), FG_ERR_DATA);
}

static void a_margin_is_to_the_limit_that_exists(void **state) {
  (void)state;
  static const struct {
    double lower, upper, value, limit, inside;
  } cases[] = {
      {1, 2, 1.2, 1, 0.2},      {1, 2, 1.9, 2, 0.1},        {1, 2, 2.5, 2, -0.5},
      {1, 2, 0.5, 1, -0.5},     {-INFINITY, 2, -40, 2, 42}, {-INFINITY, 2, 2.5, 2, -0.5},
      {1, INFINITY, 40, 1, 39}, {1, INFINITY, NAN, 1, NAN},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    const fg_margin margin = fg_margin_to(cases[i].lower, cases[i].upper, cases[i].value);
    assert_true(margin.limit == cases[i].limit);
    assert_true(margin.upper == (cases[i].limit == cases[i].upper));
    if (isnan(cases[i].inside))
      assert_true(isnan(margin.inside));
    else
      assert_float_equal(margin.inside, cases[i].inside, 1e-12);
  }
  assert_true(isinf(fg_margin_to(-INFINITY, INFINITY, 1).limit) != 0);
}

/* Judges `quantity` of the whole foil or its first bump. */
static fg_judgement judgement_of(const fixture *all, const char *quantity, int number) {
  fg_context ctx = {0};
  fg_decision decision;
  fg_judgement found = {.severity = NAN};
  assert_ok(&ctx, fg_foil_decide(&ctx, &all->design, &all->measurement.foils[0], &decision));
  for (size_t i = 0; i < decision.count; i++)
    if (!strcmp(decision.judgements[i].tolerance->quantity, quantity) &&
        decision.judgements[i].number == number)
      found = decision.judgements[i];
  fg_decision_free(&decision);
  return found;
}

/* 1 at the limit: of a width, of the way from the nominal, or from 0 of what has no nominal. A
 * large number with room to spare does not come before a small one at its limit. */
static void severity_is_a_share_of_what_is_allowed(void **state) {
  fixture *all = *state;
  fg_foil *foil = &all->measurement.foils[0];
  foil->overall.radius_mm = all->design.overall_radius_mm + 0.02;
  foil->bumps[0].height_mm = all->nominal.height_mm - 0.05;
  foil->bumps[0].radius_error_pct = 4;
  synthetic_tolerance(&all->design, "overall.radius_mm", -INFINITY,
                      all->design.overall_radius_mm + 0.14);
  synthetic_tolerance(&all->design, "height_mm", all->nominal.height_mm - 0.06, INFINITY);
  synthetic_tolerance(&all->design, "radius_error_pct", -INFINITY, 5);
  const fg_judgement radius = judgement_of(all, "overall.radius_mm", 0),
                     height = judgement_of(all, "height_mm", 1),
                     error = judgement_of(all, "radius_error_pct", 1);
  assert_float_equal(radius.severity, 1.0 / 7, 1e-9);
  assert_float_equal(height.severity, 5.0 / 6, 1e-9);
  assert_float_equal(error.severity, 0.8, 1e-9);
  assert_true(fg_judgement_compare(&height, &radius) < 0);
  all->design.tolerances[0].lower = all->design.overall_radius_mm - 0.06;
  assert_float_equal(judgement_of(all, "overall.radius_mm", 0).severity, 0.2, 1e-9);
}

/* A verdict ranks before any severity. */
static void a_failing_value_comes_before_one_that_cannot_be_told(void **state) {
  (void)state;
  const fg_judgement fail = {.verdict = FG_VERDICT_FAIL, .severity = 1.1, .number = 3},
                     open = {.verdict = FG_VERDICT_UNDECIDED, .severity = 1.5},
                     missing = {.verdict = FG_VERDICT_NOT_MEASURED, .severity = INFINITY},
                     pass = {.verdict = FG_VERDICT_PASS, .severity = 0.99},
                     same = {.verdict = FG_VERDICT_FAIL, .severity = 1.1, .number = 4};
  assert_true(fg_judgement_compare(&fail, &missing) < 0);
  assert_true(fg_judgement_compare(&missing, &open) < 0);
  assert_true(fg_judgement_compare(&open, &pass) < 0);
  assert_true(fg_judgement_compare(&fail, &same) < 0);
  assert_true(fg_judgement_compare(&pass, &open) > 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      REPORT_TEST(verdict_considers_the_uncertainty),
      REPORT_TEST(a_margin_is_to_the_limit_that_exists),
      REPORT_TEST(severity_is_a_share_of_what_is_allowed),
      REPORT_TEST(a_failing_value_comes_before_one_that_cannot_be_told),
      REPORT_TEST(a_bump_beyond_its_limit_is_flagged),
      REPORT_TEST(a_value_within_its_uncertainty_is_not_exceeded),
      REPORT_TEST(a_missing_bump_rejects_the_foil),
      REPORT_TEST(other_counts_without_tolerances_are_a_flag),
      REPORT_TEST(what_the_border_hides_is_not_measured),
      REPORT_TEST(a_foil_that_was_given_up_has_no_values),
      REPORT_TEST(a_part_of_another_design_passes_nothing),
      REPORT_TEST(an_unknown_tolerance_is_refused),
  };
  return cmocka_run_group_tests_name("report tolerances", tests, NULL, NULL);
}

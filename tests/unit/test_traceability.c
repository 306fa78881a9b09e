/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Traceability of lengths: states, words, due dates, and verdicts that need a known scale. */
#include "foilgauge/report.h"
#include "foilgauge/traceability.h"
#include "support/synthetic_foil.h"
#include "support/test.h"

#define DESIGN      "{\"schema\": \"foilgauge/design/1\""
#define CALIBRATION DESIGN ", \"calibration\": "
#define SCALE       "\"scale\": {\"u_rel\": 1e-4}"

static fg_status parse(fg_context *ctx, const char *json, fg_design *design) {
  fg_design_default(design);
  return fg_design_parse(ctx, "d.json", json, design);
}

static fg_design design_of(const char *json) {
  fg_context ctx = {0};
  fg_design design;
  assert_ok(&ctx, parse(&ctx, json, &design));
  return design;
}

static void every_design_has_a_state(void **state) {
  (void)state;
  const struct {
    const char *json;
    fg_traceability state;
    bool may_judge;
    const char *sentence;
  } cases[] = {
      {DESIGN "}", FG_TRACED_TO_NONE, false, "none: nothing is known of the scanner's scale"},
      {CALIBRATION "null}", FG_TRACED_TO_NONE, false, "none: nothing is known"},
      {CALIBRATION "\"not needed: angles alone\"}", FG_TRACED_TO_NONE, true,
       "none; no calibration is needed: angles alone"},
      {CALIBRATION "\"flatbed\"}", FG_TRACED_TO_STATED, true,
       "stated: the default for an unknown flatbed"},
      {CALIBRATION "{" SCALE "}}", FG_TRACED_TO_STATED, true,
       "stated: a calibration without a certificate"},
      {CALIBRATION "{\"certificate\": \"K 7\", \"date\": \"2026-03-14\", " SCALE "}}",
       FG_TRACED_TO_STATED, true, "stated: K 7 of 2026-03-14"},
      {CALIBRATION "{\"artefact\": \"GP-17\", \"certificate\": \"K 7\", \"date\": \"2026-03-14\", "
                   "\"due\": \"2027-03-14\", " SCALE "}}",
       FG_TRACED_TO_PLATE, true, "plate: GP-17, certificate K 7 of 2026-03-14, due 2027-03-14"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    fg_design design = design_of(cases[i].json);
    char sentence[FG_TRACEABILITY_SENTENCE];
    fg_traceability_sentence(&design, sentence, sizeof sentence);
    assert_int_equal(fg_design_traceability(&design), cases[i].state);
    assert_int_equal(fg_design_may_judge(&design), cases[i].may_judge);
    assert_has(sentence, cases[i].sentence);
  }
}

static void a_models_gauges_are_stated_or_a_plate(void **state) {
  (void)state;
  fg_design design = design_of(DESIGN "}");
  char sentence[FG_TRACEABILITY_SENTENCE];
  design.model_scale.known = true;
  fg_traceability_sentence(&design, sentence, sizeof sentence);
  assert_string_equal(sentence, "stated: gauges of known size, without a certificate");
  strcpy(design.model_scale.artefact.name, "GP-17");
  assert_int_equal(fg_design_traceability(&design), FG_TRACED_TO_PLATE);
}

static void wrong_words_and_dates_are_refused(void **state) {
  (void)state;
  static const char *const cases[][2] = {
      {CALIBRATION "\"not needed\"}", "with its reason"},
      {CALIBRATION "\"not needed: \"}", "with its reason"},
      {CALIBRATION "\"not neededed\"}", "with its reason"},
      {CALIBRATION "\"none\"}", "neither an object nor \"flatbed\""},
      {CALIBRATION "{\"due\": \"next year\", " SCALE "}}", "due"},
      {CALIBRATION "{\"artefact\": \"GP-17\"}}", "scale"},
      {DESIGN ", \"artefact\": {}}", "name"},
      {DESIGN ", \"artefact\": {\"name\": \"\"}}", "artefact has no name"},
      {DESIGN ", \"artefact\": {\"name\": \"a\", \"date\": \"2026-13-14\"}}", "is no date"},
      {DESIGN ", \"artefact\": {\"name\": \"a\", \"date\": \"2026-03-14\", \"due\": "
              "\"2026-03-14\"}}",
       "is not after its date"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    fg_context ctx = {0};
    fg_design design;
    assert_status(&ctx, parse(&ctx, cases[i][0], &design), FG_ERR_DATA);
    assert_has(ctx.message, cases[i][1]);
  }
}

static void a_scan_after_the_due_date_is_refused(void **state) {
  (void)state;
  fg_context ctx = {0};
  fg_artefact artefact = {.name = "GP-17", .due = "2026-03-14"};
  assert_ok(&ctx, fg_artefact_check_due(&ctx, "m.json", &artefact, "2026-03-14T23:59"));
  assert_ok(&ctx, fg_artefact_check_due(&ctx, "m.json", &artefact, ""));
  assert_status(&ctx, fg_artefact_check_due(&ctx, "m.json", &artefact, "2026-03-15"), FG_ERR_DATA);
  assert_has(ctx.message, "m.json: GP-17 was due for calibration on 2026-03-14");
  artefact.due[0] = '\0';
  assert_ok(&ctx, fg_artefact_check_due(&ctx, "m.json", &artefact, "2099-01-01"));
}

/* A pass and a fail need a known scale; a value that is not measured stays so. */
static void no_limit_is_judged_without_a_scale(void **state) {
  (void)state;
  fg_design design = synthetic_design();
  const fg_tolerance limit = {.quantity = "radius_mm", .lower = 3, .upper = 4};
  const fg_tolerance strip = {.quantity = "thickness_mm", .lower = 0, .upper = 1};
  const fg_quantity *radius = fg_quantity_find(FG_QUANTITY_OF_BUMP, "radius_mm");
  const fg_quantity *thickness = fg_quantity_find(FG_QUANTITY_OF_FOIL, "thickness_mm");
  assert_int_equal(fg_judge_measured(&design, &limit, radius, 3.5, 0.01), FG_VERDICT_PASS);
  assert_int_equal(fg_judge_measured(&design, &limit, radius, 5, 0.01), FG_VERDICT_FAIL);
  design.calibration.not_needed[0] = '\0';
  assert_int_equal(fg_judge_measured(&design, &limit, radius, 3.5, 0.01), FG_VERDICT_UNDECIDED);
  assert_int_equal(fg_judge_measured(&design, &limit, radius, 5, 0.01), FG_VERDICT_UNDECIDED);
  assert_int_equal(fg_judge_measured(&design, &limit, radius, NAN, NAN), FG_VERDICT_NOT_MEASURED);
  assert_int_equal(fg_judge_measured(&design, &strip, thickness, 0.1, 0.01), FG_VERDICT_UNDECIDED);
  design.thickness_measured_mm = 0.1;
  assert_int_equal(fg_judge_measured(&design, &strip, thickness, 0.1, 0.01), FG_VERDICT_PASS);
  assert_int_equal(fg_judge_measured(&design, &limit, radius, 3.5, 0.01), FG_VERDICT_UNDECIDED);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_design_has_a_state),
      cmocka_unit_test(a_models_gauges_are_stated_or_a_plate),
      cmocka_unit_test(wrong_words_and_dates_are_refused),
      cmocka_unit_test(a_scan_after_the_due_date_is_refused),
      cmocka_unit_test(no_limit_is_judged_without_a_scale),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

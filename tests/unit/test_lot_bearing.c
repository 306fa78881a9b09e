/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clearance around the bearings of a made lot: where the bumps stand, which foil is meant. */
#include "support/made_lot.h"
#include "support/test.h"

/* Three foils of the design; bump 9 of the second stands highest. */
static fg_lot nine_bumps(const fg_design *design) {
  fg_lot lot = made_lot(design, 3, design->bumps.count, "", NULL);
  for (size_t i = 0; i < 3; i++)
    for (size_t k = 0; k < design->bumps.count; k++)
      made_bump(&lot, i, k, 3.40, 63.15 * 3.32 / 3.40);
  made_bump(&lot, 1, design->bumps.count - 1, 3.20, 65.6);
  return lot;
}

static const fg_lot_bearing *only_bearing(const fg_lot *lot, fg_lot_analysis *analysis) {
  assert_ok(&test_context, fg_lot_analyse(&test_context, lot, analysis));
  assert_int_equal(analysis->bearing_count, 1);
  assert_true(analysis->bearings[0].known);
  return &analysis->bearings[0];
}

static void a_recipe_without_a_layout_has_the_design_s(void **state) {
  (void)state;
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  fg_lot lot = nine_bumps(&design);
  const fg_lot_bearing *bearing = only_bearing(&lot, &analysis);
  const fg_bump *highest = &lot.records[1].foils[0].bumps[8];
  assert_int_equal(analysis.layout.pads, 3);
  assert_int_equal(bearing->places, 27);
  assert_int_equal(bearing->clearance.count, 27);
  assert_near(bearing->angle_deg[1], 40.0 / 3, 1e-9);
  assert_near(bearing->clearance.min_mm, highest->clearance_fitted_mm, 1e-12);
  assert_near(bearing->clearance.min_at_deg, 120 + 8 * 40.0 / 3, 1e-9);
  assert_string_equal(analysis.layout_note, "");
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* Foils of another design: as many pads as fit, each bump where the pitch puts it. */
static void pads_are_as_many_as_fit(void **state) {
  (void)state;
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  design.bumps.count = 7;
  design.bumps.pitch_deg = 14.5;
  fg_lot lot = nine_bumps(&design);
  const fg_lot_bearing *bearing = only_bearing(&lot, &analysis);
  assert_int_equal(analysis.layout.pads, 3);
  assert_int_equal(bearing->places, 21);
  assert_near(bearing->angle_deg[6], 6 * 14.5, 1e-9);
  assert_near(bearing->angle_deg[7], 120, 1e-9);
  assert_string_equal(analysis.layout_note, "");
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* The layout that a recipe states is kept, and a note names its contradictions to the design. */
static void a_stated_layout_is_kept(void **state) {
  (void)state;
  fg_context ctx;
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  fg_lot lot = nine_bumps(&design);
  assert_ok(&ctx, fg_lot_settings_parse(&ctx, "r.json",
                                        "{\"schema\": \"foilgauge/recipe/1\", \"pads\": 3, "
                                        "\"bumps_per_pad\": 7}",
                                        &lot.settings));
  const fg_lot_bearing *bearing = only_bearing(&lot, &analysis);
  assert_int_equal(bearing->places, 21);
  assert_near(bearing->angle_deg[1], 360.0 / 21, 1e-9);
  assert_has(analysis.layout_note, "bumps 1 to 7 of each foil");
  assert_has(analysis.layout_note, "17.14");
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* A design that does not state its bumps: those that are there. */
static void bumps_that_the_design_does_not_count_are_counted(void **state) {
  (void)state;
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  fg_lot lot = nine_bumps(&design);
  lot.settings.design.bumps.count = 0;
  assert_int_equal(only_bearing(&lot, &analysis)->places, 27);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* More bumps than a bearing can have: as many as there is room for, and it is said. */
static void a_crowded_design_keeps_within_the_bearing(void **state) {
  (void)state;
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  fg_lot lot = nine_bumps(&design);
  lot.settings.design.bumps.count = 400;
  lot.settings.design.bumps.pitch_deg = 0.9;
  assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
  assert_true(analysis.layout.pads * analysis.layout.bumps_per_pad <= FG_BEARING_BUMPS_MAX);
  assert_has(analysis.layout_note, "400 bumps");
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* Foils that have opened: the bearing's clearances are those of the foils pressed into it. */
static void bearings_are_of_fitted_foils(void **state) {
  (void)state;
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  fg_lot lot = made_lot(&design, 3, 9, "", NULL);
  for (size_t i = 0; i < 3; i++) {
    lot.records[i].foils[0].overall.radius_mm = 23.56;
    for (size_t k = 0; k < 9; k++)
      made_bump(&lot, i, k, 3.32, 63.15);
  }
  const fg_lot_bearing *bearing = only_bearing(&lot, &analysis);
  const fg_bump *bump = &lot.records[0].foils[0].bumps[0];
  assert_near(bearing->clearance.mean_mm, lot.nominal.clearance_mm, 1e-12);
  assert_near(1000 * (bump->clearance_mm - bearing->clearance.mean_mm), 8.79, 0.01);
  assert_near(analysis.clearance_fitted_pct.mean, 0, 1e-9);
  assert_near(analysis.clearance_pct.mean, 100 * 8.79 / 65.473, 0.02);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* Nine foils of the design for three bearings, judged by the room of a centred rotor. */
static fg_lot toleranced(const char *const *cells, double lower) {
  fg_design design;
  fg_design_default(&design);
  design.tolerance_count = 1;
  strcpy(design.calibration.not_needed, "the foils are made up");
  design.tolerances[0] = (fg_tolerance){"clearance_centred_min_mm", lower, INFINITY};
  fg_lot lot = made_lot(&design, 9, 9, cells ? ",bearing,pad" : "", cells);
  for (size_t i = 0; i < 9; i++)
    for (size_t k = 0; k < 9; k++)
      made_bump(&lot, i, k, 3.32, 63.15);
  return lot;
}

static int code_of(const fg_lot *lot, fg_lot_analysis *analysis) {
  assert_ok(&test_context, fg_lot_analyse(&test_context, lot, analysis));
  return fg_outcome_exit_code(&analysis->outcome);
}

/* Verdicts of bearings are the lot's: at the design the room is 65.47 um, known to 2 × 0.01. */
static void bearings_are_judged(void **state) {
  (void)state;
  static const struct {
    double lower;
    int code;
    fg_verdict verdict;
  } cases[] = {{0.0650, 0, FG_VERDICT_PASS},
               {0.06547, 3, FG_VERDICT_UNDECIDED},
               {0.0656, 1, FG_VERDICT_FAIL}};
  fg_lot_analysis analysis;
  for (size_t i = 0; i < 3; i++) {
    fg_lot lot = toleranced(NULL, cases[i].lower);
    made_bump(&lot, 5, 3, 3.325, 63.15 * 3.32 / 3.325); /* a little more room */
    assert_int_equal(code_of(&lot, &analysis), cases[i].code);
    assert_int_equal(analysis.bearing_count, 3);
    assert_int_equal(analysis.bearings_by_verdict[cases[i].verdict], 3);
    assert_near(analysis.bearings[0].clearance.u_centred_min_mm, 1e-5, 1e-9);
    assert_near(analysis.bearings[0].clearance.u_circularity_mm, 0, 1e-9);
    /* The worst foil is named by its height: no tolerance of a foil says which it is. */
    assert_non_null(analysis.worst[0]->worst_row);
    fg_lot_analysis_free(&analysis);
    made_lot_free(&lot);
  }
}

/* One bad foil fails its own bearing; a crushed bump leaves another one not measured. */
static void only_the_bearing_with_the_bad_foil_fails(void **state) {
  (void)state;
  static const char *const cells[] = {",a,1", ",b,1", ",c,1", ",a,2", ",b,2",
                                      ",c,2", ",a,3", ",b,3", ",c,3"};
  fg_lot_analysis analysis;
  fg_lot lot = toleranced(cells, 0.05);
  for (size_t k = 0; k < 9; k++)
    made_bump(&lot, 4, k, 3.0, 70);
  assert_int_equal(code_of(&lot, &analysis), 1);
  assert_int_equal(analysis.bearings[1].decision.outcome.verdict, FG_VERDICT_FAIL);
  assert_int_equal(analysis.bearings_by_verdict[FG_VERDICT_PASS], 2);
  fg_lot_analysis_free(&analysis);
  lot.records[0].foils[0].bumps[3].flags |= FG_BUMP_CRUSHED;
  assert_int_equal(code_of(&lot, &analysis), 2);
  assert_int_equal(analysis.bearings[0].decision.outcome.verdict, FG_VERDICT_NOT_MEASURED);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* Foils without a bearing are counted, so are two for one pad and pads that are none; a bearing of
 * foils that could not be measured is there, and not measured. */
static void the_manifest_is_taken_at_its_word(void **state) {
  (void)state;
  static const char *const cells[] = {",a,1", ",a,2", ",a,3", ",a,3", ",,",
                                      ",b,x", ",b,2", ",b,3", ",c,1"};
  fg_lot_analysis analysis;
  fg_lot lot = toleranced(cells, 0.05);
  fg_foil_give_up(&lot.records[8].foils[0], "a test");
  assert_int_equal(code_of(&lot, &analysis), 2);
  assert_int_equal(analysis.bearing_count, 3);
  assert_int_equal(analysis.unplaced.without, 1);
  assert_int_equal(analysis.unplaced.displaced, 1);
  assert_int_equal(analysis.unplaced.bad_pads, 1);
  assert_ptr_equal(analysis.bearings[0].pad[2], &analysis.foils[2]);
  assert_int_equal(analysis.bearings_by_verdict[FG_VERDICT_PASS], 2);
  assert_int_equal(analysis.bearings[2].decision.outcome.verdict, FG_VERDICT_NOT_MEASURED);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* One foil makes no bearing: what the design asks of bearings is not measured, never a pass. */
static void no_bearing_is_no_pass(void **state) {
  (void)state;
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  design.tolerance_count = 1;
  strcpy(design.calibration.not_needed, "the foils are made up");
  design.tolerances[0] = (fg_tolerance){"circularity_mm", -INFINITY, 0.05};
  fg_lot lot = made_lot(&design, 1, 9, "", NULL);
  for (size_t k = 0; k < 9; k++)
    made_bump(&lot, 0, k, 3.32, 63.15);
  assert_int_equal(code_of(&lot, &analysis), 2);
  assert_int_equal(analysis.unplaced.without, 1);
  assert_int_equal(analysis.outcome.verdict, FG_VERDICT_NOT_MEASURED);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_recipe_without_a_layout_has_the_design_s),
      cmocka_unit_test(pads_are_as_many_as_fit),
      cmocka_unit_test(a_stated_layout_is_kept),
      cmocka_unit_test(bumps_that_the_design_does_not_count_are_counted),
      cmocka_unit_test(a_crowded_design_keeps_within_the_bearing),
      cmocka_unit_test(bearings_are_of_fitted_foils),
      cmocka_unit_test(bearings_are_judged),
      cmocka_unit_test(only_the_bearing_with_the_bad_foil_fails),
      cmocka_unit_test(the_manifest_is_taken_at_its_word),
      cmocka_unit_test(no_bearing_is_no_pass),
  };
  return cmocka_run_group_tests_name("bearings of a lot", tests, NULL, NULL);
}

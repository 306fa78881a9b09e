/* Clearance around the bearings of a made lot: where the bumps stand, which foil is meant. */
#include "support/made_lot.h"
#include "support/near.h"

/* Three foils of the design; bump 9 of the second stands highest. */
static fg_lot nine_bumps(const fg_design *design) {
  fg_lot lot = made_lot(design, 3, design->bump_count, "", NULL);
  for (size_t i = 0; i < 3; i++)
    for (size_t k = 0; k < design->bump_count; k++)
      made_bump(&lot, i, k, 3.40, 63.15 * 3.32 / 3.40);
  made_bump(&lot, 1, design->bump_count - 1, 3.20, 65.6);
  return lot;
}

static const fg_lot_bearing *only_bearing(const fg_lot *lot, fg_lot_analysis *analysis) {
  assert_int_equal(fg_lot_analyse(NULL, lot, analysis), FG_OK);
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
  assert_near(bearing->clearance.least_mm, highest->clearance_fitted_mm, 1e-12);
  assert_near(bearing->clearance.least_at_deg, 120 + 8 * 40.0 / 3, 1e-9);
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
  design.bump_count = 7;
  design.pitch_deg = 14.5;
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

/* What a recipe states stands, and what of it contradicts the design is said. */
static void a_stated_layout_stands(void **state) {
  (void)state;
  fg_context ctx;
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  fg_lot lot = nine_bumps(&design);
  assert_int_equal(fg_lot_settings_parse(&ctx, "r.json",
                                         "{\"schema\": \"foilgauge/recipe/1\", \"pads\": 3, "
                                         "\"bumps_per_pad\": 7}",
                                         &lot.settings),
                   FG_OK);
  const fg_lot_bearing *bearing = only_bearing(&lot, &analysis);
  assert_int_equal(bearing->places, 21);
  assert_near(bearing->angle_deg[1], 360.0 / 21, 1e-9);
  assert_non_null(strstr(analysis.layout_note, "bumps 1 to 7 of each foil"));
  assert_non_null(strstr(analysis.layout_note, "17.14"));
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
  lot.settings.design.bump_count = 0;
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
  lot.settings.design.bump_count = 400;
  lot.settings.design.pitch_deg = 0.9;
  assert_int_equal(fg_lot_analyse(NULL, &lot, &analysis), FG_OK);
  assert_true(analysis.layout.pads * analysis.layout.bumps_per_pad <= FG_BEARING_BUMPS_MAX);
  assert_non_null(strstr(analysis.layout_note, "400 bumps"));
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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_recipe_without_a_layout_has_the_design_s),
      cmocka_unit_test(pads_are_as_many_as_fit),
      cmocka_unit_test(a_stated_layout_stands),
      cmocka_unit_test(bumps_that_the_design_does_not_count_are_counted),
      cmocka_unit_test(a_crowded_design_keeps_within_the_bearing),
      cmocka_unit_test(bearings_are_of_fitted_foils),
  };
  return cmocka_run_group_tests_name("bearings of a lot", tests, NULL, NULL);
}

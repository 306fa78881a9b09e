/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bearings drawn from the foils of a made lot: which foils take part, and what the three lines say.
 */
#include "support/made_lot.h"
#include "support/test.h"

/* Foils of one radius each at constant arc length, and how far their bumps scatter about it. */
static fg_lot lot_of(const fg_design *design, size_t foils, const double *radius, double scatter,
                     const char *columns, const char *const *cells) {
  fg_lot lot = made_lot(design, foils, 9, columns, cells);
  for (size_t i = 0; i < foils; i++)
    for (size_t k = 0; k < 9; k++) {
      double r = radius[i] + scatter * (double)(((i + 1) * (k + 2) * 7) % 11) / 11;
      made_bump(&lot, i, k, r, 63.15 * 3.32 / r);
    }
  return lot;
}

static fg_design toleranced(const char *quantity, double lower, double upper) {
  fg_design design;
  fg_design_default(&design);
  design.tolerance_count = 1;
  strcpy(design.calibration.not_needed, "the foils are made up");
  design.tolerances[0] = (fg_tolerance){.lower = lower, .upper = upper};
  strcpy(design.tolerances[0].quantity, quantity);
  return design;
}

static const fg_lot_assembly *analyse(const fg_lot *lot, fg_lot_analysis *analysis) {
  fg_context ctx;
  if (fg_lot_analyse(&ctx, lot, analysis) != FG_OK) fail_msg("%s", ctx.message);
  return &analysis->assembly;
}

static void said(const fg_lot_assembly *assembly, int line, const char *words) {
  if (!strstr(assembly->statement[line], words))
    fail_msg("'%s' lacks '%s'", assembly->statement[line], words);
}

static void a_good_lot_assembles(void **state) {
  (void)state;
  static const double radius[] = {3.40, 3.40, 3.40, 3.40, 3.40, 3.40, 3.40};
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  fg_lot lot = lot_of(&design, 7, radius, 0, "", NULL);
  const fg_lot_assembly *assembly = analyse(&lot, &analysis);
  assert_true(assembly->asked && assembly->centred);
  assert_int_equal(assembly->stock.foils, 7);
  assert_int_equal(assembly->plan.limits, 2);
  assert_int_equal(assembly->drawn.assembled.count, 1000);
  assert_near(assembly->drawn.quantile[0][2], 0, 1e-12);
  said(assembly, 0, "1000 of 1000 bearings drawn from 7 foils assemble: 100.0 %");
  said(assembly, 0, "2.0 of the 2 bearings");
  said(assembly, 1, "Nothing rejects any");
  said(assembly, 2, "no change can show more");
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* Every bump is too high by the same: a change of the mean radius is the cure. */
static void the_largest_change_wins(void **state) {
  (void)state;
  static const double low[] = {3.20, 3.20, 3.20, 3.20, 3.20, 3.20};
  static const double apart[] = {3.20, 3.60, 3.20, 3.60, 3.20, 3.60};
  static const double same[] = {3.32, 3.32, 3.32, 3.32, 3.32, 3.32};
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  design.bumps.rotor_diameter_mm = 40.11; /* 10.5 um at design, at 3.20 mm less than nothing */
  fg_lot lot = lot_of(&design, 6, low, 0.001, "", NULL);
  const fg_lot_assembly *assembly = analyse(&lot, &analysis);
  assert_int_equal(assembly->drawn.assembled.count, 0);
  said(assembly, 1, "What rejects the other 1000: least clearance of a rotor where it is largest");
  said(assembly, 2, "What would change it most: the mean bump radius at the design's");
  assert_string_equal(assembly->change[0].name, "mean_radius_at_design");
  assert_near(assembly->change[0].share, 1, 0);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);

  /* Two kinds of foil: like with like makes round bearings of all. */
  design = toleranced("circularity_mm", -INFINITY, 0.020);
  lot = lot_of(&design, 6, apart, 0, "", NULL);
  assembly = analyse(&lot, &analysis);
  assert_true(assembly->drawn.assembled.share < 0.3);
  assert_string_equal(assembly->change[0].name, "foils_sorted");
  assert_near(assembly->change[0].share, 1, 0);
  said(assembly, 1, "above 20 µm");
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);

  /* Foils alike, bumps not: only a smaller spread within foils helps. */
  design = toleranced("circularity_mm", -INFINITY, 0.020);
  lot = lot_of(&design, 6, same, 0.25, "", NULL);
  assembly = analyse(&lot, &analysis);
  assert_true(assembly->drawn.assembled.share < 0.1);
  assert_string_equal(assembly->change[0].name, "spread_within_foils_halved");
  assert_near(assembly->change[0].share, 1, 0.05);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* Each kind of foil that takes no part, and how many of each. */
static void foils_are_left_out(void **state) {
  (void)state;
  static const double radius[] = {3.40, 3.40, 3.40, 3.40, 3.40, 3.40, 3.40, 3.40, 3.40, 3.40};
  static const char *const cells[] = {",a", ",b", ",c", ",d", ",e", ",f", ",g", ",h", ",h", ",i"};
  fg_design design = toleranced("radius_mm", 3, 3.5);
  fg_lot_analysis analysis;
  fg_lot lot = lot_of(&design, 10, radius, 0, ",foil", cells);
  fg_foil_give_up(&lot.records[0].foils[0], "a test");
  lot.records[1].foils[0].bumps[4].flags |= FG_BUMP_CRUSHED;
  lot.records[2].foils[0].bumps[4].clearance_fitted_mm = NAN;
  lot.records[3].foils[0].bump_count = 8; /* the design has nine */
  lot.records[4].foils[0].flags |= FG_FOIL_TOUCHES_OTHER;
  lot.records[5].foils[0].bumps[0].radius_mm = 3.7;
  const fg_lot_assembly *assembly = analyse(&lot, &analysis);
  static const fg_lot_left_out why[] = {FG_LOT_NOT_MEASURED, FG_LOT_CRUSHED,  FG_LOT_NO_CLEARANCE,
                                        FG_LOT_DEFECT,       FG_LOT_FLAGGED,  FG_LOT_FAILS,
                                        FG_LOT_IN_STOCK,     FG_LOT_IN_STOCK, FG_LOT_SCANNED_AGAIN,
                                        FG_LOT_IN_STOCK};
  for (size_t i = 0; i < 10; i++)
    assert_int_equal(assembly->reason[i], why[i]);
  assert_int_equal(assembly->stock.foils, 3);
  assert_int_equal(assembly->drawn.assembled.count, 1000);
  fg_lot_analysis_free(&analysis);

  /* A recipe that asks for more bumps than a foil has: none can be built in, which is said. */
  lot.settings.design.tolerance_count = 0;
  lot.settings.layout.bumps_per_pad = 11;
  assembly = analyse(&lot, &analysis);
  assert_int_equal(assembly->stock.foils, 0);
  said(assembly, 0, "No bearings are drawn: 0 of 10 foils can be built in");
  assert_string_equal(assembly->statement[1], "");
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

static void too_few_foils_assemble_no_bearing(void **state) {
  (void)state;
  static const double radius[] = {3.40};
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  fg_lot lot = lot_of(&design, 1, radius, 0, "", NULL);
  said(analyse(&lot, &analysis), 0, "1 of 1 foils can be built in, a bearing takes 3");
  fg_lot_analysis_free(&analysis);
  lot.settings.assembly.bearings = 0;
  assert_false(analyse(&lot, &analysis)->asked);
  assert_string_equal(analysis.assembly.statement[0], "");
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* Two pads of nine bumps leave half of the bearing open: the rotor is asked for on the axis. */
static void an_open_bearing_asks_for_the_axis(void **state) {
  (void)state;
  static const double radius[] = {3.40, 3.40, 3.40, 3.40};
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  fg_lot lot = lot_of(&design, 4, radius, 0.05, "", NULL);
  lot.settings.layout.pads = 1;
  const fg_lot_assembly *assembly = analyse(&lot, &analysis);
  assert_false(assembly->centred);
  assert_int_equal(assembly->plan.limits, 1);
  assert_true(assembly->plan.limit[0].asked);
  assert_int_equal(assembly->drawn.values[2], 0);
  assert_int_equal(assembly->drawn.assembled.count, 1000);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_good_lot_assembles),
      cmocka_unit_test(the_largest_change_wins),
      cmocka_unit_test(foils_are_left_out),
      cmocka_unit_test(too_few_foils_assemble_no_bearing),
      cmocka_unit_test(an_open_bearing_asks_for_the_axis),
  };
  return cmocka_run_group_tests_name("assembly of a lot", tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stability of the process, the causes of its signals, and the words for both. */
#include "report/lot/files.h"
#include "support/made_lot.h"
#include "support/page_names.h"
#include "support/random.h"
#include "support/test.h"

enum { FOILS = 24, BUMPS = 3 };

/* Radii of foils whose die and operator are given; noise that is the same in every lot. */
static fg_lot lot_of(const fg_design *design, const char *const *cells, const double *offset_mm) {
  static const double noise_um[FOILS] = {3,  -2, 5, -6, 1, 4,  -3, -5, 2, 6,  -1, -4,
                                         -2, 3,  1, -1, 6, -4, 2,  -6, 4, -3, 5,  -5};
  fg_lot lot = made_lot(design, FOILS, BUMPS, ",die,operator", cells);
  for (size_t i = 0; i < FOILS; i++)
    for (size_t k = 0; k < BUMPS; k++) {
      double radius = 3.36 + offset_mm[i] + noise_um[i] / 1000 + 0.004 * (double)k;
      made_bump(&lot, i, k, radius, 63.15 * 3.32 / radius);
    }
  return lot;
}

/* Statistics of the bump radius; the page's text where `page` is not NULL. */
static fg_lot_quantity radius_of(const char *const *cells, const double *offset_mm,
                                 fg_lot_process *process, char **page) {
  fg_design design;
  fg_lot_analysis analysis;
  size_t size;
  fg_design_default(&design);
  design.bumps.count = BUMPS;
  design.tolerance_count = 1;
  strcpy(design.calibration.not_needed, "the foils are made up");
  design.tolerances[0] = (fg_tolerance){.quantity = "radius_mm", .lower = 3.3, .upper = 3.5};
  fg_lot lot = lot_of(&design, cells, offset_mm);
  assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
  fg_lot_quantity radius = *fg_lot_find_quantity(&analysis, "radius_mm");
  *process = analysis.process;
  if (page) {
    FILE *out = open_memstream(page, &size);
    assert_ok(NULL, fg_lot_write_page(NULL, &analysis, out));
    fclose(out);
  }
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
  return radius; /* of it only numbers are read */
}

/* Radii of 24 scans: three of each of 8 foils, whose cells name them, or of 8 foils once. */
static fg_lot_quantity radius_of_scans(size_t scans, bool named, size_t *again, size_t *bearings) {
  static const char *const names[] = {",a,", ",b,", ",c,", ",d,", ",e,", ",f,", ",g,", ",h,"};
  enum { ON_A_PAD = 9 };
  const char *cells[FOILS];
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  design.bumps.count = ON_A_PAD;
  design.tolerance_count = 1;
  strcpy(design.calibration.not_needed, "the foils are made up");
  design.tolerances[0] = (fg_tolerance){.quantity = "radius_mm", .lower = 3.3, .upper = 3.5};
  for (size_t i = 0; i < 8 * scans; i++)
    cells[i] = named ? names[i / scans] : ",,";
  fg_lot lot = made_lot(&design, 8 * scans, ON_A_PAD, ",foil,operator", cells);
  for (size_t i = 0; i < 8 * scans; i++)
    for (size_t k = 0; k < ON_A_PAD; k++) {
      double scan = scans > 1 ? 0.001 * ((double)(i % scans) - 1) : 0;
      made_bump(&lot, i, k, 3.36 + 0.02 * (double)(i / scans % 3) + 0.002 * (double)k + scan, 63);
    }
  assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
  fg_lot_quantity radius = *fg_lot_find_quantity(&analysis, "radius_mm");
  *again = analysis.scanned_again;
  *bearings = analysis.bearing_count;
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
  return radius; /* of it only numbers are read */
}

/* Page of the first `scans` scans of two foils by two operators, each twice. */
static char *page_of_operators(size_t scans) {
  static const char *const cells[] = {",a,X", ",a,X", ",a,Y", ",a,Y",
                                      ",b,X", ",b,X", ",b,Y", ",b,Y"};
  fg_design design;
  fg_lot_analysis analysis;
  char *page;
  size_t size;
  fg_design_default(&design);
  design.bumps.count = BUMPS;
  fg_lot lot = made_lot(&design, scans, BUMPS, ",foil,operator", cells);
  for (size_t i = 0; i < scans; i++)
    for (size_t k = 0; k < BUMPS; k++)
      made_bump(&lot, i, k, 3.36 + 0.01 * (double)(i / 4) + 0.001 * (double)(i % 4 + k), 63);
  assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
  FILE *out = open_memstream(&page, &size);
  assert_ok(NULL, fg_lot_write_page(NULL, &analysis, out));
  fclose(out);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
  return page;
}

/* A study of which one scan of eight is missing is one; of which three are, none, and the page says
 * so. */
static void a_missing_gauge_study_has_its_reason(void **state) {
  (void)state;
  static const char reason[] = "Here are 5 measured scans of 2 foils by 2 operators.";
  char *whole = page_of_operators(8), *one_missing = page_of_operators(7),
       *part = page_of_operators(5);
  assert_non_null(strstr(whole, "Gauge repeatability"));
  assert_null(strstr(whole, "it takes every foil by every operator"));
  assert_non_null(strstr(one_missing, "Gauge repeatability"));
  assert_non_null(strstr(part, reason));
  free(whole);
  free(one_missing);
  free(part);
}

/* 24 scans of 8 foils say no more of the process than 8 do: the chart has a point for each foil,
 * and its limits are those from foil to foil, not from scan to scan. */
static void scans_of_a_foil_count_once(void **state) {
  (void)state;
  size_t again, bearings;
  fg_lot_quantity once = radius_of_scans(1, true, &again, &bearings);
  assert_int_equal(again, 0);
  assert_int_equal(bearings, 2);
  fg_lot_quantity named = radius_of_scans(3, true, &again, &bearings);
  assert_int_equal(again, 16);
  assert_int_equal(bearings, 2);
  fg_lot_quantity apart = radius_of_scans(3, false, &again, &bearings);
  assert_int_equal(again, 0);
  assert_int_equal(apart.chart.count, 24);
  assert_int_equal(named.chart.count, 8);
  assert_int_equal(named.count, once.count);
  assert_near(named.mean, once.mean, 1e-12);
  assert_near(named.sd, once.sd, 1e-12);
  assert_near(named.chart.sigma, once.chart.sigma, 1e-12);
  assert_near(named.capability.pk.low, once.capability.pk.low, 1e-9);
  assert_near(named.capability.pk.high, once.capability.pk.high, 1e-9);
  assert_true(apart.chart.sigma < named.chart.sigma / 2);
}

/* Foils 1 to 3 of each bearing are no scans of three foils. */
static void foils_of_bearings_may_share_a_name(void **state) {
  (void)state;
  static const char *const cells[] = {",1,A", ",2,A", ",3,A", ",1,B", ",2,B", ",3,B"};
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  fg_lot lot = made_lot(&design, 6, BUMPS, ",foil,bearing", cells);
  for (size_t i = 0; i < 6; i++)
    for (size_t k = 0; k < BUMPS; k++)
      made_bump(&lot, i, k, 3.36 + 0.001 * (double)i, 63);
  assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
  assert_int_equal(analysis.scanned_again, 0);
  assert_int_equal(fg_lot_find_quantity(&analysis, "radius_mm")->chart.count, 6);
  assert_true(analysis.bearing_count == 2 && analysis.bearings[1].pad[2]);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* Two dies in turn, 60 µm apart: the chart signals, and the die is why; who measured is not. */
static void dies_in_turn_explain_the_signals(void **state) {
  (void)state;
  const char *cells[FOILS];
  double offset[FOILS];
  fg_lot_process process;
  char *page;
  for (size_t i = 0; i < FOILS; i++) {
    cells[i] = i % 2 ? i % 3 ? ",B,eve" : ",B,ada" : i % 3 ? ",A,eve" : ",A,ada";
    offset[i] = i % 2 ? 0.06 : 0;
  }
  fg_lot_quantity radius = radius_of(cells, offset, &process, &page);
  assert_true(radius.chart.count == FOILS && !radius.stable);
  assert_int_equal(radius.cause.column, 1);
  assert_int_equal(radius.cause.groups, 2);
  assert_int_equal(radius.cause.foils[0], 12);
  assert_int_equal(radius.cause.signals_left, 0);
  assert_true(radius.cause.in_turn);
  assert_true(radius.cause.p_value < 1e-10);
  assert_true(fabs(radius.cause.mean[1] - radius.cause.mean[0] - 0.06) < 0.005);
  assert_int_equal(process.watched, 1);
  assert_int_equal(process.unstable, 1);
  assert_int_equal(process.explained, 1);
  assert_has(page_without_name_marks(page), "Process: groups differ");
  assert_has(page_without_name_marks(page),
             "come from the groups of the column <b>die</b>, whose foils lie in "
             "turn: A has a mean of 3.36");
  free(page);
}

/* 6 um a foil have nothing to do with the die of every other foil: the page states the trend. */
static void a_drift_is_a_trend(void **state) {
  (void)state;
  const char *cells[FOILS];
  double offset[FOILS];
  fg_lot_process process;
  char *page;
  for (size_t i = 0; i < FOILS; i++) {
    cells[i] = i % 2 ? ",B,ada" : ",A,ada";
    offset[i] = 0.006 * (double)i;
  }
  fg_lot_quantity radius = radius_of(cells, offset, &process, &page);
  assert_true(radius.chart.signals > 0);
  assert_true(radius.cause.column == FG_NO_COLUMN);
  assert_int_equal(process.unstable, 1);
  assert_int_equal(process.explained, 0);
  assert_true(radius.trend.known && radius.trend.foils == FOILS);
  assert_true(fabs(radius.trend.per_foil - 0.006) < 2 * radius.trend.u_per_foil);
  assert_true(radius.trend.u_per_foil < 0.0003 && radius.trend.p_value < 1e-10);
  assert_int_equal(radius.trend.signals_left, 0);
  assert_has(page_without_name_marks(page), "Process not stable: 1 of 1 quantities");
  assert_has_not(page, "no group of foils");
  assert_has(page_without_name_marks(page), ": in the order of the foils it rises by 5.9");
  assert_has(page_without_name_marks(page), " µm a foil, 13");
  assert_has(page_without_name_marks(page),
             " µm from the first to the last (p &lt; 0.0001); without this trend no "
             "signal is left.");
  free(page);
}

/* One foil out of line is no trend, nor are dies that follow each other: those explain more. */
static void a_single_outlier_and_a_new_die_are_no_trend(void **state) {
  (void)state;
  const char *cells[FOILS];
  double offset[FOILS] = {[11] = 0.08};
  fg_lot_process process;
  char *page;
  for (size_t i = 0; i < FOILS; i++)
    cells[i] = i % 2 ? ",B,ada" : ",A,ada";
  fg_lot_quantity radius = radius_of(cells, offset, &process, &page);
  assert_true(radius.chart.signals > 0 && !radius.trend.known);
  assert_has(page_without_name_marks(page), "no group of foils explains");
  free(page);
  for (size_t i = 0; i < FOILS; i++) {
    cells[i] = i < FOILS / 2 ? ",A,ada" : ",B,ada";
    offset[i] = i < FOILS / 2 ? 0 : 0.06;
  }
  radius = radius_of(cells, offset, &process, &page);
  assert_int_equal(radius.cause.signals_left, 0);
  assert_false(fg_lot_is_trend(&radius));
  assert_has(page_without_name_marks(page), "come from the groups of the column <b>die</b>");
  free(page);
}

/* White noise has a trend as often as the level says; neighbours that are alike seldom have one. */
static void trends_of_noise_are_rare(void **state) {
  (void)state;
  enum { LOTS = 4000, COUNT = 20 };
  static const double alike[] = {0, 0.4};
  for (size_t k = 0; k < 2; k++) {
    size_t known = 0;
    for (uint64_t seed = 1; seed <= LOTS; seed++) {
      fg_chart_point point[COUNT] = {{0}};
      fg_lot_quantity quantity = {.chart = {.point = point, .count = COUNT}};
      double value = 0;
      uint64_t noise = seed;
      for (size_t i = 0; i < COUNT + 20; i++) {
        value = alike[k] * value + random_gaussian(&noise);
        if (i >= 20) point[i - 20].value = value;
      }
      assert_ok(&test_context, fg_lot_find_trend(&test_context, 0, 0.0125, &quantity));
      known += quantity.trend.known;
    }
    assert_true(known <= (k ? 0.035 : 0.0125) * LOTS && known >= 0.004 * LOTS);
  }
}

/* Foils whose die is not named, and dies of one foil each, explain nothing. */
static void groups_must_hold_every_foil(void **state) {
  (void)state;
  const char *cells[FOILS];
  double offset[FOILS];
  fg_lot_process process;
  for (size_t i = 0; i < FOILS; i++) {
    cells[i] = i == 5 ? ",,ada" : i % 2 ? ",B,ada" : ",A,ada";
    offset[i] = i % 2 ? 0.06 : 0;
  }
  assert_true(radius_of(cells, offset, &process, NULL).cause.column == FG_NO_COLUMN);
  cells[5] = ",C,ada";
  assert_true(radius_of(cells, offset, &process, NULL).cause.column == FG_NO_COLUMN);
}

static void a_quiet_process_is_stable(void **state) {
  (void)state;
  const double offset[FOILS] = {0};
  fg_lot_process process;
  const char *cells[FOILS];
  char *page;
  for (size_t i = 0; i < FOILS; i++)
    cells[i] = i % 2 ? ",B,ada" : ",A,ada";
  assert_true(radius_of(cells, offset, &process, &page).stable);
  assert_int_equal(process.unstable, 0);
  assert_has(page_without_name_marks(page), "Process stable");
  free(page);
}

/* One bump is beyond its limit: the lot says by how much, and which limit it is. */
static void the_margin_of_the_worst_is_told(void **state) {
  (void)state;
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  design.bumps.count = BUMPS;
  design.tolerance_count = 1;
  strcpy(design.calibration.not_needed, "the foils are made up");
  design.tolerances[0] = (fg_tolerance){.quantity = "radius_mm", .lower = 3.3, .upper = 3.4};
  const double offset[FOILS] = {[7] = 0.05};
  fg_lot lot = lot_of(&design, NULL, offset);
  lot.records[7].foils[0].bumps[2].u_radius_mm = 0.001;
  assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
  const fg_lot_foil *worst = analysis.worst[0];
  assert_int_equal(worst->item, 7);
  assert_int_equal(worst->worst_number, 3);
  assert_true(worst->worst_limit == 3.4);
  assert_true(fabs(worst->worst_margin - (3.4 - worst->worst_value)) < 1e-12);
  assert_true(worst->worst_margin < -0.01 && worst->worst_u == 0.001);
  assert_true(analysis.worst[1]->worst_margin > 0);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_missing_gauge_study_has_its_reason),
      cmocka_unit_test(scans_of_a_foil_count_once),
      cmocka_unit_test(foils_of_bearings_may_share_a_name),
      cmocka_unit_test(dies_in_turn_explain_the_signals),
      cmocka_unit_test(a_drift_is_a_trend),
      cmocka_unit_test(a_single_outlier_and_a_new_die_are_no_trend),
      cmocka_unit_test(trends_of_noise_are_rare),
      cmocka_unit_test(groups_must_hold_every_foil),
      cmocka_unit_test(a_quiet_process_is_stable),
      cmocka_unit_test(the_margin_of_the_worst_is_told),
  };
  return cmocka_run_group_tests_name("the process of a lot", tests, NULL, NULL);
}

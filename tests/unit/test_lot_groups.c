/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups of a lot: foils are the unit, bumps a level within them; all tests share their error. */
#include "lot/run/lot.h"
#include "report/lot/files.h"
#include "stats/relabelled_spread.h"
#include "support/group_lots.h"
#include "support/test.h"

enum { LOTS = 250 };

typedef struct tally {
  int below[FG_LOT_GROUP_TESTS], family;
} tally;

static tally count(const group_kind *kind, uint64_t seed) {
  fg_design design;
  group_lot g;
  tally t = {0};
  fg_design_default(&design);
  group_lot_make(&design, kind->first, &g);
  for (int i = 0; i < LOTS; i++) {
    group_lot_draw(kind, &seed, &g);
    const fg_lot_difference *radius = group_lot_compare(&g);
    for (int k = 0; k < FG_LOT_GROUP_TESTS; k++)
      t.below[k] += radius->p[k] < 0.05;
    t.family += g.analysis.group_tests_differ > 0;
  }
  group_lot_free(&g);
  return t;
}

/* Bumps of one foil are alike: as if they were independent 40 % of such lots would differ. */
static void groups_that_do_not_differ_are_told_apart_in_one_of_twenty(void **state) {
  (void)state;
  static const group_kind kinds[] = {{7, 0.02, 0, 0, 0, 1}, {4, 0.02, 0.01, 3, 0, 1}};
  for (int i = 0; i < 2; i++) {
    tally t = count(&kinds[i], 5);
    for (int k = 0; k < FG_LOT_GROUP_TESTS; k++)
      assert_in_range(t.below[k], LOTS * 22 / 1000, LOTS * 82 / 1000);
    assert_in_range(t.family, 0, LOTS * 65 / 1000);
  }
}

static void a_planted_difference_is_found(void **state) {
  (void)state;
  const group_kind apart = {7, 0.02, 0.01, 3, 0.06, 1};
  tally t = count(&apart, 6);
  assert_true(t.below[FG_LOT_TEST_MEANS] > LOTS * 97 / 100 && t.family > LOTS * 70 / 100);
  assert_in_range(t.below[FG_LOT_TEST_VARIANCES], LOTS * 22 / 1000, LOTS * 82 / 1000);
}

/* Without scatter a foil's level is its own, whatever bumps it lacks. */
static void a_missing_bump_does_not_shift_its_foil(void **state) {
  (void)state;
  fg_design design;
  group_lot g;
  uint64_t seed = 9;
  const group_kind kind = {7, 0.02, 0, 0, 0, 1};
  fg_design_default(&design);
  group_lot_make(&design, 7, &g);
  group_lot_draw(&kind, &seed, &g);
  for (size_t i = 0; i < GROUP_FOILS; i++)
    for (size_t k = 0; k < GROUP_BUMPS; k++)
      g.lot.records[i].foils[0].bumps[k].radius_mm =
          3.3 + 0.003 * (double)i + 0.02 * (double)(k * k % 7);
  const fg_lot_difference whole = *group_lot_compare(&g);
  for (size_t i = 0; i < 6; i++) /* their last places, which lie high */
    g.lot.records[i].foils[0].bump_count = 7;
  const fg_lot_difference *part = group_lot_compare(&g);
  assert_true(fabs(part->mean_a - whole.mean_a) < 1e-9 && fabs(part->mean_b - whole.mean_b) < 1e-9);
  assert_true(fabs(part->comparison.difference + 0.021) < 1e-9 && part->within_sd_a < 1e-8);
  assert_int_equal(part->count_a, whole.count_a - 12);
  assert_int_equal(part->foils_a, 7);
  group_lot_free(&g);
}

/* Three trials of a part in one group are one foil. */
static void scans_of_one_foil_count_once(void **state) {
  (void)state;
  static const char *const cells[] = {",A,p1", ",A,p1", ",A,p1", ",A,p2", ",A,p3", ",B,q1",
                                      ",B,q1", ",B,q2", ",B,q3", ",B,q3", ",,r1",  ",A,p2"};
  enum { SCANS = sizeof cells / sizeof *cells };
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  fg_lot lot = made_lot(&design, SCANS, 5, ",die,foil", cells);
  snprintf(lot.settings.group_column, sizeof lot.settings.group_column, "die");
  for (size_t i = 0; i < SCANS; i++)
    for (size_t k = 0; k < 5; k++)
      made_bump(&lot, i, k, 3.3 + 0.01 * (double)((7 * i + 3 * k) % 11), 63.15);
  assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
  assert_int_equal(analysis.differences[0].foils_a, 3);
  assert_int_equal(analysis.differences[0].foils_b, 3);
  assert_int_equal(analysis.differences[0].count_a, 30);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* Of the twenty ways to deal the values, by hand. */
static void few_values_are_dealt_in_every_way(void **state) {
  (void)state;
  const double a[] = {-1, 0, 1}, b[] = {-10, 0, 10}, same[] = {4, 4, 4};
  fg_relabelled_spread spread;
  assert_ok(&test_context,
            fg_relabel_spreads(&test_context, (fg_sample){a, 3}, (fg_sample){b, 3}, 9999, &spread));
  assert_true(spread.complete);
  /* As extreme: {-1, 0, 1} with either zero, {0, 0, 1} and {0, 0, -1}; each on either side. */
  assert_true(fabs(spread.p_variances - 8.0 / 20) < 1e-12);
  assert_ok(&test_context,
            fg_relabel_spreads(&test_context, (fg_sample){a, 2}, (fg_sample){b, 3}, 9999, &spread));
  assert_true(isnan(spread.p_variances) && isnan(spread.p_levene));
  assert_ok(&test_context, fg_relabel_spreads(&test_context, (fg_sample){same, 3},
                                              (fg_sample){same, 3}, 9999, &spread));
  assert_true(isnan(spread.p_levene));
}

/* Of normal values the F test is exact, and relabelling must agree far below 1/draws. */
static void tails_of_large_samples_are_those_of_the_f_test(void **state) {
  enum { COUNT = 30000, DRAWS = 1000000 };
  static double a[COUNT], b[COUNT];
  uint64_t seed = 11;
  fg_relabelled_spread spread;
  fg_comparison exact;
  (void)state;
  for (size_t i = 0; i < COUNT; i++) {
    a[i] = random_gaussian(&seed);
    b[i] = 1.04 * random_gaussian(&seed);
  }
  const fg_sample first = {a, COUNT}, second = {b, COUNT};
  assert_ok(&test_context, fg_comparison_compute(&test_context, first, second, 0.95, &exact));
  assert_ok(&test_context, fg_relabel_spreads(&test_context, first, second, DRAWS, &spread));
  assert_true(exact.p_variances < 1e-5);
  assert_true(fabs(log(spread.p_variances) / log(exact.p_variances) - 1) < 0.15);
  assert_true(fabs(log(spread.p_levene) / log(exact.p_levene) - 1) < 0.15);
}

static void page_says_how_many_tests_differ(void **state) {
  (void)state;
  fg_design design;
  group_lot g;
  uint64_t seed = 3;
  const group_kind apart = {7, 0.005, 0, 0, 0.2, 1};
  char *text;
  size_t size;
  fg_design_default(&design);
  group_lot_make(&design, 7, &g);
  group_lot_draw(&apart, &seed, &g);
  group_lot_compare(&g);
  FILE *out = open_memstream(&text, &size);
  assert_ok(NULL, fg_lot_write_page(NULL, &g.analysis, out));
  fclose(out);
  assert_has(text, "tests find a difference</b> (5 % for all of them together)");
  free(text);
  group_lot_free(&g);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(groups_that_do_not_differ_are_told_apart_in_one_of_twenty),
      cmocka_unit_test(a_planted_difference_is_found),
      cmocka_unit_test(a_missing_bump_does_not_shift_its_foil),
      cmocka_unit_test(scans_of_one_foil_count_once),
      cmocka_unit_test(few_values_are_dealt_in_every_way),
      cmocka_unit_test(tails_of_large_samples_are_those_of_the_f_test),
      cmocka_unit_test(page_says_how_many_tests_differ),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

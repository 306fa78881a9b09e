/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Angle against radius over simulated lots: the slope, how often its interval misses, the scatter
 * of the arc length. */
#include "support/made_lot.h"
#include "support/random.h"
#include "support/test.h"

enum { FOILS = 14, BUMPS = 9, LOTS = 1500 };

typedef struct scatter {
  double arc;                     /* of the arc length, relative */
  double radius_level, arc_level; /* the share of either variance that whole foils have in common */
} scatter;

static void draw_bump(const scatter *s, double foil_radius, double foil_arc, uint64_t *seed,
                      fg_bump *bump) {
  double radius = 0.05 * (sqrt(s->radius_level) * foil_radius +
                          sqrt(1 - s->radius_level) * random_gaussian(seed));
  double arc =
      s->arc * (sqrt(s->arc_level) * foil_arc + sqrt(1 - s->arc_level) * random_gaussian(seed));
  bump->radius_error_pct = 100 * (exp(0.04 + radius) - 1);
  bump->bump_angle_error_pct = 100 * (exp(arc - 0.04 - radius) - 1);
}

static void draw_lot(const fg_lot *lot, const scatter *s, uint64_t *seed) {
  for (size_t i = 0; i < FOILS; i++) {
    double foil_radius = random_gaussian(seed), foil_arc = random_gaussian(seed);
    for (size_t k = 0; k < BUMPS; k++)
      draw_bump(s, foil_radius, foil_arc, seed, &lot->records[i].foils[0].bumps[k]);
  }
}

/* Constant arc length: -1 is the truth, and an interval of 95 % leaves it out in 5 % of the lots,
 * whether foils differ as wholes or not. */
static void the_slope_is_minus_one(void **state) {
  (void)state;
  static const scatter cases[] = {{0.02, 0, 0}, {0.044, 0, 0}, {0.02, 0.5, 0.3}, {0.044, 0.9, 0.8}};
  uint64_t seed = 17;
  fg_design design;
  fg_design_default(&design);
  fg_lot lot = made_lot(&design, FOILS, BUMPS, "", NULL);
  fg_lot_foil foils[FOILS];
  for (size_t i = 0; i < FOILS; i++)
    foils[i] = (fg_lot_foil){.item = i, .foil = &lot.records[i].foils[0]};
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    in_row("cases[%zu]", c);
    double slope = 0, spread = 0, missed = 0;
    for (int trial = 0; trial < LOTS; trial++) {
      fg_lot_analysis analysis = {.lot = &lot, .foils = foils, .foil_count = FOILS};
      draw_lot(&lot, &cases[c], &seed);
      assert_ok(&test_context, fg_lot_analyse_correlation(&test_context, &analysis));
      const fg_lot_correlation *line = &analysis.correlation;
      assert_true(analysis.has_correlation);
      assert_int_equal(line->foils, FOILS);
      slope += line->log_slope / LOTS;
      spread += line->arc_length_sd_pct / LOTS;
      missed += (line->log_low > -1 || line->log_high < -1) / (double)LOTS;
    }
    /* Of 1500 lots 5 % are missed within 1.7 % (three standard errors). */
    if (!(fabs(slope + 1) < 0.015 && missed > 0.033 && missed < 0.067))
      fail_msg("case %zu: slope %.4f, the truth is missed in %.1f %%", c, slope, 100 * missed);
    double lost = 1 - cases[c].arc_level / FOILS; /* what a mean over 14 foils takes with it */
    if (!(fabs(spread / (100 * cases[c].arc * sqrt(lost)) - 1) < 0.03))
      fail_msg("case %zu: arc length scatters by %.3f %%", c, spread);
  }
  made_lot_free(&lot);
}

/* Two scans of every part: half of them are no new parts. */
static void scans_of_one_part_are_one_foil(void **state) {
  (void)state;
  static const char *const cells[] = {",a", ",a", ",b", ",b", ",c", ",c", ",", ","};
  const scatter s = {0.02, 0.5, 0.3};
  uint64_t seed = 3;
  fg_design design;
  fg_design_default(&design);
  fg_lot lot = made_lot(&design, 8, BUMPS, ",foil", cells);
  fg_lot_analysis analysis;
  for (size_t i = 0; i < 8; i++)
    for (size_t k = 0; k < BUMPS; k++)
      draw_bump(&s, 0, 0, &seed, &lot.records[i].foils[0].bumps[k]);
  assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
  assert_int_equal(analysis.correlation.foils, 5);
  assert_true(analysis.correlation.log_dof < 4);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* One foil says nothing about foils: a slope, and no interval. */
static void one_foil_has_no_interval(void **state) {
  (void)state;
  const scatter s = {0.02, 0, 0};
  uint64_t seed = 5;
  fg_design design;
  fg_design_default(&design);
  fg_lot lot = made_lot(&design, 1, BUMPS, "", NULL);
  fg_lot_analysis analysis;
  for (size_t k = 0; k < BUMPS; k++)
    draw_bump(&s, 0, 0, &seed, &lot.records[0].foils[0].bumps[k]);
  assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
  assert_true(isfinite(analysis.correlation.log_slope) && isnan(analysis.correlation.log_low));
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_slope_is_minus_one),
      cmocka_unit_test(scans_of_one_part_are_one_foil),
      cmocka_unit_test(one_foil_has_no_interval),
  };
  return cmocka_run_group_tests_name("slope of a lot", tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clearance over the azimuths: travel from push to pull is that along the opposite direction, so
 * the fit has even orders only; the axis of the smallest clearance and how often its U holds the
 * truth. */
#include <math.h>
#include <stdlib.h>

#include "load_test/analysis.h"
#include "support/random.h"
#include "support/test.h"

enum { AZIMUTHS_MAX = 12, SEEDS = 4000 };
static const double u_mm = 0.001;

/* A bearing's clearance: mean, orders 2 and 4, and where its order 2 is smallest. */
typedef struct bearing {
  double second_mm, fourth_mm, smallest_at_deg, fourth_at_deg;
} bearing;

static double clearance_at(const bearing *b, double deg) {
  return 0.18 - b->second_mm * cos(2 * (deg - b->smallest_at_deg) * M_PI / 180) -
         b->fourth_mm * cos(4 * (deg - b->fourth_at_deg) * M_PI / 180);
}

static fg_load_bearing sum(const bearing *b, const double *azimuths, size_t count,
                           uint64_t *state) {
  fg_load_direction directions[AZIMUTHS_MAX] = {0};
  fg_load_bearing found = {0};
  fg_load_test test = {.options = fg_load_options_default(),
                       .directions = directions,
                       .direction_count = count,
                       .bearings = &found,
                       .bearing_count = 1};
  for (size_t i = 0; i < count; i++) {
    double c = clearance_at(b, azimuths[i]) + (state ? u_mm * random_gaussian(state) : 0);
    directions[i] = (fg_load_direction){.azimuth_deg = azimuths[i], .clearance = {c, u_mm, u_mm}};
  }
  fg_load_sum_bearing(&test, 0, &found);
  return found;
}

static const double thesis[] = {0, 120, 240},
                    whole[] = {0, 30, 60, 90, 120, 150, 180, 210, 240, 270, 300, 330};
static const double half[] = {0, 30, 60, 90, 120, 150}, four[] = {0, 45, 90, 135};

/* The plan of the thesis is three axes, 60 degrees apart. */
static void three_azimuths_say_the_axis(void **state) {
  (void)state;
  for (double truth = 0; truth < 180; truth += 15) {
    bearing b = {.second_mm = 0.02, .smallest_at_deg = truth};
    fg_load_bearing found = sum(&b, thesis, 3, NULL);
    assert_int_equal(found.axis, FG_LOAD_AXIS_KNOWN);
    assert_near(remainder(found.min_at_deg - truth, 180), 0, 1e-6);
    assert_near(found.amplitude_mm[2], 0.02, 1e-9);
    assert_near(found.mean_mm, 0.18, 1e-9);
    assert_false(found.harmonic[1] || found.harmonic[3] || found.harmonic[4]);
    assert_true(found.u_min_at_deg > 0.5 && found.u_min_at_deg < 3);
  }
}

static void plans_that_cannot_tell(void **state) {
  (void)state;
  const double line[] = {0, 90, 180, 270};
  bearing b = {.second_mm = 0.02, .smallest_at_deg = 90}, round_one = {0};
  fg_load_bearing found = sum(&b, line, 4, NULL);
  assert_int_equal(found.axis, FG_LOAD_AXIS_FEW);
  assert_true(isnan(found.min_at_deg) && isnan(found.u_min_at_deg));
  assert_non_null(fg_load_axis_words(found.axis));
  found = sum(&round_one, whole, 12, NULL);
  assert_int_equal(found.axis, FG_LOAD_AXIS_ROUND);
  /* Orders 2 and 4 with two minima that are alike. */
  bearing rivals = {.second_mm = 1e-6, .fourth_mm = 0.02, .fourth_at_deg = 20};
  found = sum(&rivals, half, 6, NULL);
  assert_int_equal(found.axis, FG_LOAD_AXIS_RIVALS);
  assert_true(isnan(found.min_at_deg));
}

/* Smallest place of the true curve. */
static double true_axis(const bearing *b) {
  double best = 0;
  for (double deg = 0; deg < 180; deg += 0.01)
    if (clearance_at(b, deg) < clearance_at(b, best)) best = deg;
  return best;
}

static void expanded_uncertainty_holds_the_truth(void **state) {
  (void)state;
  const struct {
    const double *azimuths;
    size_t count;
    bearing truth;
  } rows[] = {{thesis, 3, {.second_mm = 0.01, .smallest_at_deg = 90}},
              {four, 4, {.second_mm = 0.01, .smallest_at_deg = 20}},
              {half, 6, {.second_mm = 0.01, .smallest_at_deg = 71}},
              {whole, 12, {.second_mm = 0.005, .smallest_at_deg = 30}},
              {whole, 12, {.second_mm = 0.01, .smallest_at_deg = 30, .fourth_mm = 0.004}}};
  for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
    in_row("rows[%zu]", r);
    uint64_t seed = 11 + r;
    double truth = true_axis(&rows[r].truth);
    size_t named = 0, inside = 0;
    for (size_t i = 0; i < SEEDS; i++) {
      fg_load_bearing found = sum(&rows[r].truth, rows[r].azimuths, rows[r].count, &seed);
      if (found.axis != FG_LOAD_AXIS_KNOWN) continue;
      named++;
      inside += fabs(remainder(found.min_at_deg - truth, 180)) <= 2 * found.u_min_at_deg;
    }
    assert_in_range(named, SEEDS * 97 / 100, SEEDS);
    /* 93.4 % of 20,000 draws of the weakest order (rows[3]), 95 to 97 % of the others. */
    assert_in_range(inside, named * 92 / 100, named * 98 / 100);
  }
}

/* Noise alone makes an axis no more often than the test's level says. */
static void round_bearings_have_no_axis(void **state) {
  (void)state;
  bearing b = {0};
  uint64_t seed = 5;
  size_t named = 0;
  for (size_t i = 0; i < SEEDS; i++)
    named += sum(&b, whole, 12, &seed).axis == FG_LOAD_AXIS_KNOWN;
  assert_in_range(named, 0, SEEDS * 2 / 100);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(three_azimuths_say_the_axis),
                                     cmocka_unit_test(plans_that_cannot_tell),
                                     cmocka_unit_test(expanded_uncertainty_holds_the_truth),
                                     cmocka_unit_test(round_bearings_have_no_axis)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

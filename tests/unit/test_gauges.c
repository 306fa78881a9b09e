/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gauges on the glass: how they are stated, what a level they tell, and which object is which. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "measure/gauges.h"
#include "measure/level.h"
#include "support/test.h"
#include "vision/edge_spread.h"

static void a_gauge_is_kind_width_and_uncertainty(void **state) {
  (void)state;
  fg_context ctx = {0};
  fg_gauge gauge;
  assert_ok(&ctx, fg_gauge_parse(&ctx, "pin:2.5:0.0004", &gauge));
  assert_int_equal(gauge.kind, FG_GAUGE_PIN);
  assert_near(gauge.width_mm, 2.5, 1e-15);
  assert_near(gauge.u_mm, 0.0004, 1e-15);
  static const char *const wrong[] = {"",           "pin",         "pin:",       "pin:1",
                                      "pin:1:",     "pin:1:0.1:",  "pins:1:0.1", "pin:one:0.1",
                                      "pin:1:0.1x", "pin:inf:0.1", ":1:0.1"};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
    assert_status(&ctx, fg_gauge_parse(&ctx, wrong[i], &gauge), FG_ERR_USAGE);
  static const char *const beyond[] = {"leaf:0.001:0.0001", "leaf:300:1",      "leaf:0.1:0.02",
                                       "leaf:0.1:0",        "leaf:0.1:-0.001", "leaf:-0.1:0.001"};
  for (size_t i = 0; i < sizeof beyond / sizeof *beyond; i++)
    assert_status(&ctx, fg_gauge_parse(&ctx, beyond[i], &gauge), FG_ERR_DATA);
}

/* Reading of a gauge whose edges lie at level h. */
static fg_gauge_reading reading_at(double width, double h, double blur, bool bright, double scale) {
  double wider = 2 * (h - 0.5) * blur * sqrt(2 * M_PI);
  return (fg_gauge_reading){.found = true,
                            .used = true,
                            .measured_mm = width * (1 + scale) + (bright ? wider : -wider),
                            .u_measured_mm = 1e-5,
                            .blur_mm = blur,
                            .contrast = 170,
                            .bright = bright};
}

static void bright_and_dark_gauges_tell_one_level(void **state) {
  (void)state;
  fg_measurement m = {
      .design = {.gauge_count = 2,
                 .gauges = {{FG_GAUGE_LEAF, 0.1, 0.0005}, {FG_GAUGE_PIN, 1, 0.0005}}}};
  fg_level level;
  m.gauges[0] = reading_at(0.1, 0.7, 0.0106, true, 0);
  m.gauges[1] = reading_at(1, 0.7, 0.0104, false, 0);
  assert_true(fg_level_of_gauges(&m, &level));
  assert_near(level.half, 0.7, 1e-9);
  assert_near(m.gauges[0].level, 0.2, 1e-9);
  assert_near(m.gauges[1].level, 0.2, 1e-9);
  assert_false(m.gauges_contradict);
  /* The thin one says the most: the scale of the scanner, and with it the pin's, is not known. */
  assert_true(level.u < m.gauges[0].u_level && m.gauges[0].u_level < m.gauges[1].u_level / 2);
}

static void a_scale_of_the_scanner_is_no_level(void **state) {
  (void)state;
  fg_level_sum sum = {.count = 0};
  fg_level level;
  for (int i = 1; i <= 5; i++) {
    const fg_gauge gauge = {FG_GAUGE_PIN, i, 0.0003};
    const fg_gauge_reading reading = reading_at(i, 0.42, 0.0104, true, 0.004);
    fg_level_add(&sum, &gauge, &reading);
  }
  fg_level_solve(&sum, 0.05, &level);
  assert_near(level.half, 0.42, 1e-4);
  assert_true(level.u > 0.004 && level.u < 0.02);
}

static void gauges_that_contradict_each_other_widen_the_level(void **state) {
  (void)state;
  fg_measurement m = {
      .design = {.gauge_count = 2,
                 .gauges = {{FG_GAUGE_LEAF, 0.1, 0.0005}, {FG_GAUGE_LEAF, 0.2, 0.0005}}}};
  fg_level level;
  m.gauges[0] = reading_at(0.1, 0.6, 0.0106, true, 0);
  m.gauges[1] = reading_at(0.2, 0.6, 0.0106, true, 0.04); /* is 0.208 */
  assert_true(fg_level_of_gauges(&m, &level));
  assert_true(m.gauges_contradict);
  assert_true(fabs(level.half - 0.6) < 2 * level.u);
}

static void no_tone_curve_makes_any_width_of_a_gauge(void **state) {
  (void)state;
  fg_measurement m = {.design = {.gauge_count = 1, .gauges = {{FG_GAUGE_LEAF, 0.1, 0.0005}}}};
  fg_level level;
  m.gauges[0] = reading_at(0.1, 1.4, 0.0106, true, 0);
  assert_false(fg_level_of_gauges(&m, &level));
  assert_false(m.gauges[0].used);
  assert_true(m.gauges[0].note[0]);
  m.gauges[0] = reading_at(0.1, 0.85, 0.0106, true, 0);
  assert_true(fg_level_of_gauges(&m, &level));
  assert_true(m.gauges[0].used && m.gauges[0].note[0]);
}

static void each_gauge_is_the_nearest_sighting_of_its_kind(void **state) {
  (void)state;
  fg_context ctx = {0};
  fg_gauge_sightings seen = {0};
  static const fg_gauge_sighting all[] = {
      {.kind = FG_GAUGE_LEAF, .width_mm = 0.21},
      {.kind = FG_GAUGE_LEAF, .width_mm = 0.104},
      {.kind = FG_GAUGE_LEAF, .width_mm = 0.111},
      {.kind = FG_GAUGE_PIN, .width_mm = 1.01},
      {.kind = FG_GAUGE_HOLE, .width_mm = 1.0, .spoiled = "it is not round"},
      {.kind = FG_GAUGE_PIN, .width_mm = 2.2}};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    assert_ok(&ctx, fg_gauge_sightings_add(&ctx, &seen, &all[i]));
  fg_measurement m = {.design = {.gauge_count = 6,
                                 .gauges = {{FG_GAUGE_LEAF, 0.2, 0.001},
                                            {FG_GAUGE_LEAF, 0.1, 0.001},
                                            {FG_GAUGE_LEAF, 0.11, 0.001},
                                            {FG_GAUGE_PIN, 1, 0.001},
                                            {FG_GAUGE_RING, 1, 0.001},
                                            {FG_GAUGE_PIN, 2, 0.001}}}};
  fg_gauges_match(&seen, &m);
  assert_near(m.gauges[0].measured_mm, 0.21, 1e-12);
  assert_near(m.gauges[1].measured_mm, 0.104, 1e-12);
  assert_near(m.gauges[2].measured_mm, 0.111, 1e-12);
  assert_near(m.gauges[3].measured_mm, 1.01, 1e-12);
  assert_true(m.gauges[4].found && !m.gauges[4].used);
  assert_string_equal(m.gauges[4].note, "it is not round");
  assert_false(m.gauges[5].found);
  assert_has(m.gauges[5].note, "reads 2.2");
  free(seen.list);
}

/* A Gaussian step through the tone curve f + 4 q f (1 - f). */
static void draw_step(double blur_px, double q, fg_edge_spread *spread) {
  *spread = (fg_edge_spread){.sum = {0}};
  for (double x = -9; x < 9; x += 0.013) {
    double f = 0.5 * erfc(-x / blur_px / sqrt(2));
    fg_edge_spread_add(spread, x, f + 4 * q * f * (1 - f), 1);
  }
}

static void a_tone_curve_makes_an_edge_asymmetric(void **state) {
  (void)state;
  fg_edge_spread spread;
  double blur, asymmetry;
  for (double sd = 0.8; sd < 3; sd += 0.7) {
    draw_step(sd, 0, &spread);
    fg_edge_spread_measure(&spread, &blur, &asymmetry);
    assert_near(blur, sd, 0.03 * sd);
    assert_near(asymmetry, 0, 0.002);
    draw_step(sd, 0.1, &spread);
    fg_edge_spread_measure(&spread, &blur, &asymmetry);
    assert_near(asymmetry, 0.024, 0.004);
  }
  spread = (fg_edge_spread){.sum = {0}};
  fg_edge_spread_measure(&spread, &blur, &asymmetry);
  assert_true(isnan(blur) && isnan(asymmetry));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_gauge_is_kind_width_and_uncertainty),
      cmocka_unit_test(bright_and_dark_gauges_tell_one_level),
      cmocka_unit_test(a_scale_of_the_scanner_is_no_level),
      cmocka_unit_test(gauges_that_contradict_each_other_widen_the_level),
      cmocka_unit_test(no_tone_curve_makes_any_width_of_a_gauge),
      cmocka_unit_test(each_gauge_is_the_nearest_sighting_of_its_kind),
      cmocka_unit_test(a_tone_curve_makes_an_edge_asymmetric),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edges after a scanner's driver: the model that explains them, and the thickness that follows from
 * it, against renders of known truth. */
#include "support/brief.h"
#include "support/measured_render.h"

#include <unistd.h>

#include "foilgauge/measure.h"

#include "support/test.h"
#include "vision/driver_choice.h"

enum { FINE = 4800, COARSE = 2400 };

/* One scanner's driver. Its tone curve is an S of a slope about the middle of the scale. */
typedef struct driver_case {
  const char *scanner;
  double s_slope;   /* 0: no S */
  unsigned finding; /* that must be named, 0: none may */
} driver_case;

/* Counts of a logistic curve through both ends of the scale, as points of a tone curve. */
static void write_s_curve(double steepness, char *text, size_t size) {
  double low = 1 / (1 + exp(steepness / 2));
  size_t used = (size_t)snprintf(text, size, ",\"tone_curve\":[");
  for (int i = 0; i <= 85; i++) {
    double x = i / 85.0, y = (1 / (1 + exp(-steepness * (x - 0.5))) - low) / (1 - 2 * low);
    used += (size_t)snprintf(text + used, size - used, "%s[%d,%.3f]", i ? "," : "", 3 * i, 255 * y);
  }
  snprintf(text + used, size - used, "]");
}

static measured measure_driver(const driver_case *c, const char *light, int dpi) {
  char json[8192], curve[4096] = "";
  if (c->s_slope > 0) write_s_curve(c->s_slope, curve, sizeof curve);
  small_foil(json, sizeof json, 3, ",\"rotate_deg\":-73",
             "\"dpi\":%d,\"noise\":1.2,\"blur_px\":%g,%s%s%s", dpi, dpi == FINE ? 1.4 : 1.0, light,
             c->scanner, curve);
  measured m = measure_render(json, NULL);
  assert_ok(NULL, m.status);
  assert_int_equal(m.result.foil_count, 1);
  return m;
}

/* sd of the thickness that tone curve and chance leave, um. */
static double u_thickness_um(const fg_strip *strip) {
  double blur_um = 0.5 * (strip->blur_left_um + strip->blur_right_um);
  return hypot(0.05, 2 * strip->picture.u_level * blur_um * sqrt(2 * M_PI));
}

static const char *lights[] = {"\"background\":31,\"contrast\":168",
                               "\"background\":225,\"contrast\":-175"};

static void check_case(const driver_case *c, const char *light, int dpi) {
  measured m = measure_driver(c, light, dpi);
  const fg_strip *strip = &m.result.foils[0].strip;
  double error = 1000 * strip->thickness_mm - 100, u = u_thickness_um(strip);
  if (fabs(error) > 2 * u)
    fail_msg("%d dpi, %s%s, S %g: thickness off by %.3f um, u %.3f", dpi, light, c->scanner,
             c->s_slope, error, u);
  if (u > 2.5) fail_msg("%s%s, S %g: u %.3f um", light, c->scanner, c->s_slope, u);
  const unsigned asked = FG_PICTURE_SHARPENED | FG_PICTURE_TONE_CURVE | FG_PICTURE_UNKNOWN_PROFILE;
  unsigned found = strip->picture.findings & asked;
  if ((c->finding && !(found & c->finding)) || (!c->finding && found))
    fail_msg("%d dpi, %s%s, S %g: findings %x", dpi, light, c->scanner, c->s_slope, found);
  measured_free(&m);
}

static void check_cases(const driver_case *cases, size_t count) {
  for (size_t i = 0; i < count; i += test_step(2))
    for (int light = 0; light < 2; light++)
      for (int dpi = COARSE; dpi <= FINE; dpi += FINE - COARSE)
        check_case(&cases[i], lights[light], dpi);
}

static void sharpened_edges_stay_in_place(void **state) {
  (void)state;
  static const driver_case cases[] = {
      {",\"unsharp_mask\":{\"amount_pct\":50,\"radius_px\":1}", 0, FG_PICTURE_SHARPENED},
      {",\"unsharp_mask\":{\"amount_pct\":100,\"radius_px\":1}", 0, FG_PICTURE_SHARPENED},
      {",\"unsharp_mask\":{\"amount_pct\":150,\"radius_px\":1}", 0, FG_PICTURE_SHARPENED},
      {",\"bits\":16,\"unsharp_mask\":{\"amount_pct\":100,\"radius_px\":2}", 0,
       FG_PICTURE_SHARPENED},
  };
  check_cases(cases, sizeof cases / sizeof *cases);
}

static void s_curves_are_held(void **state) {
  (void)state;
  static const driver_case cases[] = {
      {"", 5, FG_PICTURE_TONE_CURVE}, /* slope 1.5 */
      {",\"bits\":16", 7.6, FG_PICTURE_TONE_CURVE},
  };
  check_cases(cases, sizeof cases / sizeof *cases);
}

static void powers_are_held(void **state) {
  (void)state;
  static const driver_case cases[] = {
      {",\"gamma\":0.3", 0, 0},
      {",\"gamma\":0.4,\"bits\":16", 0, 0},
      {",\"gamma\":2.5", 0, 0},
      {",\"gamma\":3", 0, 0},
  };
  check_cases(cases, sizeof cases / sizeof *cases);
}

/* Without a driver's doing nothing of it is found, and the plain model stays in force. */
static void plain_edges_are_plain(void **state) {
  (void)state;
  static const driver_case plain = {"", 0, 0};
  for (int light = 0; light < 2; light++) {
    measured m = measure_driver(&plain, lights[light], COARSE);
    const fg_strip *strip = &m.result.foils[0].strip;
    assert_near(strip->gamma, 1, 0);
    assert_near(strip->picture.sharpen_amount, 0, 0);
    assert_near(strip->picture.tone_s, 0, 0);
    assert_int_equal(strip->picture.findings, 0);
    assert_true(u_thickness_um(strip) < 0.6);
    measured_free(&m);
  }
}

/* The strength of the sharpening comes out, too. */
static void an_unsharp_mask_is_measured(void **state) {
  (void)state;
  static const driver_case c = {",\"bits\":16,\"unsharp_mask\":{\"amount_pct\":80,\"radius_px\":2}",
                                0, 0};
  measured m = measure_driver(&c, lights[0], FINE);
  assert_near(m.result.foils[0].strip.picture.sharpen_amount, 0.8, 0.1);
  assert_near(m.result.foils[0].strip.picture.sharpen_radius_px, 2, 0.2);
  measured_free(&m);
}

/* Draws a scan into a file and measures it. */
static fg_measurement measure_drawn(const char *json, const fg_design *design, bool without_plain) {
  char path[] = "/tmp/foilgauge_driver_XXXXXX";
  fg_context ctx = {0};
  fg_render_spec *spec = NULL;
  fg_measure_options options = {.without_plain = without_plain};
  fg_measurement m;
  int file = mkstemp(path);
  assert_true(file >= 0);
  close(file);
  if (fg_render_parse(&ctx, "plate", json, &spec) != FG_OK) fail_msg("%s", ctx.message);
  assert_ok(&ctx, fg_render_scan(&ctx, spec, path, NULL));
  if (fg_measure_scan(&ctx, path, design, &options, &m) != FG_OK) fail_msg("%s", ctx.message);
  fg_render_free(spec);
  unlink(path);
  return m;
}

/* Round edges under the same. */
static void discs_stay_round_and_right(void **state) {
  (void)state;
  static const driver_case cases[] = {
      {",\"unsharp_mask\":{\"amount_pct\":100,\"radius_px\":1}", 0, FG_PICTURE_SHARPENED},
      {"", 5, FG_PICTURE_TONE_CURVE},
      {",\"gamma\":3", 0, 0},
  };
  fg_design design;
  fg_design_default(&design);
  assert_int_equal(fg_design_become(NULL, FG_FOIL_DISCS, &design), FG_OK);
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    const driver_case *c = &cases[i];
    char json[8192], curve[4096] = "";
    if (c->s_slope > 0) write_s_curve(c->s_slope, curve, sizeof curve);
    snprintf(json, sizeof json,
             "{\"schema\":\"foilgauge/render/1\",\"seed\":7,\"discs\":[{\"centre_mm\":[3,3],"
             "\"radius_mm\":2}],\"scanner\":{\"dpi\":2400,\"noise\":1.2,\"blur_px\":1,%s%s%s}}",
             lights[i % 2], c->scanner, curve);
    fg_measurement m = measure_drawn(json, &design, false);
    assert_int_equal(m.disc_count, 1);
    const fg_disc *disc = &m.discs[0];
    double u = disc->blur_um * sqrt(2 * M_PI) * fmax(disc->picture.u_level, 0.002);
    if (fabs(1000 * disc->radius_mm - 2000) > 2 * u)
      fail_msg("%s, S %g: radius off by %.3f um, u %.3f", c->scanner, c->s_slope,
               1000 * disc->radius_mm - 2000, u);
    assert_true(!c->finding || (disc->picture.findings & c->finding));
    fg_measurement_free(&m);
  }
}

/* Edges with counts used as light are left out where nothing follows that needs them; all other
 * values stay. A gauge of the design needs them. */
static void plain_values_are_left_out(void **state) {
  (void)state;
  char json[8192];
  fg_design design;
  fg_design_default(&design);
  small_foil(json, sizeof json, 3, ",\"rotate_deg\":-73",
             "\"dpi\":%d,\"noise\":1.2,\"blur_px\":1,%s,\"gamma\":2", COARSE, lights[0]);
  fg_measurement with = measure_drawn(json, &design, false);
  fg_measurement without = measure_drawn(json, &design, true);
  design.gauge_count = 1;
  design.gauges[0] = (fg_gauge){.kind = FG_GAUGE_LEAF, .width_mm = 1, .u_mm = 0.001};
  fg_measurement gauged = measure_drawn(json, &design, true);
  const fg_strip *a = &with.foils[0].strip, *b = &without.foils[0].strip;
  assert_true(a->gamma > 1.5 && isfinite(a->plain_mm) && isfinite(a->plain_counts));
  assert_true(isnan(b->plain_mm) && isnan(b->plain_counts));
  assert_true(isfinite(gauged.foils[0].strip.plain_mm));
  assert_true(b->thickness_mm == a->thickness_mm && b->gamma == a->gamma);
  assert_true(without.foils[0].overall.radius_mm == with.foils[0].overall.radius_mm);
  assert_true(without.foils[0].overall.covariance[2][2] == with.foils[0].overall.covariance[2][2]);
  fg_measurement_free(&with);
  fg_measurement_free(&without);
  fg_measurement_free(&gauged);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sharpened_edges_stay_in_place),
      cmocka_unit_test(s_curves_are_held),
      cmocka_unit_test(powers_are_held),
      cmocka_unit_test(plain_edges_are_plain),
      cmocka_unit_test(an_unsharp_mask_is_measured),
      cmocka_unit_test(discs_stay_round_and_right),
      cmocka_unit_test(plain_values_are_left_out),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

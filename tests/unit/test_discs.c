/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Round features: plates with known truth, drawn, written and measured; what must be left alone. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "foilgauge/measure.h"
#include "foilgauge/render.h"
#include "geometry/disc_fit.h"
#include "support/test.h"

/* The renders' counts are proportional to the light but where they say gamma. */
static fg_status measure_file(fg_context *ctx, const char *path, unsigned threads, bool linear,
                              fg_measurement *m) {
  fg_design design;
  fg_measure_options options = {.threads = threads};
  fg_design_default(&design);
  assert_int_equal(fg_design_become(NULL, FG_FOIL_DISCS, &design), FG_OK);
  design.tone = linear ? FG_TONE_LINEAR : FG_TONE_UNKNOWN;
  return fg_measure_scan(ctx, path, &design, &options, m);
}

/* Draws a plate and measures it; `members` are those of the spec beside "schema" and "seed". */
static fg_status measure_stated(fg_context *ctx, const char *members, unsigned threads, bool linear,
                                fg_measurement *m) {
  char json[4096], path[] = "/tmp/foilgauge_discs_XXXXXX";
  fg_render_spec *spec = NULL;
  int file = mkstemp(path);
  assert_true(file >= 0);
  close(file);
  snprintf(json, sizeof json, "{\"schema\":\"foilgauge/render/1\",\"seed\":7,%s}", members);
  if (fg_render_parse(ctx, "plate.json", json, &spec) != FG_OK) fail_msg("%s", ctx->message);
  assert_ok(ctx, fg_render_scan(ctx, spec, path, NULL));
  fg_status status = measure_file(ctx, path, threads, linear, m);
  fg_render_free(spec);
  unlink(path);
  return status;
}

static fg_status measure_plate(fg_context *ctx, const char *members, unsigned threads,
                               fg_measurement *m) {
  return measure_stated(ctx, members, threads, false, m);
}

static fg_measurement measure_good(const char *members) {
  fg_context ctx = {0};
  fg_measurement m;
  if (measure_plate(&ctx, members, 0, &m) != FG_OK) fail_msg("%s", ctx.message);
  return m;
}

static void assert_disc(const fg_disc *disc, double x, double y, double radius,
                        double tolerance_um) {
  assert_near(disc->radius_mm * 1000, radius * 1000, tolerance_um);
  assert_near(disc->centre_mm.x * 1000, x * 1000, 2 * tolerance_um);
  assert_near(disc->centre_mm.y * 1000, y * 1000, 2 * tolerance_um);
  assert_true(fabs(disc->radius_mm - radius) < 4 * disc->u_radius_mm + 2e-6);
}

/* At 4800 dpi, contrast 175, blur 1.2, noise 2: the bound for R = 0.8 mm is 0.0043 µm. An unknown
 * tone curve moves the edge by 8 % of the contrast, over its slope there: 1.3 µm; one that is
 * stated as linear by 0.3 %. */
static void light_discs_have_their_radii(void **state) {
  (void)state;
  for (int linear = 0; linear < 2; linear++) {
    fg_context ctx = {0};
    fg_measurement m;
    fg_status status = measure_stated(&ctx,
                                      "\"discs\":[{\"centre_mm\":[1.4,1.5],\"radius_mm\":0.8},"
                                      "{\"centre_mm\":[3.5,1.503],\"radius_mm\":0.5137}],"
                                      "\"scanner\":{\"noise\":2}",
                                      0, linear, &m);
    assert_ok(NULL, status);
    assert_int_equal(m.disc_count, 2);
    assert_true(m.light_on_dark);
    assert_disc(&m.discs[0], 1.4, 1.5, 0.8, 0.03);
    assert_disc(&m.discs[1], 3.5, 1.503, 0.5137, 0.03);
    for (int i = 0; i < 2; i++) {
      assert_false(m.discs[i].hole);
      assert_true(m.discs[i].bright);
      assert_int_equal(m.discs[i].flags, 0);
      assert_true(m.discs[i].coverage_deg > 355);
      assert_true(m.discs[i].u_centre_mm[0] < 2e-5);
      assert_near(m.discs[i].u_radius_mm, linear ? 5e-5 : 1.3e-3, linear ? 1e-5 : 0.2e-3);
      assert_near(m.discs[i].blur_um, sqrt(1.2 * 1.2 + 1.0 / 12) * 25400 / 4800, 0.3);
      assert_true(m.discs[i].roundness_um < 0.3);
    }
    fg_measurement_free(&m);
  }
}

/* The blur's shift, s²/(2R) = 0.047 µm for s = 3 px and R = 0.5 mm, is put back. */
static void dark_blurred_discs_are_not_biased(void **state) {
  (void)state;
  fg_measurement m = measure_good("\"discs\":[{\"centre_mm\":[1.2,1.2],\"radius_mm\":0.5}],"
                                  "\"scanner\":{\"background\":215,\"contrast\":-160,\"bits\":16,"
                                  "\"noise\":0.2,\"blur_px\":3}");
  assert_int_equal(m.disc_count, 1);
  assert_false(m.light_on_dark);
  assert_false(m.discs[0].bright);
  assert_disc(&m.discs[0], 1.2, 1.2, 0.5, 0.02);
  fg_measurement_free(&m);
}

static void a_hole_in_a_disc_is_a_hole(void **state) {
  (void)state;
  fg_measurement m =
      measure_good("\"discs\":[{\"centre_mm\":[2,2],\"radius_mm\":1.5},"
                   "{\"centre_mm\":[2.1,1.9],\"radius_mm\":0.6,\"hole\":true}],\"scanner\":{}");
  assert_int_equal(m.disc_count, 2);
  assert_true(m.discs[0].hole);
  assert_disc(&m.discs[0], 2.1, 1.9, 0.6, 0.05);
  assert_false(m.discs[1].hole);
  assert_disc(&m.discs[1], 2, 2, 1.5, 0.05);
  fg_measurement_free(&m);
}

/* r = R + a cos(5 phi): peak to valley 2a times what passes the filter at 5 of 50 per turn. */
static void lobes_are_roundness(void **state) {
  (void)state;
  fg_measurement m =
      measure_good("\"discs\":[{\"centre_mm\":[2,2],\"radius_mm\":1.2,\"lobes\":5,\"lobe_um\":3}],"
                   "\"scanner\":{\"noise\":2}");
  assert_int_equal(m.disc_count, 1);
  assert_near(m.discs[0].roundness_um, 6 * exp(-M_LN2 * 0.01), 0.25);
  assert_true(m.discs[0].u_roundness_um < 0.2);
  assert_near(m.discs[0].rms_um, 3 / M_SQRT2, 0.2);
  assert_near(m.discs[0].radius_mm, 1.2, 2e-4);
  fg_measurement_free(&m);
}

static void a_tone_curve_does_not_move_the_edge(void **state) {
  (void)state;
  fg_measurement m = measure_good("\"discs\":[{\"centre_mm\":[2,2],\"radius_mm\":1.2}],"
                                  "\"scanner\":{\"gamma\":1.8,\"bits\":16,\"blur_px\":1.5}");
  assert_int_equal(m.disc_count, 1);
  assert_near(m.discs[0].radius_mm * 1000, 1200, 0.2);
  fg_measurement_free(&m);
}

static void a_disc_cut_by_the_border_says_its_coverage(void **state) {
  (void)state;
  fg_measurement m =
      measure_good("\"width_px\":600,\"height_px\":500,\"discs\":[{\"centre_mm\":[1.6,0.4],"
                   "\"radius_mm\":0.8}],\"scanner\":{}");
  assert_int_equal(m.disc_count, 1);
  assert_near(m.discs[0].radius_mm * 1000, 800, 0.1);
  assert_near(m.discs[0].coverage_deg, 240, 6);
  fg_measurement_free(&m);
}

static void touching_discs_are_two(void **state) {
  (void)state;
  fg_measurement m = measure_good("\"discs\":[{\"centre_mm\":[1.2,1.3],\"radius_mm\":0.8},"
                                  "{\"centre_mm\":[1.2,2.7],\"radius_mm\":0.6}],\"scanner\":{}");
  assert_int_equal(m.disc_count, 2);
  assert_near(m.discs[0].radius_mm * 1000, 800, 0.5);
  assert_near(m.discs[1].radius_mm * 1000, 600, 0.5);
  for (int i = 0; i < 2; i++)
    assert_true(m.discs[i].coverage_deg < 350);
  fg_measurement_free(&m);
}

static void a_faint_disc_is_found(void **state) {
  (void)state;
  fg_measurement m = measure_good("\"discs\":[{\"centre_mm\":[1.4,1.4],\"radius_mm\":0.8}],"
                                  "\"scanner\":{\"background\":100,\"contrast\":25,\"noise\":2}");
  assert_int_equal(m.disc_count, 1);
  assert_near(m.discs[0].radius_mm * 1000, 800, 0.2);
  fg_measurement_free(&m);
}

static void nothing_round_is_an_error(void **state) {
  (void)state;
  static const char *const plates[] = {
      "\"width_px\":400,\"height_px\":400,\"discs\":[{\"centre_mm\":[30,30],\"radius_mm\":1}],"
      "\"scanner\":{}",
      "\"foils\":[{}],\"scanner\":{\"dpi\":1200}",
  };
  for (size_t i = 0; i < sizeof plates / sizeof *plates; i++) {
    in_row("plates[%zu]", i);
    fg_context ctx = {0};
    fg_measurement m;
    assert_status(&ctx, measure_plate(&ctx, plates[i], 0, &m), FG_ERR_DATA);
    assert_has(ctx.message, "no round hole or disc in the picture");
    fg_measurement_free(&m);
  }
}

/* Two lobes are an oval, four a square with round corners. */
static void an_oval_disc_is_measured_or_flagged(void **state) {
  (void)state;
  static const int lobes[] = {2, 4};
  for (size_t i = 0; i < 2; i++) {
    char members[256];
    snprintf(members, sizeof members,
             "\"discs\":[{\"centre_mm\":[1.5,1.5],\"radius_mm\":1,\"lobes\":%d,\"lobe_um\":60},"
             "{\"centre_mm\":[3.8,1.5],\"radius_mm\":0.8}],\"scanner\":{}",
             lobes[i]);
    fg_measurement m = measure_good(members);
    bool found = false;
    for (size_t k = 0; k < m.disc_count; k++) {
      bool oval = m.discs[k].centre_mm.x < 2.7;
      found |= !oval && m.discs[k].flags == 0;
      if (oval) assert_true(m.discs[k].flags & FG_BUMP_POOR_FIT);
    }
    assert_true(found);
    fg_measurement_free(&m);
  }
}

static void threads_do_not_change_the_result(void **state) {
  (void)state;
  const char *plate = "\"discs\":[{\"centre_mm\":[1.4,1.5],\"radius_mm\":0.8},"
                      "{\"centre_mm\":[3.5,1.5],\"radius_mm\":0.5}],\"scanner\":{\"noise\":3}";
  fg_context ctx = {0};
  fg_measurement one, two;
  assert_ok(&ctx, measure_plate(&ctx, plate, 1, &one));
  assert_ok(&ctx, measure_plate(&ctx, plate, 2, &two));
  assert_int_equal(one.disc_count, two.disc_count);
  for (size_t i = 0; i < one.disc_count; i++) {
    assert_true(one.discs[i].radius_mm == two.discs[i].radius_mm);
    assert_true(one.discs[i].u_radius_mm == two.discs[i].u_radius_mm);
    assert_true(one.discs[i].roundness_um == two.discs[i].roundness_um);
  }
  fg_measurement_free(&one);
  fg_measurement_free(&two);
}

/* The filter passes a half of the amplitude at 50 undulations per turn and nearly all at 3. */
static void roundness_is_filtered(void **state) {
  (void)state;
  fg_context ctx = {0};
  double values[2000], roundness, u;
  static const struct {
    int harmonic;
    double share;
  } cases[] = {{1, 0}, {3, 0.9975}, {50, 0.5}, {100, 0.0625}};
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    in_row("cases[%zu]", c);
    for (int i = 0; i < 2000; i++)
      values[i] = 5 + cos(2 * M_PI * cases[c].harmonic * (i + 0.5) / 2000);
    assert_ok(&ctx, fg_roundness(&ctx, values, 2000, 0, &roundness, &u));
    assert_near(roundness, 2 * cases[c].share, 0.01);
    assert_near(u, 0, 1e-9);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(light_discs_have_their_radii),
      cmocka_unit_test(dark_blurred_discs_are_not_biased),
      cmocka_unit_test(a_hole_in_a_disc_is_a_hole),
      cmocka_unit_test(lobes_are_roundness),
      cmocka_unit_test(a_tone_curve_does_not_move_the_edge),
      cmocka_unit_test(a_disc_cut_by_the_border_says_its_coverage),
      cmocka_unit_test(touching_discs_are_two),
      cmocka_unit_test(a_faint_disc_is_found),
      cmocka_unit_test(nothing_round_is_an_error),
      cmocka_unit_test(an_oval_disc_is_measured_or_flagged),
      cmocka_unit_test(threads_do_not_change_the_result),
      cmocka_unit_test(roundness_is_filtered),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

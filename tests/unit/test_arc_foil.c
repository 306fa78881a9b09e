/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plain strips through the measuring chain: radius, angle and length within their uncertainty of
 * the truth on every datum; and foils that are no plain strip. */
#include "support/measured_render.h"
#include "support/test.h"

/* Limit for one value of many, in standard uncertainties: exceeded by 1 in 150,000. */
static const double many_u = 4.5;

static fg_design arc_design(fg_datum datum, double radius_mm) {
  fg_design design;
  fg_design_default(&design);
  assert_int_equal(fg_design_become(NULL, FG_FOIL_ARC, &design), FG_OK);
  design.datum = datum;
  design.overall_radius_mm = radius_mm;
  design.arc.subtended_angle_deg = 40;
  return design;
}

static void arc_spec(char *json, size_t size, const char *foil, const char *scanner) {
  snprintf(json, size,
           "{\"schema\":\"foilgauge/render/1\",\"seed\":5,\"foils\":[{\"design\":{\"form\":\"arc\","
           "\"overall_radius_mm\":15,\"subtended_angle_deg\":40}%s%s}],"
           "\"scanner\":{%s}}",
           strstr(foil, "overall_radius_mm") ? "" : ",\"overall_radius_mm\":15.2", foil, scanner);
}

static measured measure_stated(fg_datum datum, fg_tone_statement tone, double radius_mm,
                               const char *foil, const char *scanner) {
  char json[2048];
  fg_design design = arc_design(datum, radius_mm);
  design.tone = tone;
  arc_spec(json, sizeof json, foil, scanner);
  measured m = measure_render(json, &design);
  assert_ok(NULL, m.status);
  assert_int_equal(m.result.foil_count, 1);
  return m;
}

static measured measure_arc(fg_datum datum, double radius_mm, const char *foil,
                            const char *scanner) {
  return measure_stated(datum, FG_TONE_UNKNOWN, radius_mm, foil, scanner);
}

static void check_within(const char *name, double value, double truth, double u, double max) {
  if (!(fabs(value - truth) <= many_u * u) || !(u > 0) || !(u < max))
    fail_msg("%s is %.8g, not %.8g: off by %.3g, u %.3g", name, value, truth, value - truth, u);
}

/* `u_mm`: what the uncertainty along the strip must be below. */
static void check_arc(fg_datum datum, fg_tone_statement tone, double designed_mm, const char *foil,
                      const char *scanner, double u_mm) {
  static const double shift[] = {
      [FG_DATUM_MID] = 0, [FG_DATUM_INNER] = -0.05, [FG_DATUM_OUTER] = 0.05};
  measured m = measure_stated(datum, tone, designed_mm, foil, scanner);
  const fg_foil *f = &m.result.foils[0];
  const fg_render_foil *t = &m.picture.truth->foils[0];
  double radius = t->overall_radius_mm + shift[datum], angle = t->subtended_angle_deg;
  assert_int_equal(f->flags & ~(unsigned)(FG_FOIL_ROUGH_EDGE | FG_FOIL_SIDE_BAND), 0);
  assert_int_equal(f->bump_count, 0);
  check_within("R0", f->overall.radius_mm, radius, f->overall.u_radius_mm, 20 * u_mm);
  check_within("angle", f->arc.subtended_angle_deg, angle, f->arc.u_subtended_angle_deg,
               20 * u_mm * 180 / M_PI / designed_mm);
  check_within("length", f->arc.length_mm, radius * angle * M_PI / 180, f->arc.u_length_mm, u_mm);
  assert_near(f->arc.subtended_angle_error_pct, 100 * (f->arc.subtended_angle_deg - 40) / 40, 1e-9);
  assert_near(f->arc.u_subtended_angle_error_pct, 100 * f->arc.u_subtended_angle_deg / 40, 1e-9);
  assert_near(f->overall.springback_error_pct,
              100 * (designed_mm - f->overall.radius_mm) / designed_mm, 1e-9);
  measured_free(&m);
}

#define CLEAN "\"dpi\":2400"
#define ROUGH                                                                                      \
  "\"dpi\":4800,\"blur_px\":1.9,\"noise\":1.8,\"noise_correlation\":0.6,\"rough\":{"               \
  "\"one_sided_blur_px\":1.8,\"edge_roughness_um\":1.4,\"edge_common_um\":0.7,"                    \
  "\"correlation_um\":50,\"halo\":{\"fraction\":0.15,\"length_px\":15}}"

/* An unknown tone curve moves both cuts: 5 µm at 2400 dpi. */
static void values_are_within_their_uncertainty(void **state) {
  (void)state;
  const fg_tone_statement linear = FG_TONE_LINEAR, unknown = FG_TONE_UNKNOWN;
  const char *inner = ",\"rotate_deg\":131,\"subtended_angle_deg\":33";
  const char *dark = CLEAN ",\"background\":210,\"contrast\":-160";
  check_arc(FG_DATUM_MID, linear, 15, ",\"rotate_deg\":17", CLEAN, 1e-3);
  check_arc(FG_DATUM_INNER, linear, 15, inner, CLEAN, 1e-3);
  check_arc(FG_DATUM_INNER, unknown, 15, inner, CLEAN, 8e-3);
  check_arc(FG_DATUM_OUTER, unknown, 15, ",\"rotate_deg\":-75,\"mirror\":true",
            CLEAN ",\"gamma\":1.8", 8e-3);
  check_arc(FG_DATUM_MID, linear, 15, ",\"rotate_deg\":-90", dark, 1e-3);
  check_arc(FG_DATUM_MID, unknown, 15, ",\"rotate_deg\":60,\"subtended_angle_deg\":20", ROUGH,
            15e-3);
}

/* More than half a turn: the angle is the long way round. */
static void more_than_half_a_turn(void **state) {
  (void)state;
  check_arc(FG_DATUM_MID, FG_TONE_LINEAR, 4.1,
            ",\"rotate_deg\":17,\"overall_radius_mm\":4,\"subtended_angle_deg\":230", CLEAN, 1e-3);
}

/* ---- foils that are no plain strip, or show no angle ---- */

static void a_lip_leaves_the_circle_and_no_angle(void **state) {
  (void)state;
  static const char *const lips[] = {",\"lip\":{}", ",\"lip\":{\"side\":\"inwards\"}"};
  for (size_t i = 0; i < 2; i++) {
    measured m = measure_arc(FG_DATUM_MID, 15, lips[i], CLEAN);
    const fg_foil *f = &m.result.foils[0];
    assert_true(f->flags & FG_FOIL_LIP);
    assert_false(f->flags & (FG_FOIL_BUMPS_ON_ARC | FG_FOIL_NOT_MEASURED));
    assert_true(isnan(f->arc.subtended_angle_deg) && isnan(f->arc.u_length_mm));
    check_within("R0", f->overall.radius_mm, 15.2, f->overall.u_radius_mm, 5e-3);
    measured_free(&m);
  }
}

static void a_foil_with_bumps_is_none(void **state) {
  (void)state;
  char json[4096];
  fg_design design = arc_design(FG_DATUM_MID, 15);
  small_foil(json, sizeof json, 4, "", CLEAN);
  measured m = measure_render(json, &design);
  assert_ok(NULL, m.status);
  assert_int_equal(m.result.foil_count, 1);
  const fg_foil *f = &m.result.foils[0];
  assert_true(f->flags & FG_FOIL_BUMPS_ON_ARC && f->flags & FG_FOIL_NOT_MEASURED);
  assert_has(f->error, "bumps");
  assert_true(isnan(f->arc.subtended_angle_deg));
  measured_free(&m);
}

/* The picture ends within the strip. */
static void the_border_hides_an_end(void **state) {
  (void)state;
  measured m = measure_arc(FG_DATUM_MID, 15, ",\"rotate_deg\":-90,\"centre_mm\":[3,17]", CLEAN);
  const fg_foil *f = &m.result.foils[0];
  assert_true(f->flags & FG_FOIL_TOUCHES_BORDER);
  assert_true(f->strip.ends[0].found != f->strip.ends[1].found);
  assert_true(isnan(f->arc.subtended_angle_deg));
  check_within("R0", f->overall.radius_mm, 15.2, f->overall.u_radius_mm, 20e-3);
  measured_free(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(values_are_within_their_uncertainty),
      cmocka_unit_test(more_than_half_a_turn),
      cmocka_unit_test(a_lip_leaves_the_circle_and_no_angle),
      cmocka_unit_test(a_foil_with_bumps_is_none),
      cmocka_unit_test(the_border_hides_an_end),
  };
  return cmocka_run_group_tests_name("arc foils", tests, NULL, NULL);
}

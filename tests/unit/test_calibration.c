/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Calibrations: a certificate is read, or refused with its place; its uncertainty is in every u, by
 * as much as another pixel moves the value. */
#include "foilgauge/calibration.h"
#include "foilgauge/measure.h"
#include "foilgauge/report.h"
#include "quantity/quantity_rows.h"
#include "support/measured_render.h"
#include "support/test.h"

static fg_design read_design(const char *calibration) {
  char json[1024];
  fg_context ctx = {0};
  fg_design design;
  fg_design_default(&design);
  snprintf(json, sizeof json, "{\"schema\":\"foilgauge/design/1\",\"calibration\":%s}",
           calibration);
  if (fg_design_parse(&ctx, "d.json", json, &design) != FG_OK) fail_msg("%s", ctx.message);
  return design;
}

static void certificates_state_u_or_expanded_u_with_its_factor(void **state) {
  (void)state;
  fg_calibration c =
      read_design("{\"certificate\":\"K 1\",\"date\":\"2026-03-14\","
                  "\"scale\":{\"U_rel\":3e-4,\"k\":2},"
                  "\"temperature\":{\"value_C\":25,\"u_K\":0.5},"
                  "\"expansion\":{\"value_per_K\":1.2e-5,\"U_per_K\":3e-6,\"k\":1.5}}")
          .calibration;
  assert_true(c.stated && !c.per_axis && c.has_temperature);
  assert_near(c.u_scale[0], 1.5e-4, 1e-15);
  assert_near(c.u_scale[1], 1.5e-4, 1e-15);
  assert_near(c.u_expansion_per_k, 2e-6, 1e-15);
  assert_near(fg_calibration_factor(&c), 1 - 6e-5, 1e-12);
  fg_calibration_budget terms = fg_calibration_terms(&c);
  assert_near(terms.temperature, 6e-6, 1e-15);
  assert_near(terms.expansion, 1e-5, 1e-15);
  assert_near(terms.length[0], sqrt(1.5e-4 * 1.5e-4 + 6e-6 * 6e-6 + 1e-10), 1e-12);
  assert_false(read_design("null").calibration.stated);
}

/* Two errors that are independent have the covariance of x and y: what heat does is common. */
static void a_common_error_correlates_two_axes(void **state) {
  (void)state;
  const char *const stated[] = {
      "{\"scale\":{\"x\":{\"u_rel\":1e-4},\"y\":{\"u_rel\":3e-4}},"
      "\"temperature\":{\"value_C\":20,\"u_K\":10},\"expansion\":{\"value_per_K\":2e-5,\"u_per_K\":"
      "0}}",
      "{\"scale\":{\"u_rel\":1e-4}}", "{\"scale\":{\"x\":{\"u_rel\":0},\"y\":{\"u_rel\":3e-4}}}"};
  const double expected[][3] = {{5e-8, 4e-8, 13e-8}, {1e-8, 1e-8, 1e-8}, {0, 0, 9e-8}};
  for (size_t i = 0; i < 3; i++) {
    double s[FG_CALIBRATION_SOURCES][2], xx = 0, xy = 0, yy = 0;
    fg_calibration c = read_design(stated[i]).calibration;
    fg_calibration_sources(&c, s);
    for (size_t k = 0; k < FG_CALIBRATION_SOURCES; k++) {
      xx += s[k][0] * s[k][0];
      xy += s[k][0] * s[k][1];
      yy += s[k][1] * s[k][1];
    }
    assert_near(xx, expected[i][0], 1e-14);
    assert_near(xy, expected[i][1], 1e-14);
    assert_near(yy, expected[i][2], 1e-14);
  }
}

static void invalid_calibrations_are_refused_with_their_place(void **state) {
  static const struct {
    const char *stated, *words;
  } cases[] = {
      {"1", "d.json: calibration: must be an object"},
      {"{}", "calibration: scale is missing"},
      {"{\"scale\":{\"u_rel\":1e-4},\"scael\":1}", "calibration.scael: is not known; there are"},
      {"{\"scale\":{\"u_rel\":1e-4},\"scale\":{\"u_rel\":1e-4}}",
       "calibration.scale: is given twice"},
      {"{\"scale\":{\"u\":1e-4}}", "calibration.scale.u: is not known; there are u_rel, U_rel, k"},
      {"{\"scale\":{}}", "calibration.scale: needs either u_rel"},
      {"{\"scale\":{\"u_rel\":1e-4,\"U_rel\":1e-4}}", "calibration.scale: needs either u_rel"},
      {"{\"scale\":{\"U_rel\":1e-4}}", "U_rel needs its factor k"},
      {"{\"scale\":{\"u_rel\":1e-4,\"k\":2}}", "k belongs to U_rel"},
      {"{\"scale\":{\"U_rel\":1e-4,\"k\":0.2}}", "k is 0.2; it must be from 1 to 4"},
      {"{\"scale\":{\"u_rel\":\"1e-4\"}}", "calibration.scale.u_rel: must be a number"},
      {"{\"scale\":{\"u_rel\":1e999}}", "calibration.scale.u_rel: the number is too large"},
      {"{\"scale\":{\"u_rel\":-1e-4}}", "calibration.scale: a standard uncertainty of -0.0001"},
      {"{\"scale\":{\"u_rel\":0}}", "no scale is known exactly"},
      {"{\"scale\":{\"u_rel\":0.1}}", "it must be from 0 to 0.05 of the length"},
      {"{\"scale\":{\"x\":{\"u_rel\":1e-4}}}", "calibration.scale: y is missing"},
      {"{\"scale\":{\"x\":{\"u_rel\":1e-4},\"y\":{\"u_rel\":0.2}}}",
       "calibration.scale.y: a standard"},
      {"{\"scale\":{\"x\":{\"u_rel\":1e-4},\"u_rel\":1}}", "calibration.scale.u_rel: is not known"},
      {"{\"scale\":{\"u_rel\":1e-4},\"temperature\":{\"value_C\":20,\"u_K\":1}}",
       "expansion is missing; temperature and expansion go together"},
      {"{\"scale\":{\"u_rel\":1e-4},\"temperature\":{\"value_C\":293,\"u_K\":1},"
       "\"expansion\":{\"value_per_K\":1e-5,\"u_per_K\":0}}",
       "temperature.value_C is 293; it must be from 0 to 60"},
      {"{\"scale\":{\"u_rel\":1e-4},\"temperature\":{\"u_K\":1},"
       "\"expansion\":{\"value_per_K\":1e-5,\"u_per_K\":0}}",
       "calibration.temperature: value_C is missing"},
      {"{\"scale\":{\"u_rel\":1e-4},\"temperature\":{\"value_C\":20,\"u_K\":1},"
       "\"expansion\":{\"value_per_K\":12,\"u_per_K\":0}}",
       "expansion.value_per_K is 12; it must be from -0.0001 to 0.0001 per kelvin"},
      {"{\"scale\":{\"u_rel\":1e-4},\"date\":\"yesterday!\"}",
       "is no date; write it as 2026-03-14"},
      {"{\"scale\":{\"u_rel\":1e-4},\"certificate\":7}", "calibration.certificate: must be a text"},
  };
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    in_row("cases[%zu]", i);
    char json[1024];
    fg_context ctx = {0};
    fg_design design;
    fg_design_default(&design);
    snprintf(json, sizeof json, "{\"schema\":\"foilgauge/design/1\",\"calibration\":%s}",
             cases[i].stated);
    assert_status(&ctx, fg_design_parse(&ctx, "d.json", json, &design), FG_ERR_DATA);
    if (!strstr(ctx.message, cases[i].words)) fail_msg("%s: %s", cases[i].stated, ctx.message);
    assert_false(design.calibration.stated);
  }
  fg_calibration nan = {.stated = true, .u_scale = {NAN, 0}};
  assert_status(NULL, fg_calibration_check(NULL, &nan), FG_ERR_DATA);
}

/* The picture with pixels longer by x and y. */
static measured measure_longer(const char *spec, const fg_design *design, double x, double y) {
  measured m = {.picture = render_open(spec)};
  m.result.design = *design;
  assert_ok(&m.ctx, fg_design_derive(&m.ctx, design, &m.result.nominal));
  m.result.dpi[0] = m.picture.truth->dpi[0] / (1 + x);
  m.result.dpi[1] = m.picture.truth->dpi[1] / (1 + y);
  measure_rows(&m);
  assert_ok(NULL, m.status);
  assert_int_equal(m.result.foil_count, 1);
  return m;
}

typedef struct three {
  const void *plain, *longer, *wide; /* as it is, with longer pixels, with the calibration */
  const fg_calibrated *calibrated;
} three;

/* A row that is not measured again would not move; one that is not widened keeps its u. */
static void check_rows(fg_quantity_owner owner, const three *of) {
  size_t count, at = 0;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++) {
    double plain[FG_QUANTITY_NUMBERS_MAX], longer[FG_QUANTITY_NUMBERS_MAX],
        wide[FG_QUANTITY_NUMBERS_MAX];
    size_t values = fg_quantity_values(&rows[i]);
    if (!fg_quantity_has_u(&rows[i])) continue;
    fg_quantity_numbers(&rows[i], of->plain, plain);
    fg_quantity_numbers(&rows[i], of->longer, longer);
    fg_quantity_numbers(&rows[i], of->wide, wide);
    for (size_t k = 0; k < values; k++, at++) {
      double move = of->calibrated->move[0][at], u = plain[values + k];
      if (!isfinite(plain[k])) continue;
      if (!(fabs(move - (longer[k] - plain[k])) < 0.02 * fabs(move) + 0.5 * u))
        fail_msg("%s: moved by %g, by longer pixels %g", rows[i].name, move, longer[k] - plain[k]);
      if (!(fabs(wide[values + k] - hypot(u, move)) <= 1e-9 * wide[values + k]))
        fail_msg("u of %s is %g, not %g with %g", rows[i].name, wide[values + k], u, move);
      assert_true(wide[k] == plain[k]);
    }
    if (!strncmp(rows[i].name, "correction", 10)) continue;
    bool arc = !fg_quantity_applies(owner, &rows[i], FG_FOIL_CLASSICAL);
    double own = fg_quantity_calibration(owner, &rows[i], of->calibrated);
    if (!arc) assert_near(own, fabs(of->calibrated->move[0][at - values]), 1e-15);
  }
}

static void check_foil(const char *calibration, double x, double y) {
  char spec[4096];
  small_foil(spec, sizeof spec, 3, ",\"rotate_deg\":25", "\"dpi\":2400,\"blur_px\":1");
  fg_design design = read_design("null"), stated = read_design(calibration);
  measured plain = measure_longer(spec, &design, 0, 0),
           longer = measure_longer(spec, &design, x, y);
  measured wide = measure_longer(spec, &stated, 0, 0);
  assert_ok(&plain.ctx, fg_measurement_calibrate(&plain.ctx, 1, &plain.result));
  assert_false(plain.result.calibrated);
  for (int again = 0; again < 2; again++) /* once */
    assert_ok(&wide.ctx, fg_measurement_calibrate(&wide.ctx, 1, &wide.result));
  const fg_foil *a = plain.result.foils, *b = longer.result.foils, *c = wide.result.foils;
  check_rows(FG_QUANTITY_OF_FOIL, &(three){a, b, c, &c->calibrated});
  assert_int_equal(c->bump_count, 3);
  for (size_t i = 0; i < 3; i++)
    check_rows(FG_QUANTITY_OF_BUMP,
               &(three){&a->bumps[i], &b->bumps[i], &c->bumps[i], &c->bumps[i].calibrated});
  measured_free(&plain);
  measured_free(&longer);
  measured_free(&wide);
}

static void a_longer_pixel_moves_every_quantity_as_its_u_says(void **state) {
  (void)state;
  check_foil("{\"scale\":{\"u_rel\":2e-3}}", 2e-3, 2e-3);
  check_foil("{\"scale\":{\"x\":{\"u_rel\":2e-3},\"y\":{\"u_rel\":0}}}", 2e-3, 0);
}

/* Angles keep; a bump's radius takes the whole of it. */
static void one_scale_leaves_angles(void **state) {
  char spec[4096];
  (void)state;
  small_foil(spec, sizeof spec, 3, "", "\"dpi\":1200");
  fg_design design = read_design("{\"scale\":{\"u_rel\":1e-3}}");
  measured m = measure_longer(spec, &design, 0, 0);
  assert_ok(&m.ctx, fg_measurement_calibrate(&m.ctx, 1, &m.result));
  const fg_bump *bump = &m.result.foils[0].bumps[1];
  const fg_quantity *radius = fg_quantity_find(FG_QUANTITY_OF_BUMP, "radius_mm");
  const fg_quantity *angle = fg_quantity_find(FG_QUANTITY_OF_BUMP, "bump_angle_deg");
  assert_near(fg_quantity_calibration(FG_QUANTITY_OF_BUMP, radius, &bump->calibrated) /
                  bump->radius_mm,
              1e-3, 1e-6);
  assert_true(fg_quantity_calibration(FG_QUANTITY_OF_BUMP, angle, &bump->calibrated) < 1e-4);
  measured_free(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(certificates_state_u_or_expanded_u_with_its_factor),
      cmocka_unit_test(a_common_error_correlates_two_axes),
      cmocka_unit_test(invalid_calibrations_are_refused_with_their_place),
      cmocka_unit_test(a_longer_pixel_moves_every_quantity_as_its_u_says),
      cmocka_unit_test(one_scale_leaves_angles),
  };
  return cmocka_run_group_tests_name("calibration", tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects of the part as the renderer draws them. */
#include "render_picture.h"
#include "support/test.h"

static double crown_with(const char *effect, const char *more, size_t bump) {
  picture p = draw_format("{\"schema\":\"foilgauge/render/1\",\"foils\":[{"
                          "\"design\":{\"bump_count\":3},"
                          "\"overall_radius_mm\":20.95%s}],\"effects\":[%s],"
                          "\"scanner\":{" EXACT "}}",
                          more, effect);
  double thickness, moved = crown(&p, bump, &thickness);
  drop(&p);
  return moved * pixel * 1e3;
}

/* At the crown of the middle bump, which stands upright: psi = 0, u = 0. Rows rise towards O. */
static void part_effects_move_the_crown(void **state) {
  (void)state;
  assert_near(crown_with("{\"id\":\"part.bump_crown\",\"amplitude_um\":5}", "", 1), 5, 0.02);
  /* The column is a pixel's: up to half of one beside the crown, where a skew is not level. */
  assert_near(crown_with("{\"id\":\"part.bump_skew\",\"amplitude_um\":5}", "", 1), 0, 0.03);
  assert_near(crown_with("{\"id\":\"part.ovality\",\"amplitude_um\":5}", "", 1), -5, 0.02);
  assert_near(crown_with("{\"id\":\"part.ovality\",\"amplitude_um\":5,\"phase_deg\":90}", "", 1), 5,
              0.02);
  assert_near(
      crown_with("{\"id\":\"part.ovality\",\"amplitude_um\":5,\"along\":\"normal\"}", "", 1), -5,
      0.02);
  assert_near(crown_with("{\"id\":\"part.spiral\",\"amplitude_um\":5}", "", 1), 0, 0.02);
}

/* A spec whose effect has an amplitude of 0, and of 10 um. */
static void parse_without_and_with(fg_context *ctx, const char *format, fg_render_spec *specs[2]) {
  char json[512];
  for (int i = 0; i < 2; i++) {
    snprintf(json, sizeof json, format, i ? 10 : 0);
    assert_ok(ctx, fg_render_parse(ctx, "spec.json", json, &specs[i]));
  }
}

/* Along the normal every place of the midline moves at right angles to it, on a flank too. */
static void normal_ovality_moves_at_right_angles(void **state) {
  (void)state;
  fg_context ctx = {0};
  const char *format =
      "{\"schema\":\"foilgauge/render/1\",\"foils\":[{\"lip\":null,\"centre_mm\":[20,30]}],"
      "\"effects\":[{\"id\":\"part.ovality\",\"amplitude_um\":%d,"
      "\"along\":\"normal\"}]}";
  fg_render_spec *specs[2];
  parse_without_and_with(&ctx, format, specs);
  for (double s = 2; s < 40; s += 0.37) {
    fg_point at, on, moved;
    assert_ok(&ctx, fg_render_midline(&ctx, specs[0], 0, s, &at));
    assert_ok(&ctx, fg_render_midline(&ctx, specs[0], 0, s + 1e-4, &on));
    assert_ok(&ctx, fg_render_midline(&ctx, specs[1], 0, s, &moved));
    double tx = on.x - at.x, ty = on.y - at.y, dx = moved.x - at.x, dy = moved.y - at.y;
    double along = (dx * tx + dy * ty) / hypot(tx, ty);
    assert_near(along * pixel * 1e3, 0, 0.01);
    assert_true(hypot(dx, dy) * pixel * 1e3 < 10.01);
  }
  for (int i = 0; i < 2; i++)
    fg_render_free(specs[i]);
}

static void spiral_lies_beside_the_plain_foil(void **state) {
  (void)state;
  fg_context ctx = {0};
  const char *format = "{\"schema\":\"foilgauge/render/1\",\"foils\":[{\"lip\":null,"
                       "\"first_land_mm\":1,\"last_land_mm\":1,\"centre_mm\":[20,30]}],\"effects\":"
                       "[{\"id\":\"part.spiral\","
                       "\"amplitude_um\":%d}]}";
  fg_render_spec *specs[2];
  parse_without_and_with(&ctx, format, specs);
  fg_point a, b;
  assert_ok(&ctx, fg_render_midline(&ctx, specs[0], 0, 0, &a));
  assert_ok(&ctx, fg_render_midline(&ctx, specs[1], 0, 0, &b));
  /* The lip's end of the foil has u = -1: it moves inwards by the amplitude. */
  double ox = 20 / pixel, oy = 30 / pixel;
  assert_near((hypot(b.x - ox, b.y - oy) - hypot(a.x - ox, a.y - oy)) * pixel * 1e3, -10, 0.2);
  for (int i = 0; i < 2; i++)
    fg_render_free(specs[i]);
}

static void lip_decay_widens_the_first_bumps(void **state) {
  (void)state;
  picture p = draw(0, "{\"schema\":\"foilgauge/render/1\",\"effects\":[{\"id\":\"part.lip_decay\","
                      "\"amplitude_rel\":0.06}],\"scanner\":{\"dpi\":1200}}");
  const fg_render_bump *bumps = p.truth->foils[0].bumps;
  for (int i = 0; i < 9; i++) {
    double radius = 3.32 * (1 + 0.06 * exp(-i / 2.0));
    assert_near(bumps[i].radius_mm, radius, 1e-12);
    assert_near(bumps[i].bump_angle_deg * radius, 63.15 * 3.32, 1e-9);
  }
  drop(&p);
}

static fg_render_foil load_truth(const char *json, fg_render_spec **spec) {
  fg_context ctx = {0};
  assert_ok(&ctx, fg_render_parse(&ctx, "spec.json", json, spec));
  return fg_render_get_truth(*spec)->foils[0];
}

/* Of a nearly closed ring the least-squares circle is the ideal one, and an ovality of amplitude a
 * deviates from it by 2 a, peak to valley. */
static void ovality_of_a_ring_deviates_by_twice_its_amplitude(void **state) {
  (void)state;
  fg_render_spec *spec;
  fg_render_foil foil =
      load_truth("{\"schema\":\"foilgauge/render/1\",\"foils\":[{\"design\":{\"form\":\"arc\","
                 "\"overall_radius_mm\":20,\"subtended_angle_deg\":350}}],\"effects\":[{\"id\":"
                 "\"part.ovality\",\"amplitude_um\":12,\"phase_deg\":20}]}",
                 &spec);
  assert_near(foil.measurand.form_error_um, 24, 0.8);
  assert_near(foil.measurand.radius_mm, 20, 3e-4);
  assert_near(foil.overall_radius_mm, 20, 0);
  fg_render_free(spec);
}

/* On a shallow arc (1 - u²)² is 8/15 - 16/21 P2 + 8/35 P4; the circle takes all but P4, which goes
 * from -3/7 to 1. The arc's own curvature takes 0.045 of it, and its ends that are left out 0.066.
 */
static void crown_moves_the_measurand_of_bumps(void **state) {
  (void)state;
  fg_render_spec *spec;
  fg_render_foil foil = load_truth("{\"schema\":\"foilgauge/render/1\",\"effects\":[{\"id\":"
                                   "\"part.bump_crown\",\"amplitude_um\":10}]}",
                                   &spec);
  for (size_t b = 0; b < foil.bump_count; b++) {
    const fg_render_measurand *circle = &foil.bumps[b].measurand;
    assert_near(circle->form_error_um, 10 * 8.0 / 35 * 10 / 7 * 0.955 * 0.934, 0.1);
    assert_true(circle->radius_mm < foil.bumps[b].radius_mm - 0.05);
    assert_near(circle->height_mm,
                foil.measurand.radius_mm - (circle->centre_to_centre_mm - circle->radius_mm),
                1e-12);
  }
  assert_near(foil.measurand.form_error_um, 0, 1e-6);
  assert_near(foil.measurand.radius_mm, foil.overall_radius_mm, 1e-9);
  fg_render_free(spec);
}

/* The scanner deforms the picture, not the part. */
static void scanner_leaves_the_measurand_ideal(void **state) {
  (void)state;
  fg_render_spec *spec;
  fg_render_foil foil =
      load_truth("{\"schema\":\"foilgauge/render/1\",\"effects\":[{\"id\":\"scan.scale_y\","
                 "\"value\":0.001},{\"id\":\"free.edge.normal\",\"knots\":[[0,0],[120,5],[240,"
                 "-5]]}]}",
                 &spec);
  assert_near(foil.measurand.radius_mm, foil.overall_radius_mm, 0);
  assert_near(foil.measurand.form_error_um, 0, 0);
  for (size_t b = 0; b < foil.bump_count; b++) {
    assert_near(foil.bumps[b].measurand.radius_mm, foil.bumps[b].radius_mm, 0);
    assert_near(foil.bumps[b].measurand.height_mm, foil.bumps[b].height_mm, 0);
    assert_near(foil.bumps[b].measurand.form_error_um, 0, 0);
  }
  fg_render_free(spec);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(part_effects_move_the_crown),
      cmocka_unit_test(normal_ovality_moves_at_right_angles),
      cmocka_unit_test(spiral_lies_beside_the_plain_foil),
      cmocka_unit_test(lip_decay_widens_the_first_bumps),
      cmocka_unit_test(ovality_of_a_ring_deviates_by_twice_its_amplitude),
      cmocka_unit_test(crown_moves_the_measurand_of_bumps),
      cmocka_unit_test(scanner_leaves_the_measurand_ideal),
  };
  return cmocka_run_group_tests_name("render part", tests, NULL, NULL);
}

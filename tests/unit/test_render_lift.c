/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bumps that are raised by their number: the middle alone, or the whole bump. */
#include "render_picture.h"
#include "support/test.h"

#define FOIL(effect)                                                                               \
  "{\"schema\":\"foilgauge/render/1\",\"seed\":3,\"foils\":[{\"centre_mm\":[20,30],"               \
  "\"radius_springback\":{\"mean\":0.02,\"sd\":0.01}}],\"effects\":[" effect                       \
  "],\"scanner\":{" EXACT "}}"
#define LIFT(members) FOIL("{\"id\":\"free.bump.index\"," members "}")

static fg_render_spec *parse(const char *json) {
  fg_context ctx = {0};
  fg_render_spec *spec = NULL;
  if (fg_render_parse(&ctx, "spec.json", json, &spec) != FG_OK) fail_msg("%s", ctx.message);
  return spec;
}

/* The greatest distance from the plain midline near each bump's axis, and away from O. */
static void raised_um(const char *json, double um[9]) {
  fg_context ctx = {0};
  fg_render_spec *plain = parse(FOIL("")), *spec = parse(json);
  const fg_render_foil *foil = &fg_render_get_truth(plain)->foils[0];
  double best[9];
  for (int i = 0; i < 9; i++)
    best[i] = INFINITY;
  fg_point p, q;
  for (double s = 3; fg_render_midline(&ctx, plain, 0, s, &p) == FG_OK; s += 0.002)
    for (int i = 0; i < 9; i++) {
      const fg_render_bump *bump = &foil->bumps[i];
      double ax = foil->overall_centre_px.x - bump->centre_px.x;
      double ay = foil->overall_centre_px.y - bump->centre_px.y, length = hypot(ax, ay);
      double dx = p.x - bump->centre_px.x, dy = p.y - bump->centre_px.y;
      double off = fabs(ax * dy - ay * dx) / length;
      if (off > best[i] || hypot(dx, dy) > 1.01 * bump->radius_mm / pixel) continue;
      best[i] = off;
      fg_render_midline(&ctx, spec, 0, s, &q);
      um[i] = ((q.x - p.x) * ax + (q.y - p.y) * ay) / length * pixel * 1e3;
    }
  fg_render_free(plain);
  fg_render_free(spec);
}

static void patterns_raise_the_bumps_they_name(void **state) {
  (void)state;
  static const struct {
    const char *json;
    double um[9];
  } cases[] = {
      {LIFT("\"amplitude_um\":4,\"bumps\":[2,9]"), {0, 4, 0, 0, 0, 0, 0, 0, 4}},
      {LIFT("\"amplitude_um\":4,\"every\":3"), {0, 0, 4, 0, 0, 4, 0, 0, 4}},
      {LIFT("\"amplitude_um\":-3,\"every\":4,\"first\":1"), {-3, 0, 0, 0, -3, 0, 0, 0, -3}},
      {LIFT("\"amplitude_um\":4,\"period_bumps\":4"), {4, 0, -4, 0, 4, 0, -4, 0, 4}},
      {LIFT("\"amplitude_um\":4,\"period_bumps\":2,\"phase_deg\":90"),
       {-4, 4, -4, 4, -4, 4, -4, 4, -4}},
      {LIFT("\"values_um\":[1,2,3,-4]"), {1, 2, 3, -4, 0, 0, 0, 0, 0}},
  };
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    in_row("cases[%zu]", c);
    double um[9];
    raised_um(cases[c].json, um);
    for (int i = 0; i < 9; i++)
      assert_near(um[i], cases[c].um[i], 0.002);
  }
}

/* Off the middle it falls as (1 - u²)²; fillets, lands and the ideal circles stay. */
static void crown_stays_at_its_ends(void **state) {
  (void)state;
  fg_context ctx = {0};
  fg_render_spec *plain = parse(FOIL(""));
  fg_render_spec *spec = parse(LIFT("\"amplitude_um\":6,\"bumps\":[5]"));
  const fg_render_foil *a = &fg_render_get_truth(plain)->foils[0];
  const fg_render_foil *b = &fg_render_get_truth(spec)->foils[0];
  for (size_t i = 0; i < 9; i++)
    assert_memory_equal(&a->bumps[i], &b->bumps[i], offsetof(fg_render_bump, measurand));
  double first = NAN, last = NAN, middle = 0, largest = 0;
  fg_point p, q;
  for (int pass = 0; pass < 2; pass++)
    for (double s = 0; fg_render_midline(&ctx, plain, 0, s, &p) == FG_OK; s += 0.005) {
      fg_render_midline(&ctx, spec, 0, s, &q);
      double um = hypot(q.x - p.x, q.y - p.y) * pixel * 1e3;
      if (pass == 0 && um > 1e-9) {
        if (isnan(first)) first = s;
        last = s;
        largest = fmax(largest, um);
      }
      if (pass == 1 && um > 1e-9) {
        double u = 2 * (s - middle) / (last - first);
        assert_near(um, 6 * (1 - u * u) * (1 - u * u), 0.03);
      }
      middle = 0.5 * (first + last);
    }
  assert_near(largest, 6, 0.001);
  assert_near(last - first, 3.45, 0.1); /* one bump's arc between its fillets */
  fg_render_free(plain);
  fg_render_free(spec);
}

/* The circle keeps its radius and comes nearer to O; the truth is that of the raised bump, and the
 * midline is the strip's whole way one piece. */
static void whole_bump_moves_with_its_flanks(void **state) {
  (void)state;
  fg_context ctx = {0};
  fg_render_spec *plain = parse(FOIL(""));
  fg_render_spec *spec = parse(LIFT("\"amplitude_um\":5,\"bumps\":[4],\"form\":\"whole\""));
  const fg_render_foil *before = &fg_render_get_truth(plain)->foils[0];
  const fg_render_foil *after = &fg_render_get_truth(spec)->foils[0];
  for (int i = 0; i < 9; i++) {
    const fg_render_bump *a = &before->bumps[i], *b = &after->bumps[i];
    double by = i == 3 ? 5e-3 : 0, overall = after->overall_radius_mm;
    assert_near(b->radius_mm, a->radius_mm, 0);
    assert_near(b->centre_to_centre_mm, a->centre_to_centre_mm - by, 1e-12);
    assert_near(b->height_mm, a->height_mm + by, 1e-12);
    double half = 0.5 * b->bump_angle_deg * 3.14159265358979323846 / 180;
    double crossing = b->centre_to_centre_mm - b->radius_mm * cos(half);
    assert_near(hypot(crossing, b->radius_mm * sin(half)), overall, 1e-9);
  }
  fg_point p, last = {0, 0};
  for (double s = 0; fg_render_midline(&ctx, spec, 0, s, &p) == FG_OK; s += 0.002) {
    if (s > 0) assert_near(hypot(p.x - last.x, p.y - last.y) * pixel, 0.002, 2e-7);
    last = p;
  }
  fg_render_free(plain);
  fg_render_free(spec);
}

/* The picture agrees with the midline: the crown of an upright foil's middle bump. */
static void picture_shows_the_raised_crown(void **state) {
  (void)state;
  const char *extents[] = {"crown", "whole"};
  for (int i = 0; i < 2; i++) {
    picture p = draw_format("{\"schema\":\"foilgauge/render/1\",\"effects\":[{\"id\":"
                            "\"free.bump.index\",\"amplitude_um\":7,\"bumps\":[5],\"form\":\"%s\"}"
                            "],\"scanner\":{" EXACT "}}",
                            extents[i]);
    double thickness, moved = crown(&p, 4, &thickness) * pixel * 1e3;
    assert_near(moved, i ? 0 : 7, 0.03); /* the whole bump's truth is where it is */
    drop(&p);
  }
}

static void truth_names_the_raised_bumps(void **state) {
  (void)state;
  fg_context ctx = {0};
  char *json = NULL;
  fg_render_spec *spec = parse(LIFT("\"amplitude_um\":4,\"every\":3,\"form\":\"whole\""));
  assert_ok(&ctx, fg_render_truth_json(&ctx, spec, &json));
  assert_has(json, "\"id\": \"free.bump.index\"");
  assert_has(json, "\"form\": \"whole\"");
  assert_has(json, "\"values_um\": [0, 0, 4, 0, 0, 4, 0, 0, 4]");
  free(json);
  fg_render_free(spec);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(patterns_raise_the_bumps_they_name),
      cmocka_unit_test(crown_stays_at_its_ends),
      cmocka_unit_test(whole_bump_moves_with_its_flanks),
      cmocka_unit_test(picture_shows_the_raised_crown),
      cmocka_unit_test(truth_names_the_raised_bumps),
  };
  return cmocka_run_group_tests_name("render lift", tests, NULL, NULL);
}

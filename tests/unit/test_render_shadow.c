/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A shadow by direction: beside the edges whose normal lies in its sector, and only there. */
#include "render_picture.h"
#include "support/test.h"

static const double pi = 3.14159265358979323846;

/* In the middle of 500 × 500 px, of 95 px radius; `shape` adds a hole. */
static picture draw_disc(const char *shape, double background, double contrast,
                         const char *scanner) {
  return draw_format("{\"schema\":\"foilgauge/render/1\",\"width_px\":500,\"height_px\":500,"
                     "\"discs\":[%s],\"scanner\":{\"bits\":16,\"background\":%g,\"contrast\":%g,"
                     "\"noise\":0,%s}}",
                     shape, background, contrast, scanner);
}

#define DISC "{\"centre_mm\":[1.322916667,1.322916667],\"radius_mm\":0.502708333}"
#define HOLE                                                                                       \
  "{\"centre_mm\":[1.322916667,1.322916667],\"radius_mm\":1.2},{\"centre_mm\":[1.322916667,"       \
  "1.322916667],\"radius_mm\":0.502708333,\"hole\":true}"

/* Linear between pixels. */
static double value_at(const picture *p, double x, double y) {
  int64_t i = (int64_t)x, j = (int64_t)y;
  double u = x - (double)i, v = y - (double)j;
  const double *dn = p->dn + j * p->width + i;
  return (1 - v) * ((1 - u) * dn[0] + u * dn[1]) +
         v * ((1 - u) * dn[p->width] + u * dn[p->width + 1]);
}

/* At `distance` px outside the disc's edge (negative: inside), where it faces `degrees`. */
static double beside(const picture *p, double degrees, double distance) {
  double turn = degrees * pi / 180, r = 95 + distance;
  return value_at(p, 250 + r * cos(turn), 250 + r * sin(turn));
}

/* 1 at the direction, a half at half the width, nothing from the width on. */
static double expected_share(double degrees, double direction, double width) {
  double turn = fabs(remainder(degrees - direction, 360));
  return turn < width ? 0.5 * (1 + cos(pi * turn / width)) : 0;
}

static void shadow_is_within_its_sector(void **state) {
  (void)state;
  const double directions[] = {0, 40, -115}, widths[] = {90, 30, 180};
  for (int i = 0; i < 3; i++) {
    char members[160];
    snprintf(members, sizeof members,
             "\"shadow\":{\"amplitude\":-0.3,\"direction_deg\":%g,\"width_deg\":%g,"
             "\"length_px\":20}",
             directions[i], widths[i]);
    picture p = draw_disc(DISC, 100, 100, members);
    for (double degrees = 0; degrees < 360; degrees += 5)
      for (double distance = 8; distance < 60; distance += 13) {
        double share = expected_share(degrees, directions[i], widths[i]);
        assert_near(beside(&p, degrees, distance), 100 - 30 * share * exp(-distance / 20), 0.15);
      }
    for (double degrees = 0; degrees < 360; degrees += 5)
      assert_near(beside(&p, degrees, -8), 200, 0.01);
    drop(&p);
  }
}

/* Light or dark, whatever is brighter, the thing or what lies behind it. */
static void amplitude_is_light(void **state) {
  (void)state;
  for (int dark = 0; dark < 2; dark++)
    for (int sign = -1; sign < 2; sign += 2) {
      char members[128];
      snprintf(members, sizeof members, "\"shadow\":{\"amplitude\":%g,\"length_px\":20}",
               0.2 * sign);
      picture p = draw_disc(DISC, 120, dark ? -100 : 100, members);
      assert_near(beside(&p, 0, 10), 120 + sign * 20 * exp(-0.5), 0.1);
      assert_near(beside(&p, 180, 10), 120, 0.01);
      drop(&p);
    }
}

static void a_gap_keeps_a_shadow_from_the_edge(void **state) {
  (void)state;
  picture p =
      draw_disc(DISC, 100, 100, "\"shadow\":{\"amplitude\":-0.4,\"length_px\":15,\"gap_px\":16}");
  assert_near(beside(&p, 0, 22), 100 - 40 * exp(-0.4), 0.3);
  assert_near(beside(&p, 0, 8), 100 - 40 * exp(-0.5), 0.5);
  assert_near(beside(&p, 0, 31), 100 - 40 * exp(-1), 0.3);
  drop(&p);
}

/* The edge of a hole faces its middle: a shadow of direction 0 lies at its left side, within. */
static void hole_faces_its_middle(void **state) {
  (void)state;
  picture p = draw_disc(HOLE, 100, 100, "\"shadow\":{\"amplitude\":-0.3,\"length_px\":20}");
  assert_near(beside(&p, 180, -10), 100 - 30 * exp(-0.5), 0.1);
  assert_near(beside(&p, 0, -10), 100, 0.01);
  assert_near(beside(&p, 180, 10), 200, 0.01);
  drop(&p);
}

/* Beside a strip's crown, on the side that faces down, and beside a wall that looks up. */
static void strips_have_it_beside_their_wall(void **state) {
  (void)state;
  picture p = draw(0, "{\"schema\":\"foilgauge/render/1\",\"foils\":[{\"lip\":null,"
                      "\"design\":{\"bump_count\":1}}],\"scanner\":{" EXACT
                      ",\"shadow\":{\"amplitude\":0.25,\"direction_deg\":90,\"length_px\":10},"
                      "\"rough\":{\"side_wall\":{\"amplitude\":0.3,\"direction_deg\":-90,"
                      "\"length_px\":10}}}}");
  const fg_render_bump *bump = &p.truth->foils[0].bumps[0];
  int64_t x = llround(bump->centre_px.x);
  double y = bump->centre_px.y + bump->radius_mm / pixel, half = 0.05 / pixel;
  double inside = value_at(&p, (double)x, y + half + 10);
  double outside = value_at(&p, (double)x, y - half - 10);
  assert_near((inside - 20) / 200, 0.25 * exp(-1), 0.003);
  assert_near((outside - 20) / 200, 0.3 * exp(-1), 0.003);
  drop(&p);
}

static void strips_of_any_height_give_one_picture(void **state) {
  (void)state;
  const char *json = "{\"schema\":\"foilgauge/render/1\",\"foils\":[{\"rotate_deg\":20,"
                     "\"design\":{\"bump_count\":2}}],\"discs\":[{\"centre_mm\":[2,2],"
                     "\"radius_mm\":1}],\"scanner\":{\"dpi\":1200,\"shadow\":{\"amplitude\":-0.1,"
                     "\"direction_deg\":70,\"length_px\":60,\"gap_px\":5}}}";
  picture first = draw(64, json), other = draw(100000, json);
  assert_memory_equal(first.dn, other.dn, (size_t)(first.width * first.height) * sizeof *first.dn);
  drop(&first);
  drop(&other);
}

static void truth_records_the_shadow(void **state) {
  (void)state;
  fg_context ctx = {0};
  char *json = NULL;
  picture p = draw_disc(DISC, 100, 100, "\"shadow\":{\"amplitude\":-0.4,\"direction_deg\":30}");
  assert_ok(&ctx, fg_render_truth_json(&ctx, p.spec, &json));
  const char *words[] = {"\"shadow\": {", "\"amplitude\": -0.4", "\"direction_deg\": 30",
                         "\"width_deg\": 90", "\"length_px\": 15"};
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    if (!strstr(json, words[i])) fail_msg("no %s in %s", words[i], json);
  free(json);
  drop(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(shadow_is_within_its_sector),
      cmocka_unit_test(amplitude_is_light),
      cmocka_unit_test(a_gap_keeps_a_shadow_from_the_edge),
      cmocka_unit_test(hole_faces_its_middle),
      cmocka_unit_test(strips_have_it_beside_their_wall),
      cmocka_unit_test(strips_of_any_height_give_one_picture),
      cmocka_unit_test(truth_records_the_shadow),
  };
  return cmocka_run_group_tests_name("render shadow", tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whole foils of every shape through the measuring chain: which bump is which, flags, and every
 * radius within its uncertainty of the truth. */
#include "support/brief.h"
#include "support/measured_render.h"
#include "support/test.h"

/* A single value of many may lie this many standard uncertainties off: 1 in 150,000. */
static const double many_u = 4.5;

/* The true bump whose centre is next to that of a measured one. */
static const fg_render_bump *true_bump(const measured *m, const fg_render_foil *truth,
                                       const fg_bump *bump) {
  const fg_render_bump *best = NULL;
  double min = 1.0;
  for (size_t i = 0; i < truth->bump_count; i++) {
    const fg_render_bump *t = &truth->bumps[i];
    double d = hypot(t->centre_px.x * 25.4 / m->result.dpi[0] - bump->centre_mm.x,
                     t->centre_px.y * 25.4 / m->result.dpi[1] - bump->centre_mm.y);
    if (d < min) {
      min = d;
      best = t;
    }
  }
  return best;
}

static void check_within(const char *name, double value, double truth, double u) {
  if (!(fabs(value - truth) <= many_u * u) || !(u > 0))
    fail_msg("%s is %.7g, not %.7g: off by %.3g, u %.3g", name, value, truth, value - truth, u);
}

/* Bumps against the truth; `shift`: number - index. With `reversed`, n + 1 - index. */
static void check_bumps(const measured *m, size_t foil, bool reversed, int shift) {
  const fg_foil *f = &m->result.foils[foil];
  const fg_render_foil *t = &m->picture.truth->foils[foil];
  check_within("R0", f->overall.radius_mm, t->overall_radius_mm, f->overall.u_radius_mm);
  for (size_t i = 0; i < f->bump_count; i++) {
    const fg_bump *b = &f->bumps[i];
    const fg_render_bump *truth = true_bump(m, t, b);
    if (!truth) fail_msg("bump %d is not there", b->number);
    int index = reversed ? (int)t->bump_count + 1 - truth->index : truth->index;
    assert_int_equal(b->number, index + shift);
    check_within("R", b->radius_mm, truth->radius_mm, b->u_radius_mm);
    check_within("h", b->height_mm, truth->height_mm, b->u_height_mm);
    check_within("alpha", b->bump_angle_deg, truth->bump_angle_deg, b->u_bump_angle_deg);
    check_within("theta", b->intersection_angle_deg, truth->intersection_angle_deg,
                 b->u_intersection_angle_deg);
    assert_int_equal(!!(b->flags & FG_BUMP_CRUSHED), truth->crushed);
  }
}

/* Renders and measures one foil; checks its bumps and that it has these flags. */
static measured check_foil(int bumps, const char *members, const char *scanner, unsigned flags) {
  char json[4096];
  fg_design design;
  fg_design_default(&design);
  design.bumps.count = (size_t)bumps;
  small_foil(json, sizeof json, bumps, members, "%s", scanner);
  measured m = measure_render(json, &design);
  assert_ok(NULL, m.status);
  assert_int_equal(m.result.foil_count, 1);
  assert_string_equal(m.result.foils[0].error, "");
  assert_int_equal(m.result.foils[0].flags & ~(unsigned)FG_FOIL_ROUGH_EDGE, flags);
  assert_int_equal(m.result.foils[0].bump_count, m.picture.truth->foils[0].bump_count);
  return m;
}

static void any_number_of_bumps(void **state) {
  (void)state;
  const int counts[] = {1, 2, 3, 5, 12};
  for (size_t i = 0; i < 5; i++) {
    measured m =
        check_foil(counts[i], "", "\"blur_px\":1.2", counts[i] == 1 ? FG_FOIL_FEW_LANDS : 0);
    check_bumps(&m, 0, false, 0);
    assert_near(m.result.foils[0].thickness.mm, 0.1, 0.0001);
    measured_free(&m);
  }
}

/* Every 15 degrees, both hands: the numbers start at the lip, the hand and direction are found. */
static void any_rotation_and_either_hand(void **state) {
  (void)state;
  for (int i = 0; i < 24; i += (int)test_step(11)) {
    char members[100];
    bool mirror = i / 2 % 2;
    snprintf(members, sizeof members, ",\"rotate_deg\":%d,\"mirror\":%s", 15 * i,
             mirror ? "true" : "false");
    measured m = check_foil(3, members, "\"dpi\":2400", 0);
    const fg_foil *f = &m.result.foils[0];
    check_bumps(&m, 0, false, 0);
    assert_int_equal(f->orientation, mirror ? FG_COUNTERCLOCKWISE : FG_CLOCKWISE);
    assert_near(remainder(f->rotation_deg - 15 * i, 360), 0, 0.01);
    measured_free(&m);
  }
}

static void lips_of_every_kind(void **state) {
  (void)state;
  const char *lips[] = {"{\"side\":\"inwards\"}", "{\"length_mm\":0.3}", "{\"bend_radius_mm\":0.2}",
                        "{\"bend_radius_mm\":0.8}", "{\"length_mm\":4}"};
  for (size_t i = 0; i < 5; i += test_step(2))
    for (int mirror = 0; mirror < 2; mirror++) {
      char members[200];
      snprintf(members, sizeof members, ",\"lip\":%s,\"mirror\":%s", lips[i],
               mirror ? "true" : "false");
      measured m = check_foil(3, members, "\"dpi\":2400", 0);
      check_bumps(&m, 0, false, 0);
      measured_free(&m);
    }
}

/* Without a lip numbers go clockwise, and the flag says so. */
static void a_missing_lip_is_flagged(void **state) {
  (void)state;
  for (int mirror = 0; mirror < 2; mirror++) {
    char members[100];
    snprintf(members, sizeof members, ",\"lip\":null,\"mirror\":%s", mirror ? "true" : "false");
    measured m = check_foil(4, members, "\"dpi\":2400", FG_FOIL_NO_LIP);
    check_bumps(&m, 0, mirror == 1, 0);
    assert_int_equal(m.result.foils[0].orientation, FG_CLOCKWISE);
    measured_free(&m);
  }
}

static void sinusoidal_foil(void **state) {
  (void)state;
  measured m = check_foil(5, ",\"lip\":null,\"first_land_mm\":0.2,\"last_land_mm\":0.2",
                          "\"blur_px\":1.2", FG_FOIL_NO_LIP);
  check_bumps(&m, 0, false, 0);
  measured_free(&m);
}

static void missing_bumps_leave_their_numbers_out(void **state) {
  (void)state;
  static const char *cases[] = {"[3]", "[2,3]", "[5]", "[1]", "[1,5]", "[1,2,4]", "[2,3,4]"};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i += test_step(3)) {
    char members[100];
    snprintf(members, sizeof members, ",\"missing\":%s", cases[i]);
    measured m = check_foil(5, members, "\"dpi\":2400", FG_FOIL_BUMP_COUNT | FG_FOIL_MISSING_BUMP);
    check_bumps(&m, 0, false, 0);
    measured_free(&m);
  }
}

/* A crushed bump is flagged; it and the others are measured, however few there are. */
static void crushed_bumps_are_flagged(void **state) {
  (void)state;
  for (int bumps = 3; bumps <= 5; bumps += 2)
    for (int crushed = 1; crushed <= bumps; crushed += (int)test_step(4)) {
      char members[100];
      snprintf(members, sizeof members, ",\"crushed\":[{\"bump\":%d,\"height_factor\":0.5}]",
               crushed);
      measured m = check_foil(bumps, members, "\"dpi\":2400", 0);
      check_bumps(&m, 0, false, 0);
      measured_free(&m);
    }
}

static void thick_and_thin_strips(void **state) {
  (void)state;
  const double thicknesses[] = {0.05, 0.15, 0.2};
  for (size_t i = 0; i < 3; i++) {
    char json[4096], members[200];
    fg_design design;
    fg_design_default(&design);
    design.thickness_mm = thicknesses[i];
    snprintf(members, sizeof members, ",\"rotate_deg\":33");
    small_foil(json, sizeof json, 3, members, "\"blur_px\":1.5");
    char *at = strstr(json, "\"bump_count\":3"), tail[2048];
    snprintf(tail, sizeof tail, "%s", at);
    snprintf(at, sizeof json - (size_t)(at - json), "\"thickness_mm\":%g,%s", thicknesses[i], tail);
    measured m = measure_render(json, &design);
    assert_ok(NULL, m.status);
    check_bumps(&m, 0, false, 0);
    assert_near(m.result.foils[0].thickness.mm, thicknesses[i], 0.0001);
    measured_free(&m);
  }
}

/* Two foils in a scan, one of them mirrored and turned: each is itself. */
static void two_foils_in_one_scan(void **state) {
  (void)state;
  measured m = measure_render(
      "{\"schema\":\"foilgauge/render/1\",\"seed\":5,\"scanner\":{\"dpi\":2400},\"foils\":["
      "{\"design\":{\"bump_count\":3},\"radius_springback\":{\"mean\":0.02,\"sd\":0.01}},"
      "{\"design\":{\"bump_count\":3},\"rotate_deg\":70,\"mirror\":true,"
      "\"radius_springback\":{\"mean\":0.03,\"sd\":0.01}}]}",
      NULL);
  assert_ok(NULL, m.status);
  assert_int_equal(m.result.foil_count, 2);
  for (size_t i = 0; i < 2; i++) {
    assert_int_equal(m.result.foils[i].flags, FG_FOIL_BUMP_COUNT);
    assert_int_equal(m.result.foils[i].number, (int)i + 1);
    check_bumps(&m, i, false, 0);
  }
  assert_int_equal(m.result.foils[0].orientation, FG_CLOCKWISE);
  assert_int_equal(m.result.foils[1].orientation, FG_COUNTERCLOCKWISE);
  measured_free(&m);
}

/* Cut by the scan's border: flagged, and the bumps that are there are measured. */
static void cut_by_the_border(void **state) {
  (void)state;
  static const struct {
    const char *centre;
    size_t bumps;
  } cases[] = {{"[6,24]", 3}, {"[0,23]", 2}, {"[10,23]", 4}};
  for (size_t i = 0; i < 3; i++) {
    char json[1024];
    snprintf(json, sizeof json,
             "{\"schema\":\"foilgauge/render/1\",\"seed\":4,\"width_px\":2100,\"height_px\":600,"
             "\"scanner\":{\"dpi\":2400},\"foils\":[{\"design\":{\"bump_count\":4},"
             "\"overall_radius_mm\":20.95,\"centre_mm\":%s}]}",
             cases[i].centre);
    measured m = measure_render(json, NULL);
    assert_ok(NULL, m.status);
    assert_int_equal(m.result.foil_count, 1);
    assert_true(m.result.foils[0].flags & FG_FOIL_TOUCHES_BORDER);
    assert_int_equal(m.result.foils[0].bump_count, cases[i].bumps);
    check_bumps(&m, 0, false, (int)cases[i].bumps - 4);
    measured_free(&m);
  }
}

/* Foils that touch or cross are said to; which bump is whose cannot be trusted then. */
static void touching_foils_are_flagged(void **state) {
  (void)state;
  const double across_mm[] = {16.5, 16, 15.5, 15};
  for (size_t i = 0; i < 4; i++) {
    char json[1024];
    snprintf(json, sizeof json,
             "{\"schema\":\"foilgauge/render/1\",\"seed\":1,\"width_px\":3700,\"height_px\":700,"
             "\"scanner\":{\"dpi\":2400},\"foils\":[{\"design\":{\"bump_count\":4},\"centre_mm\":"
             "[14,24]},{\"design\":{\"bump_count\":4},\"centre_mm\":[%g,24]}]}",
             14 + across_mm[i]);
    measured m = measure_render(json, NULL);
    assert_ok(NULL, m.status);
    assert_true(m.result.foil_count > 0);
    for (size_t j = 0; j < m.result.foil_count; j++)
      if (!(m.result.foils[j].flags & (FG_FOIL_TOUCHES_OTHER | FG_FOIL_NOT_MEASURED)))
        fail_msg("%g mm: foil %zu is not flagged", across_mm[i], j + 1);
    measured_free(&m);
  }
}

static measured measure_coarse(int dpi, const char *members) {
  char json[4096];
  small_foil(json, sizeof json, 9, members, "\"dpi\":%d,\"blur_px\":1,\"noise\":0.3", dpi);
  measured m = measure_render(json, NULL);
  assert_ok(NULL, m.status);
  assert_int_equal(m.result.foils[0].bump_count, 9);
  return m;
}

/* A line that is smoothed over a fillet's length bends the scale across; it did so below 1000 dpi.
 */
static void coarse_scans_are_not_biased(void **state) {
  (void)state;
  const int dpi[] = {600, 700, 800};
  for (size_t i = 0; i < 3; i += test_step(2)) {
    double sum = 0, count = 0;
    for (int turn = 0; turn < 3; turn++) {
      char members[100];
      snprintf(members, sizeof members, ",\"rotate_deg\":%d", 17 + 41 * turn);
      measured m = measure_coarse(dpi[i], members);
      const fg_foil *f = &m.result.foils[0];
      for (size_t b = 0; b < f->bump_count; b++) {
        sum +=
            f->bumps[b].radius_mm - true_bump(&m, m.picture.truth->foils, &f->bumps[b])->radius_mm;
        count++;
      }
      measured_free(&m);
    }
    assert_near(1000 * sum / count, 0, 0.4);
  }
}

/* A scan whose edges blur into each other is called too coarse. */
static void a_coarse_scan_is_flagged(void **state) {
  (void)state;
  static const struct {
    int dpi;
    double blur_px;
    bool coarse;
  } cases[] = {{600, 1.5, true}, {600, 0.9, false}, {1200, 1.5, false}};
  for (size_t i = 0; i < 3; i++) {
    char json[4096];
    small_foil(json, sizeof json, 3, "", "\"dpi\":%d,\"blur_px\":%g", cases[i].dpi,
               cases[i].blur_px);
    measured m = measure_render(json, NULL);
    assert_int_equal(!!(m.result.foils[0].flags & FG_FOIL_COARSE_RESOLUTION), cases[i].coarse);
    measured_free(&m);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(any_number_of_bumps),
      cmocka_unit_test(any_rotation_and_either_hand),
      cmocka_unit_test(lips_of_every_kind),
      cmocka_unit_test(a_missing_lip_is_flagged),
      cmocka_unit_test(sinusoidal_foil),
      cmocka_unit_test(missing_bumps_leave_their_numbers_out),
      cmocka_unit_test(crushed_bumps_are_flagged),
      cmocka_unit_test(thick_and_thin_strips),
      cmocka_unit_test(two_foils_in_one_scan),
      cmocka_unit_test(cut_by_the_border),
      cmocka_unit_test(touching_foils_are_flagged),
      cmocka_unit_test(coarse_scans_are_not_biased),
      cmocka_unit_test(a_coarse_scan_is_flagged),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The models of a bump's stiffness against numerics of their own: a beam's strain energy, a linkage
 * that moves, a spring from an arc's energy; at their limits; and by the law that all of them
 * share. (The arch itself: test_arch.c.) */
#include <math.h>
#include <string.h>

#include "foilgauge/stiffness.h"
#include "support/test.h"

static const double pi = 3.14159265358979323846;
static const fg_arch gen2 = {3.32, 63.15, 0.1};

enum { ARCH, HESHMAT, LINKS, STEPS = 4000 };

static double stiffness_of(int model, fg_arch arch, double friction) {
  fg_context ctx;
  double stiffness;
  const fg_arch_material material = {200, 0.3, friction};
  assert_ok(NULL, fg_stiffness_models()[model].stiffness(&ctx, &arch, &material, &stiffness));
  return stiffness;
}

static double bending(fg_arch arch) {
  return 200e3 * pow(arch.thickness_mm, 3) / (12 * 0.91);
}

static double simpson(double from, double to, double (*square)(double, double), double parameter) {
  double sum = 0;
  for (int i = 0; i <= STEPS; i++) {
    double value = square(from + (to - from) * i / STEPS, parameter);
    sum += value * (i == 0 || i == STEPS ? 1 : i % 2 ? 4 : 2);
  }
  return sum * (to - from) / STEPS / 3;
}

/* Moment of half the load at a support, squared. */
static double beam_moment(double x, double unused) {
  (void)unused;
  return x * x / 4;
}

/* Energy of both halves under W = 1 is delta / 2. */
static void heshmat_is_a_beam_on_its_chord(void **state) {
  (void)state;
  const fg_arch arches[] = {gen2, {4.1, 50, 0.1}, {2.5, 120, 0.15}};
  for (size_t i = 0; i < sizeof arches / sizeof *arches; i++) {
    in_row("arches[%zu]", i);
    double half = arches[i].radius_mm * sin(arches[i].bump_angle_deg * pi / 360);
    double sink = 2 * simpson(0, half, beam_moment, 0) / bending(arches[i]);
    assert_near(stiffness_of(HESHMAT, arches[i], 0.1) * sink, 1, 1e-12);
  }
  /* As it is printed, and per area: 5.0 mm of pitch. */
  double t = 0.1, l0 = 3.32 * sin(63.15 * pi / 360);
  double compliance = 2 * 5.0 / 200e3 * pow(l0 / t, 3) * (1 - 0.09);
  assert_near(stiffness_of(HESHMAT, gen2, 0) / 5.0 * compliance, 1, 1e-12);
}

static double foot_moment(double psi, double phi) {
  return pow(cos(psi) - cos(phi), 2);
}

/* The linkage itself: the crown is pushed down by `sink`, the links stay as long, and virtual work
 * gives the load: W dsink = 2 (k u + mu W / 2) du. */
static double linkage(fg_arch arch, double friction, double sink) {
  double phi = arch.bump_angle_deg * pi / 360, r = arch.radius_mm;
  double spring = bending(arch) / (pow(r, 3) * simpson(0, phi, foot_moment, phi));
  double half = r * sin(phi), rise = r * (1 - cos(phi)), link = hypot(half, rise);
  double low = rise - sink, reach = sqrt(link * link - low * low);
  double slope = low / reach, spread = reach - half;
  return 2 * spring * spread * slope / (1 - friction * slope) / sink;
}

static void link_spring_is_the_linkage(void **state) {
  (void)state;
  const fg_arch arches[] = {gen2, {4.1, 50, 0.1}, {2.5, 120, 0.15}, {6, 4, 0.076}, {3, 175, 0.1}};
  for (size_t i = 0; i < sizeof arches / sizeof *arches; i++)
    for (double friction = 0; friction < 0.35; friction += 0.1) {
      double sink = 1e-6 * arches[i].radius_mm * (1 - cos(arches[i].bump_angle_deg * pi / 360));
      assert_near(stiffness_of(LINKS, arches[i], friction) / linkage(arches[i], friction, sink), 1,
                  1e-5);
    }
}

/* A flat bump without friction is a beam; the links keep 5/8 of it. The flattest of these arches
 * would be noise by closed forms. */
static void flat_bumps_are_beams(void **state) {
  (void)state;
  const double angles[] = {1, 0.1, 0.001};
  for (size_t i = 0; i < sizeof angles / sizeof *angles; i++) {
    in_row("angles[%zu]", i);
    const fg_arch flat = {1e6, angles[i], 1e-9};
    double beam = stiffness_of(HESHMAT, flat, 0);
    assert_near(stiffness_of(ARCH, flat, 0) / beam, 1, 1e-4);
    assert_near(stiffness_of(LINKS, flat, 0) / beam, 0.625, 1e-4);
  }
  /* Both sides of where the links' closed form gives way to its series. */
  double below = stiffness_of(LINKS, (fg_arch){3, 0.09999 * 180 / pi, 0.01}, 0);
  double above = stiffness_of(LINKS, (fg_arch){3, 0.10001 * 180 / pi, 0.01}, 0);
  assert_near(below / above, pow(0.10001 / 0.09999, 3), 1e-6);
}

/* The steeper the bump, the more of it is height that the straight beam does not have. */
static void heshmat_leaves_the_arch_as_it_rises(void **state) {
  (void)state;
  double last = 0;
  for (double angle = 10; angle < 180; angle += 20) {
    const fg_arch arch = {3.32, angle, 0.01};
    double more = stiffness_of(HESHMAT, arch, 0) / stiffness_of(ARCH, arch, 0) - 1;
    assert_true(more > last);
    last = more;
  }
}

/* K = D / R³ g(alpha) for slender bumps: radius alone -3 in every model, thickness 3; and a
 * constant arc length leaves less than a percent per percent. */
static void slender_bending_is_one_law(void **state) {
  (void)state;
  const fg_arch slender = {3.32, 63.15, 1e-4};
  const fg_arch_material material = fg_arch_material_default();
  fg_stiffness_line lines[FG_STIFFNESS_MODELS];
  fg_stiffness_compare(&slender, &material, lines);
  for (int i = 0; i < FG_STIFFNESS_MODELS; i++) {
    assert_near(lines[i].sensitivity.radius, -3, 1e-5);
    assert_near(lines[i].sensitivity.thickness, 3, 1e-5);
    assert_near(lines[i].sensitivity.radius_at_arc_length,
                lines[i].sensitivity.radius - lines[i].sensitivity.angle, 1e-6);
    assert_true(fabs(lines[i].sensitivity.radius_at_arc_length) < 1);
    const fg_arch wider = {2 * slender.radius_mm, slender.bump_angle_deg, slender.thickness_mm};
    assert_near(stiffness_of(i, wider, 0.1) / stiffness_of(i, slender, 0.1), 0.125, 1e-7);
  }
  double phi = 63.15 * pi / 360;
  assert_near(lines[HESHMAT].sensitivity.angle, -3 * phi / tan(phi), 1e-6);
}

static void models_outside_their_range_give_a_reason(void **state) {
  (void)state;
  fg_stiffness_line lines[FG_STIFFNESS_MODELS];
  const fg_arch steep = {3.32, 170, 0.1}, none = {3.32, 180, 0.1}, stout = {0.5, 60, 0.1};
  fg_arch_material material = {200, 0.3, 1.5};
  fg_stiffness_compare(&steep, &material, lines);
  assert_true(isnan(lines[LINKS].stiffness_n_mm2) && isnan(lines[LINKS].sensitivity.radius));
  assert_has(lines[LINKS].words, "friction 1.5 holds links");
  assert_true(isfinite(lines[ARCH].stiffness_n_mm2));
  assert_has(lines[ARCH].words, "two-hinged");
  assert_has(lines[HESHMAT].words, "% softer than an arch of this angle with this friction");
  material.friction = 0.1;
  fg_stiffness_compare(&none, &material, lines);
  for (int i = 0; i < FG_STIFFNESS_MODELS; i++) {
    assert_true(isnan(lines[i].stiffness_n_mm2));
    assert_has(lines[i].words, "between 0 and 180");
  }
  fg_stiffness_compare(&stout, &material, lines);
  for (int i = 0; i < FG_STIFFNESS_MODELS; i++)
    assert_has(lines[i].words, "only 5.2 times as long as thick");
  const fg_arch flat = {20, 3, 0.01};
  material.friction = 0;
  fg_stiffness_compare(&flat, &material, lines);
  assert_string_equal(lines[ARCH].words, "");
  assert_string_equal(lines[HESHMAT].words, "");
  assert_has(lines[LINKS].words, "37.5 % softer");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(heshmat_is_a_beam_on_its_chord),
      cmocka_unit_test(link_spring_is_the_linkage),
      cmocka_unit_test(flat_bumps_are_beams),
      cmocka_unit_test(heshmat_leaves_the_arch_as_it_rises),
      cmocka_unit_test(slender_bending_is_one_law),
      cmocka_unit_test(models_outside_their_range_give_a_reason),
  };
  return cmocka_run_group_tests_name("models of stiffness", tests, NULL, NULL);
}

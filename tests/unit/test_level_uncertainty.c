/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainty of the level of the edges, and the knowledge that reduces it. */
#include <math.h>

#include "geometry/foil_uncertainty.h"
#include "geometry/level_uncertainty.h"
#include "support/test.h"

static fg_design design_of(fg_tone_statement tone) {
  fg_design design;
  fg_design_default(&design);
  design.tone = tone;
  return design;
}

/* Of 0.37 to 0.59 for an exponent that is wrong by 30 %, S curves and toes: 8 % of the contrast. */
static void an_unknown_tone_curve_is_eight_percent(void **state) {
  (void)state;
  const fg_design unknown = design_of(FG_TONE_UNKNOWN), linear = design_of(FG_TONE_LINEAR);
  fg_picture_state picture = fg_picture_unknown();
  assert_near(fg_level_uncertainty(&unknown, &picture, 0), 0.08, 0.001);
  assert_near(fg_level_uncertainty(&linear, &picture, 0), 0.003, 1e-9);
  picture.u_level = 0.06;
  assert_near(fg_level_uncertainty(&unknown, &picture, 0), 0.1, 0.001);
  assert_near(fg_level_uncertainty(&linear, &picture, 0), 0.06, 0.001);
}

/* A gauge goes through the same driver: it knows every error that is alike all over the scan, and
 * no shadow. */
static void a_gauge_removes_the_level_s_uncertainty_but_not_a_shadow_s(void **state) {
  (void)state;
  const fg_design unknown = design_of(FG_TONE_UNKNOWN);
  fg_picture_state picture = fg_picture_unknown();
  picture.level_known = true;
  picture.u_level = 0.01;
  assert_near(fg_level_uncertainty(&unknown, &picture, 0), 0.01, 1e-9);
  picture.findings = FG_PICTURE_SHARPENED | FG_PICTURE_TONE_CURVE | FG_PICTURE_FEW_LEVELS;
  assert_near(fg_level_uncertainty(&unknown, &picture, 0), 0.01, 1e-9);
  picture.findings |= FG_PICTURE_SHADOW;
  assert_near(fg_level_uncertainty(&unknown, &picture, 0), 0.25, 0.001);
}

static void no_finding_narrows_the_level_s_uncertainty(void **state) {
  (void)state;
  const fg_design linear = design_of(FG_TONE_LINEAR);
  for (unsigned bit = 1; bit <= FG_PICTURE_UNKNOWN_PROFILE; bit <<= 1) {
    fg_picture_state picture = fg_picture_unknown();
    double before = fg_level_uncertainty(&linear, &picture, 0);
    picture.findings = bit;
    assert_true(fg_level_uncertainty(&linear, &picture, 0) >= before);
  }
  fg_picture_state picture = fg_picture_unknown();
  double one = fg_level_uncertainty(&linear, &picture, FG_FOIL_CLIPPED);
  assert_near(one, 0.08, 0.001);
  assert_near(fg_level_uncertainty(&linear, &picture, FG_FOIL_CLIPPED | FG_FOIL_SIDE_BAND), one,
              1e-9);
}

/* An edge that is cut off, or of two levels, is wider than it is seen. A gauge goes through the
 * same cut. */
static void clipped_blur_adds_to_u(void **state) {
  (void)state;
  const fg_design linear = design_of(FG_TONE_LINEAR);
  fg_picture_state picture = fg_picture_unknown();
  picture.u_cut = 0.4;
  picture.seen_blur = 0.5;
  assert_near(fg_level_uncertainty(&linear, &picture, 0), 0.003, 1e-9);
  picture.findings = FG_PICTURE_CLIPPED;
  assert_near(fg_level_uncertainty(&linear, &picture, 0), hypot(0.4, 0.1), 0.001);
  picture.level_known = true;
  assert_near(fg_level_uncertainty(&linear, &picture, 0), 0.1, 0.001);
  picture = fg_picture_unknown();
  picture.findings = FG_PICTURE_FEW_LEVELS;
  picture.seen_blur = 0.25;
  assert_near(fg_level_uncertainty(&linear, &picture, 0), 4 * 0.29, 0.001);
}

/* Both edges move apart alike: twice the level times the blur times sqrt(2 pi). */
static void the_thickness_moves_by_both_edges(void **state) {
  (void)state;
  fg_design design = design_of(FG_TONE_UNKNOWN);
  fg_foil foil = {.strip = {.thickness_mm = 0.1,
                            .u_thickness_mm = 1e-4,
                            .blur_left_um = 12,
                            .blur_right_um = 14,
                            .gamma = 1,
                            .picture = fg_picture_unknown()}};
  double level = fg_level_uncertainty(&design, &foil.strip.picture, 0);
  double expected = level * sqrt(2 * M_PI) * 26 / 1000;
  fg_foil_find_thickness(&design, &foil);
  assert_near(foil.thickness.u_tone_mm, expected, 1e-12);
  assert_near(foil.thickness.u_mm, hypot(expected, 1e-4), 1e-12);
  assert_near(fg_foil_edge_u_mm(&design, &foil), expected / 2, 1e-12);
  assert_int_equal(foil.flags, 0);
  design.thickness_measured_mm = 0.098;
  design.u_thickness_measured_mm = 0.0005;
  fg_foil_find_thickness(&design, &foil);
  assert_near(foil.thickness.mm, 0.098, 0);
  assert_near(foil.thickness.u_mm, 0.0005, 0);
  assert_near(foil.thickness.scan_mm, 0.1, 0);
  assert_int_equal(foil.flags, 0);
  design.thickness_measured_mm = 0.1 - 2.1 * hypot(expected, 0.0005);
  fg_foil_find_thickness(&design, &foil);
  assert_int_equal(foil.flags, FG_FOIL_THICKNESS_CONTRADICTS);
  double off = 2.1 * hypot(expected, 0.0005); /* which of both is wrong is not known */
  assert_near(foil.thickness.u_mm, hypot(off, 0.0005), 1e-4);
  assert_true(foil.thickness.u_mm > off);
}

/* Beyond U and beyond a fifth of the design's. */
static void another_thickness_is_flagged(void **state) {
  (void)state;
  const fg_design design = design_of(FG_TONE_LINEAR);
  static const struct {
    double mm;
    unsigned flags;
  } strips[] = {{0.1, 0},
                {0.119, 0},
                {0.121, FG_FOIL_OTHER_THICKNESS},
                {0.079, FG_FOIL_OTHER_THICKNESS},
                {0.5, FG_FOIL_OTHER_THICKNESS}};
  for (size_t i = 0; i < sizeof strips / sizeof *strips; i++) {
    in_row("strips[%zu]", i);
    fg_foil foil = {.strip = {.thickness_mm = strips[i].mm,
                              .blur_left_um = 7,
                              .blur_right_um = 7,
                              .gamma = 1,
                              .picture = fg_picture_unknown()}};
    fg_foil_find_thickness(&design, &foil);
    assert_int_equal(foil.flags, strips[i].flags);
  }
}

/* The uncertainty of the level of a disc's edge is in its radius. */
static void the_radius_of_a_disc_has_the_level_s_uncertainty(void **state) {
  (void)state;
  const fg_design design = design_of(FG_TONE_UNKNOWN);
  fg_disc disc = {.blur_um = 10, .edge_u_mm = 0.001, .picture = fg_picture_unknown()};
  double level = fg_level_uncertainty(&design, &disc.picture, 0);
  fg_disc_find_level_uncertainty(&design, &disc);
  assert_near(disc.level_u_mm, hypot(0.001, level * sqrt(2 * M_PI) / 100), 1e-12);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_unknown_tone_curve_is_eight_percent),
      cmocka_unit_test(a_gauge_removes_the_level_s_uncertainty_but_not_a_shadow_s),
      cmocka_unit_test(no_finding_narrows_the_level_s_uncertainty),
      cmocka_unit_test(clipped_blur_adds_to_u),
      cmocka_unit_test(the_thickness_moves_by_both_edges),
      cmocka_unit_test(another_thickness_is_flagged),
      cmocka_unit_test(the_radius_of_a_disc_has_the_level_s_uncertainty),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

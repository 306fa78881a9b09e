/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Traces of a scanner's driver or of the light in a picture's pixels: each kind is found and
 * measured, and nothing is found on plain and on rough scans. */
#include "support/measured_render.h"
#include "support/test.h"

#define PLAIN "\"dpi\":2400,\"blur_px\":1.0,\"noise\":1.5,\"background\":30,\"contrast\":160"

static fg_picture_state state_of(const char *foil, const char *scanner) {
  char json[4096];
  small_foil(json, sizeof json, 2, foil, "%s", scanner);
  measured m = measure_render(json, NULL);
  assert_ok(NULL, m.status);
  assert_int_equal(m.result.foil_count, 1);
  fg_picture_state state = m.result.foils[0].strip.picture;
  measured_free(&m);
  return state;
}

static fg_picture_state of_scanner(const char *scanner) {
  return state_of("", scanner);
}

static void nothing_is_found_on_plain_scans(void **unused) {
  (void)unused;
  static const char *const scanners[] = {
      PLAIN,
      PLAIN ",\"bits\":16",
      "\"dpi\":2400,\"blur_px\":2.2,\"noise\":0.5,\"background\":215,\"contrast\":-160,\"gamma\":2."
      "2",
      "\"dpi\":2400,\"blur_px\":0.8,\"noise\":0,\"background\":30,\"contrast\":170",
      "\"dpi\":4800,\"blur_px\":2.0,\"noise\":2,\"noise_correlation\":0.6,\"background\":35,"
      "\"contrast\":160,\"rough\":{\"one_sided_blur_px\":1.5,\"edge_roughness_um\":1.5,"
      "\"edge_common_um\":0.5,\"correlation_um\":50,\"halo\":{\"fraction\":0.2,\"length_px\":20}}",
  };
  for (size_t i = 0; i < sizeof scanners / sizeof *scanners; i++)
    assert_int_equal(of_scanner(scanners[i]).findings, 0);
}

/* One kind and strength, and which findings it must and may have. */
typedef struct kind {
  const char *scanner;
  unsigned must, may;
} kind;

static void each_kind_is_found(void **unused) {
  (void)unused;
  const unsigned model = FG_PICTURE_TONE_CURVE | FG_PICTURE_UNKNOWN_PROFILE;
  const kind kinds[] = {
      {PLAIN ",\"unsharp_mask\":{\"amount_pct\":50,\"radius_px\":1}", FG_PICTURE_SHARPENED, model},
      {PLAIN ",\"unsharp_mask\":{\"amount_pct\":150,\"radius_px\":1}", FG_PICTURE_SHARPENED, model},
      {PLAIN ",\"levels\":16", FG_PICTURE_FEW_LEVELS, model | FG_PICTURE_CORRELATED_NOISE},
      {PLAIN ",\"levels\":2,\"threshold\":90", FG_PICTURE_FEW_LEVELS,
       model | FG_PICTURE_CLIPPED | FG_PICTURE_ROW_JUMPS},
      {PLAIN ",\"rough\":{\"jpeg\":{\"quality\":60}}", FG_PICTURE_BLOCK_NOISE, model},
      {PLAIN ",\"rough\":{\"jpeg\":{\"quality\":90}}", FG_PICTURE_BLOCK_NOISE, model},
      {PLAIN ",\"tone_curve\":[[0,0],[64,20],[128,128],[192,236],[255,255]]", FG_PICTURE_TONE_CURVE,
       model},
      {PLAIN ",\"rough\":{\"side_wall\":{\"amplitude\":0.1,\"direction_deg\":-90,"
             "\"length_px\":10}}",
       FG_PICTURE_SHADOW, model | FG_PICTURE_SHARPENED},
  };
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
    in_row("kinds[%zu]", i);
    unsigned found = of_scanner(kinds[i].scanner).findings;
    if ((found & kinds[i].must) != kinds[i].must || (found & ~(kinds[i].must | kinds[i].may)))
      fail_msg("%s: found %#x", kinds[i].scanner, found);
  }
}

/* Few blocks beside a foil step: they are told all the same, and no
 * mask that would explain the edges as well. */
static void blocks_are_told_where_few_step(void **unused) {
  (void)unused;
  const char *jpeg = "\"dpi\":2400,\"blur_px\":1.2,\"noise\":1,\"background\":30,\"contrast\":175,"
                     "\"rough\":{\"jpeg\":{\"quality\":60}}";
  char json[2048];
  snprintf(json, sizeof json,
           "{\"schema\":\"foilgauge/render/1\",\"seed\":5,\"foils\":[{\"design\":{\"form\":"
           "\"classical\",\"bump_count\":3,\"bump_radius_mm\":3.32,\"bump_angle_deg\":63.15,"
           "\"overall_radius_mm\":20.73,\"thickness_mm\":0.1,\"rotor_diameter_mm\":40},"
           "\"overall_radius_mm\":20.9,\"rotate_deg\":-77}],\"scanner\":{%s}}",
           jpeg);
  measured m = measure_render(json, NULL);
  assert_int_equal(m.result.foil_count, 1);
  unsigned foil = m.result.foils[0].strip.picture.findings;
  measured_free(&m);
  assert_true(foil & FG_PICTURE_BLOCK_NOISE);
  assert_false(foil & FG_PICTURE_SHARPENED);
}

static void blur_is_an_ellipse(void **unused) {
  (void)unused;
  fg_picture_state state =
      of_scanner("\"dpi\":2400,\"blur_px\":[3,1],\"noise\":1,\"background\":30,\"contrast\":160");
  assert_true(state.findings & FG_PICTURE_UNEVEN_BLUR);
  assert_near(state.blur_px[0], 3, 0.4);
  assert_near(state.blur_px[1], 1, 0.4);
  assert_near(remainder(state.blur_direction_deg, 180), 0, 5);
  state = of_scanner(
      "\"dpi\":2400,\"blur_px\":[1.4,1.1],\"noise\":1,\"background\":30,\"contrast\":160");
  assert_int_equal(state.findings, 0);
}

/* A row is lost where the limbs of the bumps are slanted, at several places. */
static void rows_that_jump_are_counted(void **unused) {
  (void)unused;
  fg_picture_state state = state_of(",\"rotate_deg\":40",
                                    PLAIN ",\"rows_lost\":[{\"y_mm\":2.0,\"count\":2},"
                                          "{\"y_mm\":3.2,\"count\":2},{\"y_mm\":4.4,\"count\":2}]");
  assert_true(state.findings & FG_PICTURE_ROW_JUMPS);
  assert_true(state.row_jumps >= 1 && state.row_jumps <= 3);
  assert_near(state.row_jump_px, -2, 0.4);
}

static void noise_is_measured(void **unused) {
  (void)unused;
  fg_picture_state state = of_scanner(PLAIN);
  assert_true(fabs(state.noise_correlation[0]) < 0.2 && fabs(state.noise_correlation[1]) < 0.2);
  state = of_scanner(PLAIN ",\"noise_correlation\":0.7");
  assert_near(state.noise_correlation[0], 0.65, 0.2);
  assert_near(state.noise_correlation[1], 0.65, 0.2);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(nothing_is_found_on_plain_scans), cmocka_unit_test(each_kind_is_found),
      cmocka_unit_test(blocks_are_told_where_few_step),  cmocka_unit_test(blur_is_an_ellipse),
      cmocka_unit_test(rows_that_jump_are_counted),      cmocka_unit_test(noise_is_measured),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of a picture that jump beside round edges: found where they lie, and not found on plain,
 * rough, lobed and dented discs. */
#include <unistd.h>

#include "foilgauge/measure.h"
#include "support/measured_render.h"
#include "support/test.h"

#define PLAIN "\"dpi\":2400,\"blur_px\":1.0,\"noise\":1.5,\"background\":30,\"contrast\":160"
#define ROUGH                                                                                      \
  "\"dpi\":2400,\"blur_px\":1.0,\"noise\":1.2,\"noise_correlation\":0.6,\"background\":35,"        \
  "\"contrast\":160,\"rough\":{\"edge_roughness_um\":2,\"correlation_um\":80}"

/* Draws a scan and measures its discs. */
static fg_measurement measure_discs(const char *json) {
  fg_context ctx = {0};
  char path[] = "/tmp/foilgauge_ring_XXXXXX";
  fg_render_spec *spec = NULL;
  fg_design design;
  fg_measurement result = {0};
  const fg_measure_options options = {.threads = 1};
  int file = mkstemp(path);
  assert_true(file >= 0);
  close(file);
  fg_design_default(&design);
  assert_int_equal(fg_design_become(NULL, FG_FOIL_DISCS, &design), FG_OK);
  if (fg_render_parse(&ctx, "disc.json", json, &spec) != FG_OK) fail_msg("%s", ctx.message);
  assert_ok(&ctx, fg_render_scan(&ctx, spec, path, NULL));
  assert_ok(&ctx, fg_measure_scan(&ctx, path, &design, &options, &result));
  fg_render_free(spec);
  unlink(path);
  return result;
}

/* Of one disc of 3 mm, 283 px, whose centre is in row 207.4. `more`: members of it, or what else
 * is drawn. */
static fg_picture_state state_under(const char *more, const char *scanner, const char *effects) {
  char json[4096];
  bool is_part = !strncmp(more, ",{", 2);
  snprintf(json, sizeof json,
           "{\"schema\":\"foilgauge/render/1\",\"seed\":11,\"width_px\":416,\"height_px\":416,"
           "\"discs\":[{\"centre_mm\":[2.2,2.2],\"radius_mm\":1.5%s}%s],\"scanner\":{%s},"
           "\"effects\":[%s]}",
           is_part ? "" : more, is_part ? more : "", scanner, effects);
  fg_measurement m = measure_discs(json);
  fg_picture_state state = fg_picture_unknown();
  for (size_t i = 0; i < m.disc_count; i++)
    if (fabs(m.discs[i].radius_mm - 1.5) < 0.1) state = m.discs[i].picture;
  assert_true(state.noise > 0);
  fg_measurement_free(&m);
  return state;
}

static fg_picture_state state_of(const char *more, const char *scanner) {
  return state_under(more, scanner, "");
}

static void assert_none(const char *disc, const char *scanner) {
  fg_picture_state state = state_of(disc, scanner);
  if (state.findings & FG_PICTURE_ROW_JUMPS)
    fail_msg("%s, %s: %g jumps of %g px", disc, scanner, state.row_jumps, state.row_jump_px);
}

static void assert_jumps(const char *scanner, double jumps, double px, double u_px) {
  fg_picture_state state = state_of("", scanner);
  if (!(state.findings & FG_PICTURE_ROW_JUMPS)) fail_msg("%s: none is found", scanner);
  assert_near(state.row_jumps, jumps, 0);
  assert_near(state.row_jump_px, px, u_px);
}

/* y in mm: 1 is far above the middle, 2.2 in the middle, where the limbs run along y. */
static void rows_lost_and_doubled_are_found(void **unused) {
  (void)unused;
  assert_jumps(PLAIN ",\"rows_lost\":[{\"y_mm\":1.2,\"count\":1}]", 1, -1, 0.15);
  assert_jumps(PLAIN ",\"rows_lost\":[{\"y_mm\":3.1,\"count\":-2}]", 1, 2, 0.3);
  assert_jumps(PLAIN ",\"rows_lost\":[{\"y_mm\":2.2,\"count\":2}]", 1, -2, 0.5);
  assert_jumps(PLAIN ",\"rows_lost\":[{\"y_mm\":2.2,\"count\":-4}]", 1, 4, 0.6);
  assert_jumps(PLAIN ",\"rows_lost\":[{\"y_mm\":1.3,\"count\":1},{\"y_mm\":2.8,\"count\":-2}]", 2,
               2, 0.3);
  assert_jumps(ROUGH ",\"rows_lost\":[{\"y_mm\":1.4,\"count\":2}]", 1, -2, 0.4);
}

/* Truth: the picture behind it lies by 21.17 um, 2 px, to the left. */
static void pieces_that_are_shifted_are_found(void **unused) {
  (void)unused;
  assert_jumps(PLAIN ",\"stitches\":[{\"y_mm\":1.7,\"shift_um\":21.17}]", 1, -2, 0.2);
  assert_jumps(PLAIN ",\"stitches\":[{\"y_mm\":2.2,\"shift_um\":-21.17}]", 1, 2, 0.2);
  assert_jumps(PLAIN ",\"stitches\":[{\"y_mm\":2.9,\"rows\":3,\"shift_um\":10}]", 1, -3, 0.4);
}

static void plain_and_rough_discs_have_no_row_jumps(void **unused) {
  (void)unused;
  static const char *const scanners[] = {
      PLAIN, ROUGH, PLAIN ",\"bits\":16",
      "\"dpi\":2400,\"blur_px\":[1.6,1.1],\"noise\":2,\"background\":215,\"contrast\":-150"};
  for (size_t i = 0; i < sizeof scanners / sizeof *scanners; i++)
    assert_none("", scanners[i]);
}

static void lobed_discs_have_no_row_jumps(void **unused) {
  (void)unused;
  static const int lobes[] = {2, 3, 4, 5, 7, 9, 12};
  static const double sizes_um[] = {3, 12};
  char disc[128];
  for (size_t i = 0; i < sizeof lobes / sizeof *lobes; i++)
    for (size_t k = 0; k < 2; k++)
      for (int phase = 0; phase < 2; phase++) {
        snprintf(disc, sizeof disc, ",\"lobes\":%d,\"lobe_um\":%g,\"lobe_phase_deg\":%d", lobes[i],
                 sizes_um[k], 37 * phase);
        assert_none(disc, PLAIN);
      }
}

/* A hole that cuts into the edge: at a limb, at the side, on top. */
static void dented_discs_have_no_row_jumps(void **unused) {
  (void)unused;
  static const double places[] = {0, 20, 45, 90, 130, 200, 300};
  static const double depths_mm[] = {0.01, 0.03};
  char disc[160];
  for (size_t i = 0; i < sizeof places / sizeof *places; i++)
    for (size_t k = 0; k < 2; k++) {
      double angle = places[i] * M_PI / 180, far = 1.5 + 0.4 - depths_mm[k];
      snprintf(disc, sizeof disc, ",{\"centre_mm\":[%.6f,%.6f],\"radius_mm\":0.4,\"hole\":true}",
               2.2 + far * cos(angle), 2.2 + far * sin(angle));
      assert_none(disc, PLAIN);
    }
}

/* Chips of the sensor that are shifted along y, or turned: the edge jumps from column to column. */
static void seams_of_chips_are_no_row_jumps(void **unused) {
  (void)unused;
  static const char *const chips[] = {
      "{\"id\":\"scan.chip_tilt\",\"amplitude_um\":12,\"x_mm\":1.7,\"pitch_mm\":9}",
      "{\"id\":\"scan.chip_tilt\",\"amplitude_um\":20,\"x_mm\":2.6,\"pitch_mm\":9}",
      "{\"id\":\"scan.chip_tilt\",\"amplitude_um\":-16,\"x_mm\":1.2,\"pitch_mm\":9}",
  };
  for (size_t i = 0; i < sizeof chips / sizeof *chips; i++) {
    fg_picture_state state = state_under("", PLAIN, chips[i]);
    if (state.findings & FG_PICTURE_ROW_JUMPS)
      fail_msg("%s: %g jumps of %g px", chips[i], state.row_jumps, state.row_jump_px);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rows_lost_and_doubled_are_found),
      cmocka_unit_test(pieces_that_are_shifted_are_found),
      cmocka_unit_test(plain_and_rough_discs_have_no_row_jumps),
      cmocka_unit_test(lobed_discs_have_no_row_jumps),
      cmocka_unit_test(dented_discs_have_no_row_jumps),
      cmocka_unit_test(seams_of_chips_are_no_row_jumps),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

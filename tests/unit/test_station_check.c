/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statements of a check about a scanner, on plates of known diameters under scanners of known scale
 * and shear. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "foilgauge/measure.h"
#include "foilgauge/render.h"
#include "station/check_fit.h"
#include "station/check_state.h"
#include "support/brief.h"
#include "support/test.h"

#define NOMINAL_DPI 4800.0

/* Errors of a scanner: scale, measured over true, less 1; shear, rad. And the statement about its
 * tone. */
typedef struct scanner {
  double scale_x, scale_y, shear;
  fg_tone_statement tone;
} scanner;

static const double radii_mm[] = {0.4, 0.6, 0.8};
enum { DISCS = sizeof radii_mm / sizeof *radii_mm };

/* A scanner with more pixels to the mm than it says sees everything larger along x; the effects say
 * where a pixel truly is, so they have the other sign. */
static void write_spec(char *json, size_t size, const scanner *is, unsigned seed,
                       const char *picture) {
  snprintf(
      json, size,
      "{\"schema\":\"foilgauge/render/1\",\"seed\":%u,\"discs\":["
      "{\"centre_mm\":[0.61,0.7],\"radius_mm\":%g},{\"centre_mm\":[1.91,0.9],\"radius_mm\":%g},"
      "{\"centre_mm\":[3.6013,1.1027],\"radius_mm\":%g}],\"scanner\":{\"dpi\":[%.9g,%.9g],%s},"
      "\"effects\":[{\"id\":\"scan.scale_y\",\"value\":%.9g},{\"id\":\"scan.shear\","
      "\"value\":%.9g}]}",
      seed, radii_mm[0], radii_mm[1], radii_mm[2], NOMINAL_DPI * (1 + is->scale_x), NOMINAL_DPI,
      picture, -is->scale_y, -is->shear);
}

static void design_plate(fg_design *design) {
  fg_design_default(design);
  assert_int_equal(fg_design_become(NULL, FG_FOIL_DISCS, design), FG_OK);
  design->discs.count = DISCS;
  for (size_t i = 0; i < DISCS; i++)
    design->discs.diameters_mm[i] = 2 * radii_mm[i];
}

static fg_check_fit check(const scanner *is, unsigned seed, const char *picture) {
  char json[2048], path[] = "/tmp/foilgauge_check_XXXXXX";
  fg_context ctx = {0};
  fg_render_spec *spec = NULL;
  fg_design design;
  fg_measurement measurement;
  fg_check_fit fit;
  const fg_measure_options options = {.dpi = NOMINAL_DPI};
  close(mkstemp(path));
  write_spec(json, sizeof json, is, seed, picture);
  if (fg_render_parse(&ctx, "plate.json", json, &spec) != FG_OK) fail_msg("%s", ctx.message);
  assert_ok(&ctx, fg_render_scan(&ctx, spec, path, NULL));
  design_plate(&design);
  design.tone = is->tone;
  if (fg_measure_scan(&ctx, path, &design, &options, &measurement) != FG_OK)
    fail_msg("%s", ctx.message);
  if (fg_check_fit_plate(&ctx, &design, &measurement, &fit) != FG_OK) fail_msg("%s", ctx.message);
  fg_measurement_free(&measurement);
  fg_render_free(spec);
  unlink(path);
  return fit;
}

/* Deviations from the truth in u, and in ppm. */
static void compare(const fg_check_fit *fit, const scanner *is, double in_u[3], double ppm[3]) {
  const double error[3] = {fit->scale[0] - is->scale_x, fit->scale[1] - is->scale_y,
                           fit->shear - is->shear};
  const double u[3] = {fit->u_scale[0], fit->u_scale[1], fit->u_shear};
  for (int k = 0; k < 3; k++) {
    in_u[k] = error[k] / u[k];
    ppm[k] = 1e6 * error[k];
  }
}

/* Over seeds: none further off than 4 u, the mean square of deviation / u about 1, and no larger
 * errors than `max_ppm`. Over 40 seeds (SEEDS) the root of that mean square is 0.77 to 1.15 for
 * each of the three, in every one of these pictures, and none is 4 u off. */
static void check_coverage(const char *picture, const scanner *is, double min, double max,
                           double max_ppm) {
#ifndef SEEDS
  const unsigned seeds = 4 / test_step(4);
#else
  const unsigned seeds = SEEDS;
#endif
  double squares[3] = {0}, square_ppm[3] = {0}, worst = 0;
  for (unsigned seed = 1; seed <= seeds; seed++) {
    double in_u[3], ppm[3];
    fg_check_fit fit = check(is, seed, picture);
    assert_int_equal(fit.discs, DISCS);
    compare(&fit, is, in_u, ppm);
    for (int k = 0; k < 3; k++) {
      squares[k] += in_u[k] * in_u[k] / seeds;
      square_ppm[k] += ppm[k] * ppm[k] / seeds;
      worst = fmax(worst, fabs(in_u[k]));
    }
  }
  double all = sqrt((squares[0] + squares[1] + squares[2]) / 3);
  printf("%s: deviation / u %.2f %.2f %.2f, worst %.1f; ppm %.1f %.1f %.1f\n", picture,
         sqrt(squares[0]), sqrt(squares[1]), sqrt(squares[2]), worst, sqrt(square_ppm[0]),
         sqrt(square_ppm[1]), sqrt(square_ppm[2]));
#ifndef SEEDS
  assert_true(worst < 4);
  assert_true(all > min && all < max);
  for (int k = 0; k < 3; k++)
    assert_true(sqrt(square_ppm[k]) < max_ppm * 2 / sqrt(seeds)); /* of four */
#else
  (void)all, (void)min, (void)max, (void)max_ppm;
#endif
}

static void scale_and_shear_are_found(void **state) {
  (void)state;
  check_coverage("\"noise\":2", &(scanner){400e-6, -700e-6, 300e-6, FG_TONE_UNKNOWN}, 0.4, 1.8, 15);
}

static void a_good_scanner_is_not_blamed(void **state) {
  (void)state;
  check_coverage("\"noise\":3,\"noise_correlation\":0.5", &(scanner){0, 0, 0, FG_TONE_UNKNOWN}, 0.4,
                 1.8, 150);
}

static void a_tone_curve_is_in_the_uncertainty(void **state) {
  (void)state;
  check_coverage("\"noise\":2,\"gamma\":1.8,\"bits\":16",
                 &(scanner){100e-6, 100e-6, -50e-6, FG_TONE_UNKNOWN}, 0, 1.8, 60);
}

/* An unknown tone makes the level of the edges one more unknown. */
static void rough_edges_are_in_the_uncertainty(void **state) {
  (void)state;
  check_coverage("\"noise\":2,\"rough\":{\"edge_roughness_um\":1,\"correlation_um\":50}",
                 &(scanner){0, 300e-6, 0, FG_TONE_UNKNOWN}, 0.3, 1.8, 800);
  check_coverage("\"noise\":2,\"rough\":{\"edge_roughness_um\":1,\"correlation_um\":50}",
                 &(scanner){0, 300e-6, 0, FG_TONE_LINEAR}, 0.3, 1.8, 400);
}

/* Without a tone curve no level is off; with one all edges of bright parts move by as much, and the
 * scale does not. */
static void a_tone_curve_shows_in_the_level_of_the_edges(void **state) {
  (void)state;
  const scanner none = {0, 0, 0, FG_TONE_UNKNOWN};
  fg_check_fit plain = check(&none, 1, "\"noise\":1,\"blur_px\":1.5");
  assert_true(fabs(plain.level_um) < 4 * plain.u_level_um && plain.u_level_um < 0.1);
  fg_check_fit brighter =
      check(&none, 1, "\"noise\":1,\"blur_px\":1.5,\"tone_curve\":[[0,0],[128,160],[255,255]]");
  assert_true(brighter.level_um > 0.5 && brighter.u_level_um < 0.2);
  assert_true(fabs(brighter.scale[0]) < 4 * brighter.u_scale[0]);
}

/* Discs of one size do not tell the level from the scale. */
static void one_size_tells_no_level(void **state) {
  (void)state;
  fg_design design;
  fg_check_fit fit;
  fg_context ctx = {0};
  enum { POINTS = 400 };
  fg_point edge[POINTS];
  fg_disc discs[2];
  for (int i = 0; i < POINTS; i++)
    edge[i] = (fg_point){0.4002 * cos(2 * M_PI * i / POINTS) + 1e-5 * sin(i * 1.0),
                         0.4002 * sin(2 * M_PI * i / POINTS)};
  for (int i = 0; i < 2; i++)
    discs[i] = (fg_disc){.bright = true,
                         .diameter_mm = 0.8004,
                         .coverage_deg = 360,
                         .points = POINTS,
                         .edge = edge,
                         .level_u_mm = 1e-4};
  const fg_measurement measurement = {.discs = discs, .disc_count = 2};
  design_plate(&design);
  assert_ok(&ctx, fg_check_fit_plate(&ctx, &design, &measurement, &fit));
  assert_true(isnan(fit.level_um) && isnan(fit.u_level_um));
}

/* A limit is held against the value and its uncertainty. */
static void the_judge_counts_the_uncertainty(void **state) {
  (void)state;
  char words[300];
  fg_check_fit fit = {.discs = 3, .scale = {250e-6, 0}, .u_scale = {20e-6, 20e-6}, .u_shear = 1e-6};
  fg_check_fit_judge(&fit, 300, words, sizeof words);
  assert_true(fit.passes);
  assert_has(words, "in order");
  assert_has(words, "x +250 ± 40 ppm");
  fg_check_fit_judge(&fit, 280, words, sizeof words);
  assert_false(fit.passes);
  assert_has(words, "out of order");
  fit = (fg_check_fit){.discs = 3, .shear = -400e-6, .u_shear = 1e-6};
  fg_check_fit_judge(&fit, 300, words, sizeof words);
  assert_false(fit.passes);
}

static void a_plate_of_other_diameters_is_refused(void **state) {
  (void)state;
  fg_context ctx = {0};
  fg_design design;
  fg_check_fit fit;
  fg_disc disc = {.diameter_mm = 7, .coverage_deg = 360};
  const fg_measurement measurement = {.discs = &disc, .disc_count = 1};
  design_plate(&design);
  assert_status(&ctx, fg_check_fit_plate(&ctx, &design, &measurement, &fit), FG_ERR_NOT_MEASURED);
  assert_has(ctx.message, "none of 1 discs");
}

static void a_grid_shows_scale_shear_and_its_largest_residual(void **state) {
  fg_design design;
  fg_grid grid = {.kind = FG_MARKS_DOTS,
                  .used = 100,
                  .step_mm = {{5.002, 0.0001}, {4.999, 0.0001}},
                  .shear = {3e-4, 1e-5},
                  .largest_um = 4.5,
                  .mark_u_um = 0.3,
                  .blur_um = 40};
  fg_measurement measurement = {.grid = &grid};
  fg_context ctx = {0};
  fg_check_fit fit;
  fg_check_state baseline, now;
  char words[600];
  (void)state;
  fg_design_default(&design);
  assert_int_equal(fg_design_become(NULL, FG_FOIL_GRID, &design), FG_OK);
  design.grid.pitch_mm = 5;
  design.grid.u_pitch_mm = 0.0002;
  assert_ok(&ctx, fg_check_fit_grid(&ctx, &design, &measurement, &fit));
  assert_float_equal(fit.scale[0], 4e-4, 1e-12);
  assert_float_equal(fit.scale[1], -2e-4, 1e-12);
  assert_float_equal(fit.u_scale[0], hypot(0.0001, 0.0002) / 5, 1e-12);
  assert_float_equal(fit.shear, 3e-4, 1e-12);
  fg_check_fit_judge(&fit, 600, words, sizeof words);
  assert_has(words, "in order: 100 marks");
  assert_has(words, "largest residual of a mark 4.5 µm");
  fg_check_state_find(&measurement, &fit, &baseline);
  grid.step_mm[1].value += 0.0002; /* 40 ppm: within what matters */
  assert_ok(&ctx, fg_check_fit_grid(&ctx, &design, &measurement, &fit));
  fg_check_state_find(&measurement, &fit, &now);
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 0);
  grid.step_mm[1].value += 0.001;
  grid.largest_um = 9;
  assert_ok(&ctx, fg_check_fit_grid(&ctx, &design, &measurement, &fit));
  fg_check_state_find(&measurement, &fit, &now);
  assert_int_equal(fg_check_state_compare(&now, &baseline, words, sizeof words), 2);
  assert_has(words, "scale along y");
  assert_has(words, "largest residual");
  /* Corners two squares apart are the same scale. */
  grid.squares_per_step = 2;
  grid.step_mm[0].value = 2 * 5.002;
  assert_ok(&ctx, fg_check_fit_grid(&ctx, &design, &measurement, &fit));
  assert_float_equal(fit.scale[0], 4e-4, 1e-12);
  grid.step_mm[1].value = NAN;
  assert_int_equal(fg_check_fit_grid(&ctx, &design, &measurement, &fit), FG_ERR_NOT_MEASURED);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_grid_shows_scale_shear_and_its_largest_residual),
      cmocka_unit_test(scale_and_shear_are_found),
      cmocka_unit_test(a_good_scanner_is_not_blamed),
      cmocka_unit_test(a_tone_curve_is_in_the_uncertainty),
      cmocka_unit_test(rough_edges_are_in_the_uncertainty),
      cmocka_unit_test(a_tone_curve_shows_in_the_level_of_the_edges),
      cmocka_unit_test(one_size_tells_no_level),
      cmocka_unit_test(the_judge_counts_the_uncertainty),
      cmocka_unit_test(a_plate_of_other_diameters_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The beam model of forming: closed forms, convergence, geometry, trends, and constants that come
 * back. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/forming.h"
#include "forming/section.h"
#include "support/brief.h"
#include "support/test.h"

static const double plane = 1.1547005383792515; /* 2 / sqrt 3 */

static double relative(double value, double truth) {
  return fabs(value / truth - 1);
}

/* Nothing depends on the temperature but creep. */
static fg_forming_material plain_material(double yield, double hardening) {
  fg_forming_material m;
  fg_forming_material_default(&m);
  m.value[FG_FORMING_MODULUS_SLOPE] = 0;
  m.value[FG_FORMING_YIELD] = yield;
  m.value[FG_FORMING_HARDENING] = hardening;
  for (size_t i = 0; i < m.curve_count; i++)
    m.curve_share[i] = 1;
  return m;
}

static double plane_modulus(const fg_forming_material *m) {
  double nu = m->value[FG_FORMING_POISSON];
  return 1000 * m->value[FG_FORMING_MODULUS] / (1 - nu * nu);
}

/* Springback of a section without treatment, 1/mm. */
static double springback(const fg_forming_material *m, double thickness, double curvature,
                         size_t layers) {
  fg_context ctx = {0};
  fg_section s;
  assert_ok(&ctx, fg_section_make(&ctx, thickness, layers, &s));
  fg_section_bend(m, curvature, &s);
  double change = fg_section_moment(m, FG_FORMING_COLD_C, &s) / fg_section_stiffness(m, &s);
  fg_section_free(&s);
  return change;
}

/* Elastic-perfectly plastic: M = Y' t² / 4 (1 - (k_e / k)² / 3), k_e = 2 Y' / (E' t). */
static void perfectly_plastic_beam(void **state) {
  (void)state;
  const double thickness = 0.1, curvatures[] = {0.06, 1 / 3.32, 1 / 0.35};
  fg_forming_material m = plain_material(400, 0);
  double modulus = plane_modulus(&m), yield = plane * 400, k_e = 2 * yield / (modulus * thickness);
  for (size_t i = 0; i < 3; i++) {
    double k = curvatures[i],
           moment = yield * thickness * thickness / 4 * (1 - k_e * k_e / (3 * k * k));
    double truth = 12 * moment / (modulus * pow(thickness, 3));
    double coarse = relative(springback(&m, thickness, k, 10), truth);
    double fine = relative(springback(&m, thickness, k, 200), truth);
    assert_true(fine < 5e-5);
    assert_true(relative(springback(&m, thickness, k, 1000), truth) < 2e-6);
    assert_true(fine < coarse / 50); /* second order: 400 but for where the kink falls */
  }
}

/* Linear hardening: sigma = Y' + E_t (eps - Y'/E') beyond the yield strain. */
static void hardening_beam(void **state) {
  (void)state;
  const double t = 0.1, k = 1 / 3.32, h = t / 2;
  fg_forming_material m = plain_material(250, 2500);
  double modulus = plane_modulus(&m), yield = plane * 250, slope = plane * plane * 2500;
  double tangent = modulus * slope / (modulus + slope), z = yield / (modulus * k);
  double moment =
      2 * (modulus * k * z * z * z / 3 + (yield - tangent * k * z) * (h * h - z * z) / 2 +
           tangent * k * (h * h * h - z * z * z) / 3);
  assert_true(relative(springback(&m, t, k, 200), 12 * moment / (modulus * pow(t, 3))) < 5e-5);
}

static void elastic_strip_is_flat_again(void **state) {
  (void)state;
  fg_forming_material m = plain_material(5000, 0);
  assert_true(relative(springback(&m, 0.1, 0.05, 7), 0.05) < 1e-14);
}

/* ---- relaxation ---- */

static double rate_of(const fg_forming_material *m, double temperature_C) {
  double inverse = 1 / (temperature_C + 273.15) - 1 / (FG_FORMING_CREEP_TEMP_C + 273.15);
  return m->value[FG_FORMING_CREEP_RATE] *
         exp(-m->value[FG_FORMING_CREEP_ENERGY] / 8.31446261815324e-3 * inverse);
}

/* Stress at the face after a schedule. */
static double face_after(const fg_forming_material *m, double curvature,
                         const fg_forming_schedule *schedule, size_t steps) {
  fg_context ctx = {0};
  fg_section s;
  assert_ok(&ctx, fg_section_make(&ctx, 0.1, 4, &s));
  fg_section_bend(m, curvature, &s);
  fg_section_treat(m, schedule, steps, &s);
  double stress = fg_section_face_stress(m, FG_FORMING_COLD_C, &s);
  fg_section_free(&s);
  return stress;
}

static void relaxing_bar(void **state) {
  (void)state;
  const double exponents[] = {1, 1.0001, 3, 7.5};
  double times[] = {0, 5}, temperatures[] = {600, 600};
  const fg_forming_schedule hold = {.time_h = times, .temperature_C = temperatures, .count = 2};
  fg_forming_material m = plain_material(5000, 0);
  m.value[FG_FORMING_CREEP_RATE] = 1e-4;
  double start = plane_modulus(&m) * 0.05 * 0.04;
  for (size_t i = 0; i < 4; i++) {
    double n = exponents[i];
    m.value[FG_FORMING_CREEP_EXPONENT] = n;
    double g = plane_modulus(&m) * rate_of(&m, 600) * pow(sqrt(3) / 2, n + 1) * 5 *
               pow(FG_FORMING_CREEP_MPA, -n);
    double truth = n == 1 ? start * exp(-g) : pow(pow(start, 1 - n) + (n - 1) * g, -1 / (n - 1));
    assert_true(truth < 0.9 * start);
    assert_true(relative(face_after(&m, 0.04, &hold, 1), truth) < 1e-11);
  }
}

/* Up and down: against Runge-Kutta in 20000 steps. */
static double ramp_truth(const fg_forming_material *m, double start) {
  double n = m->value[FG_FORMING_CREEP_EXPONENT], stress = start, step = 6.0 / 20000;
  for (int i = 0; i < 20000; i++) {
    double k[4], at = stress;
    for (int j = 0; j < 4; j++) {
      double time = step * (i + (j == 0 ? 0 : j == 3 ? 1 : 0.5));
      double temperature = time < 3 ? 20 + 200 * time : 620 - 200 * (time - 3);
      k[j] = -plane_modulus(m) * rate_of(m, temperature) * pow(sqrt(3) / 2, n + 1) *
             pow(at / FG_FORMING_CREEP_MPA, n);
      at = stress + step * (j == 2 ? 1 : 0.5) * k[j];
    }
    stress += step / 6 * (k[0] + 2 * k[1] + 2 * k[2] + k[3]);
  }
  return stress;
}

static void ramps_converge(void **state) {
  (void)state;
  double times[] = {0, 3, 6}, temperatures[] = {20, 620, 20};
  const fg_forming_schedule ramp = {.time_h = times, .temperature_C = temperatures, .count = 3};
  fg_forming_material m = plain_material(5000, 0);
  m.value[FG_FORMING_CREEP_RATE] = 1e-3;
  m.value[FG_FORMING_CREEP_EXPONENT] = 4;
  m.value[FG_FORMING_CREEP_ENERGY] = 200;
  double start = plane_modulus(&m) * 0.05 * 0.04, truth = ramp_truth(&m, start);
  double coarse = relative(face_after(&m, 0.04, &ramp, 25), truth);
  double fine = relative(face_after(&m, 0.04, &ramp, 200), truth);
  assert_true(truth < 0.8 * start);
  assert_true(fine < 1e-7);
  assert_true(fine < coarse / 1000); /* fourth order: 4096 */
}

/* Stress across the width is taken as half of that along it. Without that, from its elastic value
 * nu sigma_x: Mises flow in plane strain, both stresses followed. */
static void plane_strain_is_near(void **state) {
  (void)state;
  const double n = 4.6, hours = 5;
  double times[] = {0, hours}, temperatures[] = {550, 550};
  const fg_forming_schedule hold = {.time_h = times, .temperature_C = temperatures, .count = 2};
  fg_forming_material m = plain_material(5000, 0);
  m.value[FG_FORMING_CREEP_RATE] = 5e-4;
  m.value[FG_FORMING_CREEP_EXPONENT] = n;
  double nu = m.value[FG_FORMING_POISSON], modulus = plane_modulus(&m);
  double x = modulus * 0.05 * 0.04, y = nu * x, step = hours / 200000;
  for (int i = 0; i < 200000; i++) {
    double mises = sqrt(x * x - x * y + y * y);
    double rate = m.value[FG_FORMING_CREEP_RATE] * pow(mises / FG_FORMING_CREEP_MPA, n - 1) /
                  FG_FORMING_CREEP_MPA;
    double creep_x = rate * (x - y / 2), creep_y = rate * (y - x / 2);
    x -= step * modulus * (creep_x + nu * creep_y);
    y -= step * modulus * (creep_y + nu * creep_x);
  }
  double reduced = face_after(&m, 0.04, &hold, 1);
  assert_true(x < 0.5 * modulus * 0.05 * 0.04);
  assert_true(relative(reduced, x) < 0.03);
}

/* ---- the strip ---- */

static void run_forming(const fg_design *design, const fg_forming_material *m, double temperature_C,
                        double hours, const fg_forming_options *options, fg_forming *forming) {
  fg_context ctx = {0};
  fg_forming_schedule hold = {0};
  if (hours > 0) assert_ok(&ctx, fg_forming_schedule_hold(&ctx, temperature_C, hours, &hold));
  assert_ok(&ctx, fg_forming_run(&ctx, design, m, &hold, options, forming));
  fg_forming_schedule_free(&hold);
}

static fg_design sinusoidal_design(void) {
  fg_design design;
  fg_design_default(&design);
  design.kind = FG_FOIL_SINUSOIDAL;
  design.bumps.radius_mm = 3.2;
  design.bumps.angle_deg = 60;
  design.bumps.fillet_radius_mm = 1.1;
  return design;
}

/* A strip that has crept all it can has the die's circles, whatever line of it the design is of. */
static void a_fully_crept_strip_has_the_circles_of_its_die(void **state) {
  (void)state;
  fg_forming_material m;
  fg_forming_material_default(&m);
  m.value[FG_FORMING_CREEP_RATE] = 1e6;
  m.value[FG_FORMING_CREEP_EXPONENT] = 1;
  fg_design designs[4];
  for (int i = 0; i < 3; i++) {
    fg_design_default(&designs[i]);
    designs[i].datum = (fg_datum)i;
  }
  designs[3] = sinusoidal_design();
  for (int i = 0; i < 4; i++) {
    fg_forming f;
    run_forming(&designs[i], &m, 700, 5, NULL, &f);
    assert_true(f.fitted && f.bump_count == 9);
    assert_true(fabs(f.turn_die_deg - 40.0 / 3) < 1e-9 && fabs(f.turn_deg - 40.0 / 3) < 1e-9);
    assert_true(fabs(f.overall_radius_mm - 20.73) < 1e-9);
    assert_true(fabs(f.foil.overall.radius_mm - 20.73) < 1e-5);
    for (size_t b = 0; b < 9; b++) {
      assert_int_equal(f.bumps[b].number, b + 1);
      assert_true(fabs(f.bumps[b].fitted.radius_mm - designs[i].bumps.radius_mm) < 1e-5);
      assert_true(fabs(f.bumps[b].fitted.bump_angle_deg - designs[i].bumps.angle_deg) < 1e-3);
      assert_true(fabs(f.bumps[b].fitted.height_mm - f.nominal.height_mm) < 1e-5);
    }
    fg_forming_free(&f);
  }
}

/* An elastic strip with a linear law keeps one share of every curvature: turns scale with it. */
static void linear_law_scales(void **state) {
  (void)state;
  fg_forming_material m = plain_material(5000, 1e5);
  fg_design design = sinusoidal_design();
  fg_forming f;
  design.thickness_mm = 0.02; /* elastic everywhere */
  m.value[FG_FORMING_CREEP_RATE] = 1e-3;
  m.value[FG_FORMING_CREEP_EXPONENT] = 1;
  run_forming(&design, &m, 550, 1, NULL, &f);
  double share = f.mean_share;
  assert_true(share > 0.1 && share < 0.9);
  assert_true(fabs(f.turn_deg - (1 - share) * 40.0 / 3) < 1e-9);
  assert_true(relative(f.strip_radius_mm, 20.73 / (1 - share)) < 1e-12);
  assert_true(f.springback_error_pct < -5); /* such a foil opens */
  assert_true(relative(f.bumps[4].fitted.radius_mm, 3.2 / (1 - share)) < 1e-5);
  for (size_t i = 0; i < f.count; i++)
    assert_true(fabs(f.pieces[i].share - share) < 1e-12);
  fg_forming_free(&f);
}

/* Overall radius: that of the middles of the lands, and the one that `measure` finds. */
static void overall_radius_is_that_of_the_lands(void **state) {
  (void)state;
  fg_forming_material m;
  fg_design design;
  fg_forming f;
  fg_design_default(&design);
  fg_forming_material_default(&m);
  run_forming(&design, &m, 0, 0, NULL, &f);
  assert_true(f.fitted && !f.yields_back);
  assert_true(relative(f.foil.overall.radius_mm, f.overall_radius_mm) < 1e-3);
  assert_true(relative(f.bumps[4].fitted.radius_mm, f.bumps[4].curvature_radius_mm) < 1e-5);
  fg_forming_free(&f);
}

/* ---- trends (thesis: -17 % mean stress, -69 % cold springback; hotter and longer is less) ---- */

static void sinusoidal_die_lowers_both(void **state) {
  (void)state;
  fg_forming_material m;
  fg_forming_material_default(&m);
  fg_forming_options sine = {.shape = FG_FORMING_SINE};
  fg_design classical, arcs = sinusoidal_design();
  fg_design_default(&classical);
  const struct {
    const fg_design *design;
    const fg_forming_options *options;
  } others[] = {{&arcs, NULL}, {&classical, &sine}};
  fg_forming first;
  run_forming(&classical, &m, 0, 0, NULL, &first);
  for (size_t i = 0; i < 2; i++) {
    fg_forming f;
    run_forming(others[i].design, &m, 0, 0, others[i].options, &f);
    assert_true(f.mean_stress_mpa[FG_FORMING_BENT] < 0.99 * first.mean_stress_mpa[FG_FORMING_BENT]);
    assert_true(fabs(f.springback_error_pct) < 0.5 * fabs(first.springback_error_pct));
    fg_forming_free(&f);
  }
  fg_forming_free(&first);
}

static void hotter_and_longer_is_less(void **state) {
  (void)state;
  fg_forming_material m;
  fg_design design;
  fg_design_default(&design);
  fg_forming_material_default(&m);
  const double settings[][2] = {{0, 0}, {500, 1}, {500, 5}, {600, 5}, {600, 9}, {700, 9}};
  double share = 2, radius = INFINITY, strip = -INFINITY;
  for (size_t i = 0; i < 6; i++) {
    fg_forming f;
    run_forming(&design, &m, settings[i][0], settings[i][1], NULL, &f);
    assert_true(f.mean_share < share);
    assert_true(f.bumps[0].fitted.radius_error_pct < radius);
    assert_true(f.strip_springback_error_pct > strip);
    share = f.mean_share;
    radius = f.bumps[0].fitted.radius_error_pct;
    strip = f.strip_springback_error_pct;
    fg_forming_free(&f);
  }
}

/* ---- fits ---- */

static const double runs[13][3] = {
    {500, 3, -13.65}, {500, 3, -9.69}, {600, 3, -2.67}, {600, 3, -4.23},  {500, 5, -9.26},
    {500, 5, -9.41},  {600, 5, -4.63}, {600, 5, -3.33}, {400, 4, -20.77}, {700, 4, -2.44},
    {550, 1, -9.15},  {550, 7, -3.91}, {550, 4, -8.25}};

static void make_table(const double *response, fg_table *table) {
  fg_context ctx = {0};
  double column[2][13], own[13];
  for (size_t i = 0; i < 13; i++) {
    column[0][i] = runs[i][0];
    column[1][i] = runs[i][1];
    own[i] = response ? response[i] : runs[i][2];
  }
  *table = (fg_table){0};
  assert_ok(&ctx, fg_table_add_numbers(&ctx, table, "temperature_C", column[0], 13));
  assert_ok(&ctx, fg_table_add_numbers(&ctx, table, "duration_h", column[1], 13));
  assert_ok(&ctx, fg_table_add_numbers(&ctx, table, "springback_error_pct", own, 13));
}

static void fit(const double *response, fg_forming_response of, fg_forming_fit *result) {
  static const fg_forming_constant creep[] = {FG_FORMING_CREEP_RATE, FG_FORMING_CREEP_EXPONENT,
                                              FG_FORMING_CREEP_ENERGY};
  fg_context ctx = {0};
  fg_table table;
  fg_design design;
  fg_forming_material m;
  fg_design_default(&design);
  fg_forming_material_default(&m);
  make_table(response, &table);
  const fg_forming_fit_request request = {
      .design = &design, .material = &m, .response = of, .free = creep, .free_count = 3};
  assert_ok(&ctx, fg_forming_fit_runs(&ctx, &table, &request, result));
  fg_table_free(&table);
}

/* Runs of known constants, of the whole foil and of its lands. */
static void constants_of_made_runs_are_found(void **state) {
  (void)state;
  fg_design design;
  fg_forming_material m;
  fg_design_default(&design);
  fg_forming_material_default(&m);
  const double truth[3] = {2e-3, 3.7, 150};
  const fg_forming_options options = {.layers = 40};
  for (int c = 0; c < 3; c++)
    m.value[FG_FORMING_CREEP_RATE + c] = truth[c];
  for (int of = 0; of < 2 / (int)test_step(2); of++) {
    double response[13];
    for (size_t i = 0; i < 13; i++) {
      fg_forming f;
      run_forming(&design, &m, runs[i][0], runs[i][1], &options, &f);
      response[i] = of ? f.springback_error_pct : f.strip_springback_error_pct;
      fg_forming_free(&f);
    }
    fg_forming_fit result;
    fit(response, (fg_forming_response)of, &result);
    for (size_t k = 0; k < 3; k++)
      assert_true(relative(result.found[k].value, truth[k]) < 1e-3);
    assert_true(result.model.residual_sd < 1e-4 && result.model.left_out_rms < 1e-2);
    fg_forming_fit_free(&result);
  }
}

/* Errors on the thesis's runs (residual, of a run left out, of repeats), of this model and of a
 * quadratic surface. */
static void thirteen_runs(void **state) {
  (void)state;
  fg_forming_fit result;
  fit(NULL, FG_FORMING_OF_STRIP, &result);
  assert_true(fabs(result.model.residual_sd - 1.809) < 0.005);
  assert_true(result.model.left_out_rms > 6.5 && result.model.left_out_rms < 7.3);
  assert_true(fabs(result.surface.residual_sd - 1.4088) < 0.001);
  assert_true(fabs(result.surface.left_out_rms - 1.9253) < 0.001);
  assert_true(fabs(result.repeat_sd - 1.5743) < 0.001 && result.repeats == 4);
  assert_true(fabs(result.found[1].value - 4.61) < 0.05);
  assert_true(fabs(result.found[2].value - 130) < 1);
  /* The exponent's upper end is open: the rate goes with it. */
  assert_true(isfinite(result.found[0].interval[0]) && isnan(result.found[1].interval[1]));
  assert_true(result.found[1].interval[0] > 2 && result.found[1].interval[0] < 4.6);
  assert_true(result.correlation[0][1] > 0.98);
  fg_forming_fit_free(&result);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(perfectly_plastic_beam),
      cmocka_unit_test(hardening_beam),
      cmocka_unit_test(elastic_strip_is_flat_again),
      cmocka_unit_test(relaxing_bar),
      cmocka_unit_test(ramps_converge),
      cmocka_unit_test(plane_strain_is_near),
      cmocka_unit_test(a_fully_crept_strip_has_the_circles_of_its_die),
      cmocka_unit_test(linear_law_scales),
      cmocka_unit_test(overall_radius_is_that_of_the_lands),
      cmocka_unit_test(sinusoidal_die_lowers_both),
      cmocka_unit_test(hotter_and_longer_is_less),
      cmocka_unit_test(constants_of_made_runs_are_found),
      cmocka_unit_test(thirteen_runs),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

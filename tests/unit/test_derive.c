/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derived quantities of a bump: uncertainties against Monte Carlo, datum lines against each other,
 * circles that do not cross. */
#include <math.h>

#include "foilgauge/foil.h"
#include "foilgauge/quantity.h"
#include "support/random.h"
#include "support/test.h"

typedef struct derive_case {
  fg_design design;
  fg_nominal nominal;
  fg_overall overall;
  fg_thickness strip;
  fg_bump bump;
} derive_case;

/* A Gen II bump seen in a direction that is no axis. */
static derive_case make_case(double radius, double x, double overall_radius) {
  derive_case c = {0};
  fg_design_default(&c.design);
  assert_ok(&test_context, fg_design_derive(&test_context, &c.design, &c.nominal));
  c.strip.mm = c.design.thickness_mm;
  c.overall.centre_mm = (fg_point){30, 20};
  c.overall.radius_mm = overall_radius;
  c.bump.centre_mm = (fg_point){30 + x * cos(0.7), 20 + x * sin(0.7)};
  c.bump.radius_mm = radius;
  return c;
}

static void derive(derive_case *c) {
  fg_bump_derive(&c->design, &c->nominal, &c->overall, &c->strip, &c->bump);
}

static void design_bump_has_no_error(void **state) {
  (void)state;
  derive_case c = make_case(3.32, 23.48547331077125, 20.73);
  derive(&c);
  assert_near(c.bump.centre_to_centre_mm, c.nominal.centre_to_centre_mm, 1e-13);
  assert_near(c.bump.bump_angle_deg, 63.15, 1e-10);
  assert_near(c.bump.intersection_angle_deg, c.nominal.intersection_angle_deg, 1e-10);
  assert_near(c.bump.height_mm, c.nominal.height_mm, 1e-13);
  assert_near(c.bump.clearance_mm, c.nominal.clearance_mm, 1e-13);
  assert_near(c.bump.clearance_error, 0, 1e-11);
  assert_near(c.bump.radius_error_pct, 0, 1e-12);
  assert_near(c.bump.bump_angle_error_pct, 0, 1e-10);
  assert_near(c.bump.intersection_angle_error_pct, 0, 1e-10);
  assert_near(c.bump.height_model_mm, c.nominal.height_mm, 1e-13);
  assert_near(c.bump.bump_angle_model_deg, 63.15, 1e-12);
  assert_near(c.bump.position_deg, 0.7 * 180 / 3.14159265358979323846, 1e-11);
}

/* Signs and factors of the errors, from another bump than the design's. */
static void errors_have_the_signs_of_the_thesis(void **state) {
  (void)state;
  derive_case c = make_case(3.32 * 1.1, 23.8, 20.73);
  derive(&c);
  double height = 20.73 - (23.8 - 3.652), clearance = 20.73 - height - 20 - 0.1;
  assert_near(c.bump.radius_error_pct, 10, 1e-11);
  assert_near(c.bump.height_mm, height, 1e-13);
  assert_near(c.bump.clearance_mm, clearance, 1e-13);
  assert_near(c.bump.clearance_error, (c.nominal.clearance_mm - clearance) / c.nominal.clearance_mm,
              1e-12);
  assert_near(c.bump.bump_angle_error_pct, 100 * (c.bump.bump_angle_deg / 63.15 - 1), 1e-12);
  assert_near(c.bump.intersection_angle_error_pct,
              100 * (c.bump.intersection_angle_deg / c.nominal.intersection_angle_deg - 1), 1e-12);
  assert_near(c.bump.bump_angle_model_deg, 63.15 / 1.1, 1e-11);
}

/* A covariance with a correlation of R and crown of -0.999, as an arc of 63 degrees has it. */
static void make_covariance(double covariance[3][3], double direction_rad, double u_radius,
                            double u_crown, double u_across) {
  double u[2] = {cos(direction_rad), sin(direction_rad)};
  /* The crown's distance from O is centre·u - R; centre·u = R + crown. */
  double along = u_radius * u_radius + u_crown * u_crown, across = u_across * u_across;
  for (int i = 0; i < 2; i++) {
    for (int j = 0; j < 2; j++)
      covariance[i][j] = along * u[i] * u[j] + across * ((i == j) - u[i] * u[j]);
    covariance[i][2] = covariance[2][i] = u_radius * u_radius * u[i];
  }
  covariance[2][2] = u_radius * u_radius;
}

/* Draws from such a covariance. */
static void disturb(fg_point *centre, double *radius, double direction_rad, double u_radius,
                    double u_crown, double u_across, uint64_t *seed) {
  double by_radius = u_radius * random_gaussian(seed), by_crown = u_crown * random_gaussian(seed);
  double across = u_across * random_gaussian(seed), along = by_radius + by_crown;
  centre->x += along * cos(direction_rad) - across * sin(direction_rad);
  centre->y += along * sin(direction_rad) + across * cos(direction_rad);
  *radius += by_radius;
}

enum { TRIALS = 40000, QUANTITIES_MAX = 40 };

/* Every row of a bump that is one number with an uncertainty. Returns their number. */
static size_t list_quantities(const fg_quantity *list[QUANTITIES_MAX]) {
  size_t count, used = 0;
  const fg_quantity *rows = fg_quantities(FG_QUANTITY_OF_BUMP, &count);
  for (size_t i = 0; i < count; i++) {
    if (rows[i].kind != FG_QUANTITY_NUMBER || rows[i].u_offset == FG_NO_UNCERTAINTY) continue;
    assert_true(used < QUANTITIES_MAX);
    list[used++] = &rows[i];
  }
  return used;
}

static void uncertainties_are_those_of_draws(void **state) {
  (void)state;
  uint64_t seed = 11;
  derive_case c = make_case(3.39, 23.79, 20.95);
  make_covariance(c.bump.covariance, 0.7, 4e-3, 0.1e-3, 0.5e-3);
  make_covariance(c.overall.covariance, 1.9, 2e-3, 0.2e-3, 1e-3);
  derive(&c);
  const fg_quantity *list[QUANTITIES_MAX];
  double sum[QUANTITIES_MAX] = {0}, square[QUANTITIES_MAX] = {0};
  size_t count = list_quantities(list);
  for (int trial = 0; trial < TRIALS; trial++) {
    derive_case d = c;
    disturb(&d.bump.centre_mm, &d.bump.radius_mm, 0.7, 4e-3, 0.1e-3, 0.5e-3, &seed);
    disturb(&d.overall.centre_mm, &d.overall.radius_mm, 1.9, 2e-3, 0.2e-3, 1e-3, &seed);
    derive(&d);
    for (size_t i = 0; i < count; i++) {
      double moved = fg_quantity_value(list[i], &d.bump) - fg_quantity_value(list[i], &c.bump);
      sum[i] += moved / TRIALS;
      square[i] += moved * moved / TRIALS;
    }
  }
  /* A standard deviation from 40000 draws is worth 0.35 %. */
  for (size_t i = 0; i < count; i++) {
    double sd = sqrt(square[i] - sum[i] * sum[i]);
    double u = fg_quantity_uncertainty(list[i], &c.bump);
    if (!(fabs(u / sd - 1) < 0.02))
      fail_msg("%s: u %g, draws %g: its gradient in src/geometry/derive.c", list[i]->name, u, sd);
  }
}

/* The crown is known to 0.1 nm while R is worth 4 µm: h must keep what the crown is worth. */
static void height_keeps_the_crown_s_uncertainty(void **state) {
  (void)state;
  derive_case c = make_case(3.39, 23.79, 20.95);
  make_covariance(c.bump.covariance, 0.7, 4e-3, 1e-7, 0);
  derive(&c);
  assert_near(c.bump.u_height_mm, 1e-7, 2e-9);
  assert_near(c.bump.u_clearance_mm, 1e-7, 2e-9);
  assert_near(c.bump.u_radius_mm, 4e-3, 1e-15);
}

/* A bump of the design's radius and angle on a foil that has opened: pressed into the sleeve the
 * circle under its chord is the sleeve's, and the crown stands where the design has it. Free it
 * stands lower by what the flatter circle lacks under the chord. */
static void a_foil_that_has_opened_stands_higher_in_the_sleeve(void **state) {
  (void)state;
  const double half = 63.15 / 2 * 3.14159265358979323846 / 180, chord = 3.32 * sin(half);
  const struct { double overall_mm, lift_um; } rows[] = {{20.73, 0}, {20.98, 0.87}, {23.56, 8.79}};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    in_row("rows[%zu]", i);
    double r0 = rows[i].overall_mm;
    derive_case c = make_case(3.32, 3.32 * cos(half) + sqrt(r0 * r0 - chord * chord), r0);
    derive(&c);
    assert_near(c.bump.height_fitted_mm, c.nominal.height_mm, 1e-12);
    assert_near(c.bump.clearance_fitted_mm, c.nominal.clearance_mm, 1e-12);
    assert_near(1000 * (c.bump.height_fitted_mm - c.bump.height_mm), rows[i].lift_um, 0.01);
  }
}

/* Whatever X, R and R0 are: eq 5.6 with the angle that they define is R0, so a height from it and
 * measured values would say nothing about the part. */
static void eq_5_6_of_measured_values_is_the_overall_radius(void **state) {
  (void)state;
  uint64_t seed = 5;
  for (int i = 0; i < 100; i++) {
    derive_case c = make_case(3.3 + 0.1 * random_uniform(&seed), 23.7 + 0.3 * random_uniform(&seed),
                              20.7 + 0.5 * random_uniform(&seed));
    derive(&c);
    double x = c.bump.centre_to_centre_mm, r = c.bump.radius_mm;
    double phi = c.bump.bump_angle_deg * 3.14159265358979323846 / 360;
    assert_near(sqrt(x * x + r * r - 2 * x * r * cos(phi)), c.overall.radius_mm, 1e-11);
  }
}

static double fitted_at(double radius, double x, double overall) {
  derive_case c = make_case(radius, x, overall);
  derive(&c);
  return c.bump.height_fitted_mm;
}

/* u_height_fitted_mm is |gradient| u along each of X, R and R0 alone: central differences. */
static void the_fitted_height_s_gradient_is_a_difference_quotient(void **state) {
  (void)state;
  const double radius = 3.41, x = 23.83, overall = 21.3, step = 1e-5, u = 1e-3;
  const double slope[3] = {
      (fitted_at(radius, x + step, overall) - fitted_at(radius, x - step, overall)) / (2 * step),
      (fitted_at(radius + step, x, overall) - fitted_at(radius - step, x, overall)) / (2 * step),
      (fitted_at(radius, x, overall + step) - fitted_at(radius, x, overall - step)) / (2 * step)};
  for (int i = 0; i < 3; i++) {
    derive_case c = make_case(radius, x, overall);
    derive(&c);
    double covariance[3][3] = {{0}};
    covariance[i][i] = u * u;
    fg_bump_widen(&c.design, &c.nominal, &c.overall, covariance, &c.bump);
    assert_near(c.bump.u_height_fitted_mm, fabs(slope[i]) * u, 1e-7 * u);
    assert_near(c.bump.u_clearance_fitted_mm, fabs(slope[i]) * u, 1e-7 * u);
  }
}

/* A strip of 0.105 mm where the design says 0.1: eq 5.8 holds with the strip's own thickness, and
 * its uncertainty is in both clearances, in their error, and in nothing else. */
static void clearance_is_over_the_strip_as_it_is(void **state) {
  (void)state;
  derive_case thin = make_case(3.32, 23.48547331077125, 20.73);
  derive_case thick = thin;
  derive(&thin);
  thick.strip = (fg_thickness){.mm = 0.105, .u_mm = 0.0003};
  derive(&thick);
  assert_near(1000 * thin.bump.clearance_mm, 65.473, 0.001);
  assert_near(1000 * thick.bump.clearance_mm, 60.473, 0.001);
  assert_near(thick.bump.clearance_fitted_mm, thin.bump.clearance_fitted_mm - 0.005, 1e-12);
  assert_near(thick.bump.clearance_error, 0.005 / thin.nominal.clearance_mm, 1e-11);
  assert_near(thick.bump.u_clearance_mm, 0.0003, 1e-12);
  assert_near(thick.bump.u_clearance_fitted_mm, 0.0003, 1e-12);
  assert_near(thick.bump.u_clearance_error, 0.0003 / thin.nominal.clearance_mm, 1e-12);
  assert_near(thick.bump.u_height_mm, 0, 0);
  assert_near(thick.bump.height_fitted_mm, thin.bump.height_fitted_mm, 0);
}

static void a_thickness_that_was_not_measured_is_the_design_s(void **state) {
  (void)state;
  fg_design design;
  fg_design_default(&design);
  fg_foil foil = {.thickness = {.mm = NAN, .u_mm = NAN}};
  fg_thickness strip = fg_foil_thickness(&design, &foil);
  assert_near(strip.mm, 0.1, 0);
  assert_near(strip.u_mm, 0, 0);
  assert_false(fg_thickness_differs(&design, &strip));
  foil = (fg_foil){.thickness = {.mm = 0.105, .u_mm = 0.0024}};
  strip = fg_foil_thickness(&design, &foil);
  assert_true(fg_thickness_differs(&design, &strip));
  strip.u_mm = 0.0026;
  assert_false(fg_thickness_differs(&design, &strip));
}

/* One foil by its midline, inner and outer edge: same X, h and clearance. Towards the shaft the
 * overall circle shrinks and the bump's, whose centre lies outside, grows. */
static void height_does_not_depend_on_the_datum(void **state) {
  (void)state;
  const double offsets[] = {0, -0.05, 0.05};
  derive_case mid = make_case(3.39, 23.79, 20.95);
  derive(&mid);
  for (int i = 0; i < 3; i++) {
    derive_case c = make_case(3.39 - offsets[i], 23.79, 20.95 + offsets[i]);
    derive(&c);
    assert_near(c.bump.height_mm, mid.bump.height_mm, 1e-13);
    assert_near(c.bump.clearance_mm, mid.bump.clearance_mm, 1e-13);
  }
}

static void circles_that_do_not_cross_have_no_angle(void **state) {
  (void)state;
  const double distances[] = {24.5, 17.3};
  for (int i = 0; i < 2; i++) {
    derive_case c = make_case(3.39, distances[i], 20.95);
    derive(&c);
    assert_true(c.bump.flags & FG_BUMP_NO_CROSSING);
    assert_true(isnan(c.bump.bump_angle_deg) && isnan(c.bump.u_bump_angle_deg));
    assert_true(isnan(c.bump.intersection_angle_deg) && isnan(c.bump.bump_angle_error_pct));
    assert_true(isnan(c.bump.height_fitted_mm) && isnan(c.bump.u_clearance_fitted_mm));
    assert_near(c.bump.height_mm, 20.95 - (distances[i] - 3.39), 1e-13);
    assert_true(isfinite(c.bump.bump_angle_model_deg) && isfinite(c.bump.height_model_mm));
  }
  derive_case c = make_case(3.39, 23.79, 20.95);
  c.bump.flags = FG_BUMP_NO_CROSSING | FG_BUMP_POOR_FIT;
  derive(&c);
  assert_int_equal(c.bump.flags, FG_BUMP_POOR_FIT);
}

static void unfitted_values_stay_unknown(void **state) {
  (void)state;
  derive_case c = make_case(NAN, 23.79, 20.95);
  c.bump.flags = FG_BUMP_NOT_FITTED;
  derive(&c);
  assert_int_equal(c.bump.flags, FG_BUMP_NOT_FITTED);
  assert_true(isnan(c.bump.height_mm) && isnan(c.bump.bump_angle_deg));
  assert_true(isnan(c.bump.radius_error_pct) && isnan(c.bump.height_model_mm));

  c = make_case(3.39, 23.79, 20.95);
  for (int i = 0; i < 9; i++)
    c.overall.covariance[i / 3][i % 3] = NAN;
  derive(&c);
  assert_true(isnan(c.bump.u_height_mm) && isfinite(c.bump.height_mm));
  assert_true(isfinite(c.bump.u_radius_error_pct) && isfinite(c.bump.u_height_model_mm));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(design_bump_has_no_error),
      cmocka_unit_test(errors_have_the_signs_of_the_thesis),
      cmocka_unit_test(uncertainties_are_those_of_draws),
      cmocka_unit_test(height_keeps_the_crown_s_uncertainty),
      cmocka_unit_test(a_foil_that_has_opened_stands_higher_in_the_sleeve),
      cmocka_unit_test(eq_5_6_of_measured_values_is_the_overall_radius),
      cmocka_unit_test(the_fitted_height_s_gradient_is_a_difference_quotient),
      cmocka_unit_test(clearance_is_over_the_strip_as_it_is),
      cmocka_unit_test(a_thickness_that_was_not_measured_is_the_design_s),
      cmocka_unit_test(height_does_not_depend_on_the_datum),
      cmocka_unit_test(circles_that_do_not_cross_have_no_angle),
      cmocka_unit_test(unfitted_values_stay_unknown),
  };
  return cmocka_run_group_tests_name("derive", tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Causes of a lot's spread of stiffness: causes put in come back out, an unknown one is not
 * counted, and measurement's share is that of drawn circles. */
#include "lot/statistics/budget.h"
#include "report/lot/files.h"
#include "support/made_lot.h"
#include "support/test.h"

enum { FOILS = 12, BUMPS = 8 };

static const double pi = 3.14159265358979323846;

typedef struct causes {
  double radius, arc_length, thickness; /* relative: half the width between two levels */
} causes;

/* Two levels of each, crossed over bumps (radius, arc length) and foils (thickness): sd is the half
 * width, and nothing is correlated. */
static fg_lot caused_lot(const fg_design *design, const causes *by) {
  fg_lot lot = made_lot(design, FOILS, BUMPS, "", NULL);
  for (size_t i = 0; i < FOILS; i++) {
    lot.records[i].foils[0].thickness.mm = 0.1 * (1 + (i % 2 ? by->thickness : -by->thickness));
    for (size_t k = 0; k < BUMPS; k++) {
      double radius = 3.4 * (1 + (k % 2 ? by->radius : -by->radius));
      double length = 3.32 * 63.15 * (1 + (k / 2 % 2 ? by->arc_length : -by->arc_length));
      made_bump(&lot, i, k, radius, length / radius);
    }
  }
  return lot;
}

static void made_causes_are_found_with_their_sizes(void **state) {
  (void)state;
  const causes all[] = {
      {0.02, 1e-5, 1e-6}, {1e-5, 0.01, 1e-6}, {1e-5, 1e-5, 0.01}, {0.02, 0.01, 0.005}};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    in_row("all[%zu]", i);
    fg_design design;
    fg_lot_analysis analysis;
    fg_design_default(&design);
    fg_lot lot = caused_lot(&design, &all[i]);
    assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
    const fg_lot_budget *budget = &analysis.stiffness.budget;
    assert_true(budget->known);
    double n = BUMPS * FOILS, bessel = sqrt(n / (n - 1));
    assert_near(budget->radius.spread_pct, 100 * bessel * all[i].radius, 1e-6);
    assert_near(budget->arc_length.spread_pct, 100 * bessel * all[i].arc_length, 1e-6);
    assert_near(budget->thickness.spread_pct, 100 * bessel * all[i].thickness, 1e-6);
    assert_near(budget->correlation, 0, 1e-6);
    assert_near(budget->thickness.sensitivity, 3, 0.01);
    assert_near(sqrt(budget->sum_pct2) / budget->observed_pct, 1, 3e-3);
    assert_near(budget->sum_pct2 + budget->unexplained_pct2, pow(budget->observed_pct, 2), 1e-9);
    fg_lot_analysis_free(&analysis);
    made_lot_free(&lot);
  }
}

static void assert_shares_are_the_whole(const fg_lot_budget *budget) {
  const double share[] = {budget->radius.share_pct, budget->arc_length.share_pct,
                          isnan(budget->thickness.share_pct) ? 0 : budget->thickness.share_pct,
                          budget->rest_share_pct};
  double sum = 0;
  for (int i = 0; i < 4; i++) {
    assert_true(share[i] >= 0 && share[i] <= 100);
    sum += share[i];
  }
  assert_near(sum, 100, 1e-9);
}

/* Arc length that goes with the radius: the causes' own variances add up to far more than is
 * observed. */
static void shares_of_causes_that_go_together_are_the_whole(void **state) {
  (void)state;
  static const double together[] = {-0.9, 0, 0.5, 1};
  for (int c = 0; c < 4; c++) {
    fg_design design;
    fg_lot_analysis analysis;
    fg_design_default(&design);
    fg_lot lot = made_lot(&design, FOILS, BUMPS, "", NULL);
    for (size_t i = 0; i < FOILS; i++)
      for (size_t k = 0; k < BUMPS; k++) {
        double radius = 3.4 * (1 + 0.012 * ((double)((5 * i + 3 * k) % 11) - 5));
        double length =
            3.32 * 63.15 *
            (1 + together[c] * (radius / 3.4 - 1) + 0.004 * ((double)((3 * i + 7 * k) % 5) - 2));
        made_bump(&lot, i, k, radius, length / radius);
      }
    assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
    assert_true(analysis.stiffness.budget.known);
    assert_shares_are_the_whole(&analysis.stiffness.budget);
    fg_lot_analysis_free(&analysis);
    made_lot_free(&lot);
  }
}

static char *text_of(const fg_lot_analysis *analysis, fg_lot_writer *writer) {
  char *text;
  size_t size;
  FILE *out = open_memstream(&text, &size);
  assert_ok(NULL, writer(NULL, analysis, out));
  fclose(out);
  return text;
}

/* One foil, or foils whose thickness was not measured: its spread is unknown, not none. */
static void thickness_that_is_not_known_is_not_zero(void **state) {
  (void)state;
  for (int one = 0; one < 2; one++) {
    fg_design design;
    fg_lot_analysis analysis;
    fg_design_default(&design);
    const causes by = {0.02, 0.01, 0};
    fg_lot lot = caused_lot(&design, &by);
    for (size_t i = 0; i < FOILS; i++)
      if (!one || i) lot.records[i].foils[0].thickness.mm = NAN;
    if (one) lot.manifest.items = 1;
    assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
    const fg_lot_budget *budget = &analysis.stiffness.budget;
    assert_true(budget->known && isnan(budget->thickness.spread_pct));
    assert_near(sqrt(budget->sum_pct2) / budget->observed_pct, 1, 3e-3);
    char *page = text_of(&analysis, fg_lot_write_page),
         *json = text_of(&analysis, fg_lot_write_json);
    assert_has(page, one ? "it was measured on one foil only" : "it was measured on no foil");
    assert_has(json, "\"thickness\": {\"relative_sd_pct\": null");
    free(page);
    free(json);
    fg_lot_analysis_free(&analysis);
    lot.manifest.items = FOILS;
    made_lot_free(&lot);
  }
}

/* A single bump has a stiffness by every model, and no spread. */
static void one_bump_has_no_spread(void **state) {
  (void)state;
  fg_design design;
  fg_lot_analysis analysis;
  fg_design_default(&design);
  fg_lot lot = made_lot(&design, 1, 1, "", NULL);
  made_bump(&lot, 0, 0, 3.4, 61);
  assert_ok(&test_context, fg_lot_analyse(&test_context, &lot, &analysis));
  assert_false(analysis.has_stiffness || analysis.stiffness.budget.known);
  char *page = text_of(&analysis, fg_lot_write_page), *json = text_of(&analysis, fg_lot_write_json);
  assert_has(page, "How stiffness varies is not known");
  assert_has(page, "as designed");
  assert_has_not(page, ">the lot's mean<");
  assert_has(json, "\"id\": \"link_spring\"");
  assert_has_not(json, "\"budget\"");
  free(page);
  free(json);
  fg_lot_analysis_free(&analysis);
  made_lot_free(&lot);
}

/* Circles drawn around a bump whose crown is known better than its radius, against the variance
 * that is worked out from the uncertainties alone. */
static void measurement_variance_agrees_with_drawn_circles(void **state) {
  (void)state;
  enum { DRAWS = 400 };
  const double u_radius = 4e-3, u_crown = 0.3e-3;
  fg_design design;
  fg_design_default(&design);
  fg_lot lot = made_lot(&design, 1, DRAWS + 1, "", NULL);
  fg_foil *foil = &lot.records[0].foils[0];
  made_bump(&lot, 0, 0, 3.4, 61);
  fg_bump *bump = &foil->bumps[0];
  const fg_arch_material material = fg_arch_material_default();
  const fg_arch arch = {bump->radius_mm, bump->bump_angle_deg, 0.1};
  fg_arch_sensitivity slope;
  fg_context ctx;
  assert_ok(&ctx, fg_arch_sensitivities(&ctx, &arch, &material, &slope));
  double sum = 0, squares = 0, angles = 0, angle_squares = 0;
  for (int i = 1; i <= DRAWS; i++) {
    /* Two waves over the draws: each of sd 1, uncorrelated. */
    double a = sqrt(2) * sin(2 * pi * i / DRAWS), b = sqrt(2) * cos(6 * pi * i / DRAWS);
    fg_bump *drawn = &foil->bumps[i];
    *drawn = *bump;
    drawn->radius_mm += u_radius * a;
    drawn->centre_mm.x += u_radius * a + u_crown * b;
    const fg_thickness strip = fg_foil_thickness(&design, foil);
    fg_bump_derive(&design, &lot.nominal, &foil->overall, &strip, drawn);
    fg_arch_stiffness k;
    const fg_arch moved = {drawn->radius_mm, drawn->bump_angle_deg, 0.1};
    assert_ok(&ctx, fg_arch_free(&ctx, &moved, &material, &k));
    double ln = log(k.stiffness_n_mm2), angle = drawn->bump_angle_deg - bump->bump_angle_deg;
    sum += ln / DRAWS;
    squares += ln * ln / DRAWS;
    angles += angle / DRAWS;
    angle_squares += angle * angle / DRAWS;
  }
  bump->u_radius_mm = u_radius;
  bump->u_centre_to_centre_mm = hypot(u_radius, u_crown);
  bump->u_height_mm = u_crown;
  bump->u_bump_angle_deg = sqrt(angle_squares - angles * angles);
  double variance = fg_bump_stiffness_variance(&foil->overall, bump, &slope);
  assert_near(sqrt(variance / (squares - sum * sum)), 1, 0.02);
  /* Taken apart, the two would make several times that. */
  double apart = pow(slope.radius * u_radius / bump->radius_mm, 2) +
                 pow(slope.angle * bump->u_bump_angle_deg / bump->bump_angle_deg, 2);
  assert_true(apart > 4 * variance);
  bump->u_radius_mm = NAN;
  assert_true(isnan(fg_bump_stiffness_variance(&foil->overall, bump, &slope)));
  made_lot_free(&lot);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(made_causes_are_found_with_their_sizes),
      cmocka_unit_test(shares_of_causes_that_go_together_are_the_whole),
      cmocka_unit_test(thickness_that_is_not_known_is_not_zero),
      cmocka_unit_test(one_bump_has_no_spread),
      cmocka_unit_test(measurement_variance_agrees_with_drawn_circles),
  };
  return cmocka_run_group_tests_name("budget of stiffness", tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clearances around a bearing, their uncertainty, and their verdicts by tolerances. */
#include <string.h>

#include "foilgauge/report.h"
#include "support/random.h"
#include "support/test.h"

enum { PADS = 3, BUMPS = 9, PLACES = PADS * BUMPS };

static const double pi = 3.14159265358979323846;

/* Thesis section 6.2: bores of 39.50, 39.44 and 39.29 mm, measured 60 degrees apart, against a
 * rotor of 39.37 mm. Each diameter ends on two crowns. */
static void bores_of_the_thesis(void **state) {
  (void)state;
  static const double bore_mm[] = {39.50, 39.44, 39.29}, wanted_um[] = {65, 35, -40};
  fg_context ctx;
  fg_design design;
  double angle[6], clearance[6];
  fg_design_default(&design);
  design.bumps.rotor_diameter_mm = 39.37;
  for (size_t i = 0; i < 6; i++) {
    double height = design.bumps.sleeve_radius_mm - design.thickness_mm - bore_mm[i % 3] / 2;
    angle[i] = 60 * (double)i;
    clearance[i] = fg_design_clearance(&design, height);
    assert_near(1000 * clearance[i], wanted_um[i % 3], 1e-9);
  }
  fg_bearing_clearance result;
  assert_ok(&ctx, fg_bearing_assess(&ctx, angle, clearance, 6, &result));
  assert_near(result.min_mm, -0.040, 1e-12);
  assert_near(result.max_mm, 0.065, 1e-12);
  assert_near(result.min_at_deg, 120, 1e-12);
  assert_near(result.circularity_mm, 0.105, 1e-12);
  assert_near(result.centred_min_mm, -0.040, 1e-12); /* opposite crowns: no place is better */
}

static void angles(double angle[PLACES]) {
  const fg_bearing_layout layout = {PADS, BUMPS, 1, 40.0 / 3};
  for (size_t i = 0; i < PLACES; i++)
    angle[i] = fg_bearing_angle_deg(&layout, i / BUMPS, i % BUMPS);
}

/* By Cramer's rule: (m, a, b) that touches three crowns alike. */
static bool touch(const double *c, const double *x, const double *y, size_t i, size_t j, size_t k,
                  double rotor[3]) {
  double dx1 = x[j] - x[i], dy1 = y[j] - y[i], dx2 = x[k] - x[i], dy2 = y[k] - y[i];
  double determinant = dx1 * dy2 - dx2 * dy1;
  if (fabs(determinant) < 1e-9) return false;
  rotor[1] = ((c[j] - c[i]) * dy2 - (c[k] - c[i]) * dy1) / determinant;
  rotor[2] = (dx1 * (c[k] - c[i]) - dx2 * (c[j] - c[i])) / determinant;
  rotor[0] = c[i] - rotor[1] * x[i] - rotor[2] * y[i];
  return true;
}

static double best_of_all_triples(const double *angle, const double *c, size_t count) {
  double x[PLACES], y[PLACES], best = -INFINITY, rotor[3];
  for (size_t i = 0; i < count; i++) {
    x[i] = cos(angle[i] * pi / 180);
    y[i] = sin(angle[i] * pi / 180);
  }
  for (size_t i = 0; i < count; i++)
    for (size_t j = i + 1; j < count; j++)
      for (size_t k = j + 1; k < count; k++) {
        if (!touch(c, x, y, i, j, k, rotor)) continue;
        double min = INFINITY;
        for (size_t n = 0; n < count; n++)
          min = fmin(min, c[n] - rotor[1] * x[n] - rotor[2] * y[n]);
        best = fmax(best, min);
      }
  return best;
}

/* The exchange of touched crowns ends where the best of all triples lies; equal clearances, where
 * many rotors are as good, too. */
static void centred_is_the_best_of_all(void **state) {
  (void)state;
  fg_context ctx;
  double angle[PLACES], clearance[PLACES];
  uint64_t seed = 7;
  angles(angle);
  for (int trial = 0; trial < 60; trial++) {
    size_t count = trial % 3 ? PLACES : 20;
    for (size_t i = 0; i < PLACES; i++) {
      double drawn = random_uniform(&seed);
      clearance[i] = 0.065 + 0.04 * (trial % 4 == 3 ? round(3 * drawn) / 3 : drawn);
    }
    fg_bearing_clearance result;
    assert_ok(&ctx, fg_bearing_assess(&ctx, angle, clearance, count, &result));
    assert_near(result.centred_min_mm, best_of_all_triples(angle, clearance, count), 1e-11);
    assert_true(result.centred_min_mm >= result.min_mm - 1e-12);
  }
}

typedef double pick(const fg_bearing_clearance *result);
static double circularity(const fg_bearing_clearance *result) {
  return result->circularity_mm;
}
static double centred(const fg_bearing_clearance *result) {
  return result->centred_min_mm;
}
static double min(const fg_bearing_clearance *result) {
  return result->min_mm;
}
static double mean(const fg_bearing_clearance *result) {
  return result->mean_mm;
}

/* d result / d clearance by a difference so small that no other place takes over. */
static double slope(const double *angle, const double *clearance, size_t at, pick *of) {
  static const double step = 1e-9;
  double moved[PLACES], value[2];
  fg_context ctx;
  for (int side = 0; side < 2; side++) {
    fg_bearing_clearance result;
    memcpy(moved, clearance, sizeof moved);
    moved[at] += side ? step : -step;
    assert_ok(&ctx, fg_bearing_assess(&ctx, angle, moved, PLACES, &result));
    value[side] = of(&result);
  }
  return (value[1] - value[0]) / (2 * step);
}

static double expected_u(const double *angle, const double *clearance, const double *shared,
                         const double *own, pick *of) {
  double together = 0, apart = 0, all = 0;
  for (size_t pad = 0; pad < PADS; pad++) {
    double sum = 0;
    for (size_t i = pad * BUMPS; i < (pad + 1) * BUMPS; i++) {
      double g = slope(angle, clearance, i, of);
      all += g * shared[i];
      sum += g * own[i];
      apart += pow(g * own[i], 2);
    }
    together += sum * sum;
  }
  return sqrt(all * all + fmax(apart, together));
}

static void uncertainties_are_propagated(void **state) {
  (void)state;
  fg_context ctx;
  double angle[PLACES], clearance[PLACES], shared[PLACES], own[PLACES];
  size_t pad[PLACES];
  uint64_t seed = 11;
  angles(angle);
  for (int trial = 0; trial < 5; trial++) {
    for (size_t i = 0; i < PLACES; i++) {
      clearance[i] = 0.065 + 0.04 * random_uniform(&seed);
      shared[i] = 1e-3;
      own[i] = 1e-3 * (0.5 + random_uniform(&seed));
      pad[i] = i / BUMPS;
    }
    const fg_bearing_uncertainty uncertainty = {shared, own, pad};
    fg_bearing_clearance r;
    assert_ok(&ctx,
              fg_bearing_assess_uncertainty(&ctx, angle, clearance, PLACES, &uncertainty, &r));
    assert_near(r.u_min_mm, expected_u(angle, clearance, shared, own, min), 1e-8);
    assert_near(r.u_mean_mm, expected_u(angle, clearance, shared, own, mean), 1e-8);
    assert_near(r.u_circularity_mm, expected_u(angle, clearance, shared, own, circularity), 1e-8);
    assert_near(r.u_centred_min_mm, expected_u(angle, clearance, shared, own, centred), 1e-8);
    assert_true(r.u_min_mm > 1e-3); /* the shared part is in it */
  }
  /* An error that all places share moves no circularity, and every clearance by all of it. */
  memset(own, 0, sizeof own);
  const fg_bearing_uncertainty uncertainty = {shared, own, pad};
  fg_bearing_clearance r;
  assert_ok(&ctx, fg_bearing_assess_uncertainty(&ctx, angle, clearance, PLACES, &uncertainty, &r));
  assert_near(r.u_circularity_mm, 0, 1e-12);
  assert_near(r.u_centred_min_mm, 1e-3, 1e-12);
  assert_ok(&ctx, fg_bearing_assess(&ctx, angle, clearance, PLACES, &r));
  assert_true(isnan(r.u_min_mm) && isnan(r.u_circularity_mm));
}

static fg_verdict decide(const char *quantity, double lower, double upper,
                         const fg_bearing_clearance *clearance, bool whole, int code) {
  fg_context ctx;
  fg_design design;
  fg_decision decision;
  fg_design_default(&design);
  design.tolerance_count = 1;
  strcpy(design.calibration.not_needed, "the foils are made up");
  design.tolerances[0] = (fg_tolerance){.lower = lower, .upper = upper};
  strcpy(design.tolerances[0].quantity, quantity);
  assert_ok(&ctx, fg_report_check_tolerances(&ctx, &design));
  assert_ok(&ctx, fg_bearing_decide(&ctx, &design, clearance, whole, &decision));
  assert_int_equal(decision.count, 1);
  assert_int_equal(fg_outcome_exit_code(&decision.outcome), code);
  fg_verdict verdict = decision.outcome.verdict;
  fg_decision_free(&decision);
  return verdict;
}

static void tolerances_judge_with_uncertainty(void **state) {
  (void)state;
  const fg_bearing_clearance c = {.circularity_mm = 0.050,
                                  .u_circularity_mm = 0.001,
                                  .min_mm = 0.010,
                                  .u_min_mm = 0.002,
                                  .centred_min_mm = 0.020,
                                  .u_centred_min_mm = NAN};
  double no = INFINITY;
  assert_int_equal(decide("circularity_mm", -no, 0.060, &c, true, 0), FG_VERDICT_PASS);
  assert_int_equal(decide("circularity_mm", -no, 0.0515, &c, true, 3), FG_VERDICT_UNDECIDED);
  assert_int_equal(decide("circularity_mm", -no, 0.047, &c, true, 1), FG_VERDICT_FAIL);
  assert_int_equal(decide("clearance_min_mm", 0, no, &c, true, 0), FG_VERDICT_PASS);
  assert_int_equal(decide("clearance_min_mm", 0.008, no, &c, true, 3), FG_VERDICT_UNDECIDED);
  assert_int_equal(decide("clearance_centred_min_mm", 0.0199, no, &c, true, 0), FG_VERDICT_PASS);
  assert_int_equal(decide("clearance_centred_min_mm", 0.0201, no, &c, true, 1), FG_VERDICT_FAIL);
  /* A place without a clearance: the least is this or less. */
  assert_int_equal(decide("clearance_min_mm", 0.015, no, &c, false, 1), FG_VERDICT_FAIL);
  assert_int_equal(decide("clearance_min_mm", 0, no, &c, false, 2), FG_VERDICT_NOT_MEASURED);
  assert_int_equal(decide("circularity_mm", -no, 0.010, &c, false, 2), FG_VERDICT_NOT_MEASURED);
  assert_int_equal(decide("circularity_mm", -no, 0.060, NULL, false, 2), FG_VERDICT_NOT_MEASURED);
}

/* The names that a design may use are refused for nothing else, and listed where one is wrong. */
static void names_are_known(void **state) {
  (void)state;
  fg_context ctx;
  fg_design design;
  char names[200];
  fg_design_default(&design);
  assert_int_equal(fg_report_of_bearing(&design, names, sizeof names), 0);
  design.tolerance_count = 2;
  design.tolerances[0] = (fg_tolerance){.quantity = "height_mm"};
  design.tolerances[1] = (fg_tolerance){.quantity = "clearance_min_mm"};
  assert_int_equal(fg_report_of_bearing(&design, names, sizeof names), 1);
  assert_string_equal(names, "clearance_min_mm");
  assert_ok(&ctx, fg_report_check_tolerances(&ctx, &design));
  strcpy(design.tolerances[1].quantity, "min_mm");
  assert_status(&ctx, fg_report_check_tolerances(&ctx, &design), FG_ERR_DATA);
  assert_has(ctx.message, "clearance_centred_min_mm");
  assert_int_equal(fg_design_become(NULL, FG_FOIL_DISCS, &design), FG_OK);
  strcpy(design.tolerances[0].quantity, "circularity_mm");
  assert_status(&ctx, fg_report_check_tolerances(&ctx, &design), FG_ERR_DATA);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bores_of_the_thesis),
      cmocka_unit_test(centred_is_the_best_of_all),
      cmocka_unit_test(uncertainties_are_propagated),
      cmocka_unit_test(tolerances_judge_with_uncertainty),
      cmocka_unit_test(names_are_known),
  };
  return cmocka_run_group_tests_name("bearing", tests, NULL, NULL);
}

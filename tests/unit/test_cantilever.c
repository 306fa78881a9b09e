/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities that follow from a beam's length and width, against the thesis, against drawn beams
 * and in the cases where nothing can be said. */
#include <math.h>

#include "foilgauge/cantilever.h"
#include "support/random.h"
#include "support/test.h"

static fg_design design_of_thesis(void) {
  return (fg_design){.kind = FG_FOIL_CANTILEVER,
                     .beams.count = 8,
                     .beams.length_mm = 9,
                     .beams.width_mm = 3,
                     .thickness_mm = 0.1,
                     .beams.sagitta_mm = 1,
                     .beams.clearance_mm = 0.126,
                     .beams.elastic_modulus_gpa = 214};
}

/* Section 5.11: length 0.44 %, width 2.19 %, printed +-3.56 % of compliance, 0.9 % of sagitta, 7 %
 * of clearance. */
static void thesis_deviations_give_the_thesis_errors(void **state) {
  (void)state;
  const fg_design design = design_of_thesis();
  fg_cantilever longer = fg_cantilever_deviating(&design, 0.44, -2.19);
  fg_cantilever shorter = fg_cantilever_deviating(&design, -0.44, 2.19);
  assert_near(longer.compliance_error_pct, 3.59, 0.005);
  assert_near(shorter.compliance_error_pct, -3.43, 0.005);
  assert_near(longer.sagitta_error_pct, 0.88, 0.005);
  assert_near(shorter.sagitta_error_pct, -0.88, 0.005);
  assert_near(longer.clearance_change_mm, -0.0088, 5e-5);
  assert_near(longer.clearance_change_pct, -7, 0.05);
  assert_near(shorter.clearance_change_pct, 7, 0.05);
  /* Signs that take each other off: the length's cube stays ahead of neither. */
  assert_near(fg_cantilever_deviating(&design, 0.44, 2.19).compliance_error_pct, -0.85, 0.005);
}

/* By hand: I = 3 x 0.1³ / 12 = 2.5e-4 mm⁴, S = 729 / (3 x 214000 x 2.5e-4) mm/N. */
static void nominal_beam_is_eq_5_10(void **state) {
  (void)state;
  const fg_design design = design_of_thesis();
  fg_cantilever beam = fg_cantilever_nominal(&design);
  assert_near(fg_cantilever_second_moment_mm4(&design), 2.5e-4, 1e-16);
  assert_near(beam.compliance_mm_per_n, 729 / 160.5, 1e-12);
  assert_near(beam.compliance_error_pct, 0, 0);
  assert_near(beam.u_compliance_error_pct, 0, 0);
  assert_near(beam.sagitta_mm, 1, 0);
  assert_near(beam.clearance_change_pct, 0, 0);
}

typedef struct spread {
  double sum, sum_squares;
} spread;

static void take(spread *s, double value) {
  s->sum += value;
  s->sum_squares += value * value;
}

static double sd(const spread *s, size_t n) {
  double mean = s->sum / (double)n;
  return sqrt(s->sum_squares / (double)n - mean * mean);
}

/* Beams drawn with errors large enough for the higher terms to count (10 % of length: the law of
 * first order is 7 % low), their lengths and widths independent or erring alike. */
static void uncertainties_are_those_of_drawn_beams(void **state) {
  (void)state;
  enum { DRAWS = 200000 };
  for (int alike = 0; alike < 2; alike++) {
    fg_design design = design_of_thesis();
    design.beams.u_thickness_mm = alike ? 0 : 0.004;
    const double rel_length = 0.10, rel_width = 0.08, rho = alike ? 0.9 : 0;
    const double rel_thickness = design.beams.u_thickness_mm / design.thickness_mm;
    const fg_beam_size size = {9, 9 * rel_length, 3, 3 * rel_width, rho};
    spread compliance = {0}, sagitta = {0};
    uint64_t seed = 5 + (uint64_t)alike;
    for (int i = 0; i < DRAWS; i++) {
      double z[3] = {random_gaussian(&seed), random_gaussian(&seed), random_gaussian(&seed)};
      z[1] = rho * z[0] + sqrt(1 - rho * rho) * z[1];
      double length = exp(sqrt(log1p(rel_length * rel_length)) * z[0]);
      double width = exp(sqrt(log1p(rel_width * rel_width)) * z[1]);
      double thickness = exp(sqrt(log1p(rel_thickness * rel_thickness)) * z[2]);
      take(&compliance, pow(length / thickness, 3) / width);
      take(&sagitta, length * length);
    }
    const fg_cantilever beam = fg_cantilever_of(&design, &size);
    /* The mean of a lognormal lies above its median by exp(v / 2), and sd with it. */
    double above = compliance.sum / DRAWS;
    assert_near(beam.u_compliance_error_pct / 100 / (sd(&compliance, DRAWS) / above), 1, 0.02);
    above = sagitta.sum / DRAWS;
    assert_near(beam.u_sagitta_mm / (sd(&sagitta, DRAWS) / above), 1, 0.01);
    assert_near(beam.u_clearance_change_pct, 100 * beam.u_sagitta_mm / 0.126, 1e-9);
  }
}

/* Of what lengths and widths are worth in a scan the law of propagation is all there is; what errs
 * alike in both takes itself partly off the compliance. */
static void small_uncertainties_are_first_order(void **state) {
  (void)state;
  const fg_design design = design_of_thesis();
  fg_beam_size size = {9, 0.004, 3, 0.003, 0};
  double l = 0.004 / 9, w = 0.003 / 3;
  fg_cantilever beam = fg_cantilever_of(&design, &size);
  assert_near(beam.u_compliance_error_pct, 100 * sqrt(9 * l * l + w * w), 1e-6);
  assert_near(beam.u_compliance_mm_per_n,
              beam.compliance_mm_per_n * beam.u_compliance_error_pct / 100, 1e-12);
  assert_near(beam.u_sagitta_error_pct, 200 * l, 1e-6);
  size.correlation = 1;
  beam = fg_cantilever_of(&design, &size);
  assert_near(beam.u_compliance_error_pct, 100 * fabs(3 * l - w), 1e-3);
}

static void impossible_sizes_give_nan(void **state) {
  (void)state;
  fg_design design = design_of_thesis();
  const double bad[] = {NAN, INFINITY, 0, -9};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    in_row("bad[%zu]", i);
    const fg_beam_size size = {bad[i], 0.004, 3, 0.003, 0};
    fg_cantilever beam = fg_cantilever_of(&design, &size);
    assert_true(isnan(beam.compliance_error_pct) && isnan(beam.u_compliance_error_pct));
    assert_true(isnan(beam.compliance_mm_per_n) && isnan(beam.sagitta_mm));
  }
  const fg_beam_size no_u = {9, NAN, 3, 0.003, 0};
  assert_true(isnan(fg_cantilever_of(&design, &no_u).u_compliance_error_pct));
  assert_near(fg_cantilever_of(&design, &no_u).compliance_error_pct, 0, 1e-12);
  const fg_beam_size no_width = {9, 0.004, NAN, NAN, 0};
  fg_cantilever beam = fg_cantilever_of(&design, &no_width);
  assert_true(isnan(beam.compliance_error_pct) && isnan(beam.u_compliance_mm_per_n));
  assert_near(beam.sagitta_error_pct, 0, 1e-12);
  assert_near(beam.u_sagitta_error_pct, 200 * 0.004 / 9, 1e-6);
  design.beams.sagitta_mm = design.beams.clearance_mm = design.beams.elastic_modulus_gpa = 0;
  beam = fg_cantilever_nominal(&design);
  assert_true(isnan(beam.sagitta_mm) && isnan(beam.clearance_change_mm));
  assert_true(isnan(beam.compliance_mm_per_n) && isnan(beam.clearance_change_pct));
  assert_near(beam.compliance_error_pct, 0, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(thesis_deviations_give_the_thesis_errors),
      cmocka_unit_test(nominal_beam_is_eq_5_10),
      cmocka_unit_test(uncertainties_are_those_of_drawn_beams),
      cmocka_unit_test(small_uncertainties_are_first_order),
      cmocka_unit_test(impossible_sizes_give_nan),
  };
  return cmocka_run_group_tests_name("cantilever", tests, NULL, NULL);
}

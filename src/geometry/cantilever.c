/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/cantilever.h"

#include <math.h>

/* Relative standard uncertainties of the inputs of a beam's compliance. */
typedef struct relative {
  double length, width, thickness, correlation;
} relative;

static double square(double x) {
  return x * x;
}

static double cube(double x) {
  return x * x * x;
}

/* p² times the variance of the logarithm of x; a power of 0 needs no uncertainty. */
static double of_power(double p, double u_relative) {
  return p == 0 ? 0 : p * p * log1p(square(u_relative));
}

/* Relative u of length^l width^w thickness^t: sqrt(exp(v) - 1), v the variance of its logarithm. A
 * correlation cannot make v negative. NaN stays NaN: an unknown uncertainty is not 0. */
static double of_product(const relative *r, double l, double w, double t) {
  double v = of_power(l, r->length) + of_power(w, r->width) + of_power(t, r->thickness);
  if (l != 0 && w != 0) v += 2 * l * w * log1p(r->correlation * r->length * r->width);
  return v < 0 ? 0 : sqrt(expm1(v));
}

static double known(double value) {
  return isfinite(value) && value > 0 ? value : NAN;
}

double fg_cantilever_second_moment_mm4(const fg_design *design) {
  return design->beams.width_mm * cube(design->thickness_mm) / 12;
}

static void fill_compliance(const fg_design *design, double ratio, const relative *r,
                            fg_cantilever *out) {
  double u = of_product(r, 3, -1, -3);
  double modulus_n_mm2 = 1000 * known(design->beams.elastic_modulus_gpa);
  double nominal_mm_per_n =
      cube(design->beams.length_mm) / (3 * modulus_n_mm2 * fg_cantilever_second_moment_mm4(design));
  out->compliance_mm_per_n = nominal_mm_per_n * ratio;
  out->u_compliance_mm_per_n = nominal_mm_per_n * ratio * u;
  out->compliance_error_pct = 100 * (ratio - 1);
  out->u_compliance_error_pct = 100 * ratio * u;
}

static void fill_sagitta(const fg_design *design, double ratio, const relative *r,
                         fg_cantilever *out) {
  double u = ratio * of_product(r, 2, 0, 0);
  double sagitta_mm = known(design->beams.sagitta_mm),
         clearance_mm = known(design->beams.clearance_mm);
  out->sagitta_mm = sagitta_mm * ratio;
  out->u_sagitta_mm = sagitta_mm * u;
  out->sagitta_error_pct = 100 * (ratio - 1);
  out->u_sagitta_error_pct = 100 * u;
  out->clearance_change_mm = sagitta_mm * (1 - ratio);
  out->u_clearance_change_mm = sagitta_mm * u;
  out->clearance_change_pct = 100 * out->clearance_change_mm / clearance_mm;
  out->u_clearance_change_pct = 100 * out->u_clearance_change_mm / clearance_mm;
}

fg_cantilever fg_cantilever_of(const fg_design *design, const fg_beam_size *size) {
  fg_cantilever out;
  double length_mm = known(size->length_mm), width_mm = known(size->width_mm);
  double length = length_mm / design->beams.length_mm, width = width_mm / design->beams.width_mm;
  const relative r = {size->u_length_mm / length_mm, size->u_width_mm / width_mm,
                      design->beams.u_thickness_mm / design->thickness_mm, size->correlation};
  fill_compliance(design, cube(length) / width, &r, &out);
  fill_sagitta(design, square(length), &r, &out);
  return out;
}

fg_cantilever fg_cantilever_deviating(const fg_design *design, double length_pct,
                                      double width_pct) {
  const fg_beam_size size = {.length_mm = design->beams.length_mm * (1 + length_pct / 100),
                             .width_mm = design->beams.width_mm * (1 + width_pct / 100)};
  return fg_cantilever_of(design, &size);
}

fg_cantilever fg_cantilever_nominal(const fg_design *design) {
  return fg_cantilever_deviating(design, 0, 0);
}

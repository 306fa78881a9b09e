/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values derived from the size of a cantilever: a flat foil with beams cut out of it, bent
 * afterwards so that every beam stands off its sheet by its sagitta (thesis section 5.11).
 *
 *   S = L³ / (3 E I), I = w t³ / 12                    compliance of a beam (eq 5.10)
 *   S / S_D = (L / L_D)³ (w_D / w) (t_D / t)³          against the design's, whatever E is
 *   s = s_D (L / L_D)²                                 sagitta at the curvature of the design
 *   dC = -(s - s_D)                                    change of the bearing's clearance
 *
 * Every value is a product of powers of length, width and thickness. Its u is that of the product,
 * with no term of the powers left out: with r = u(x) / x the logarithm of x has the variance
 * ln(1 + r²), those of a length and a width of correlation rho the covariance ln(1 + rho r r'),
 * and a product whose logarithm has the variance v has u = value sqrt(exp(v) - 1). That is exact
 * for lognormal lengths, which no scan tells from normal ones; to first order it is the law of
 * propagation, for independent lengths (u(S) / S)² = 9 (u(L) / L)² + (u(w) / w)² + 9 (u(t) / t)².
 */
#ifndef FOILGAUGE_CANTILEVER_H
#define FOILGAUGE_CANTILEVER_H

#include "foilgauge/design.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One beam as measured. */
typedef struct fg_beam_size {
  double length_mm, u_length_mm;
  double width_mm, u_width_mm;
  double correlation; /* of the errors of length and width, as by a common pixel pitch; 0: none */
} fg_beam_size;

/* NaN: unknown, for the stated reason or because the size is not a number above 0. */
typedef struct fg_cantilever {
  double compliance_mm_per_n, u_compliance_mm_per_n;   /* NaN without elastic_modulus_gpa */
  double compliance_error_pct, u_compliance_error_pct; /* 100 (S - S_D) / S_D */
  double sagitta_mm, u_sagitta_mm;                     /* NaN without sagitta_mm */
  double sagitta_error_pct, u_sagitta_error_pct;       /* 100 (s - s_D) / s_D */
  double clearance_change_mm, u_clearance_change_mm;   /* -(s - s_D); NaN without sagitta_mm */
  double clearance_change_pct, u_clearance_change_pct; /* of clearance_mm; NaN without it */
} fg_cantilever;

/* Derives the values of a beam of this size in a checked design of kind cantilever. The scan does
 * not show the thickness: it is the design's thickness_mm, and u_thickness_mm is its part of u. */
fg_cantilever fg_cantilever_of(const fg_design *design, const fg_beam_size *size);

/* Values of the beam as designed: all errors and changes are 0. */
fg_cantilever fg_cantilever_nominal(const fg_design *design);

/* Values of a beam that deviates from the design by these percents, exactly known. */
fg_cantilever fg_cantilever_deviating(const fg_design *design, double length_pct, double width_pct);

/* I of the design's cross-section, mm⁴. */
double fg_cantilever_second_moment_mm4(const fg_design *design);

#ifdef __cplusplus
}
#endif
#endif

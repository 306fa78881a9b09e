/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Do two samples differ, in their means or in their spread? And: how good is the gauge?
 *
 * Means: Welch's test (unequal variances, Welch-Satterthwaite degrees of freedom). Spread: the F
 * ratio of variances (exact for normal values) and Levene's test about the median (Brown and
 * Forsythe 1974), which does not need them to be normal. */
#ifndef FOILGAUGE_COMPARISON_H
#define FOILGAUGE_COMPARISON_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_sample {
  const double *values;
  size_t count;
} fg_sample;

typedef struct fg_comparison {
  double difference, low, high; /* difference of the means, a - b, with its interval */
  double t, dof, p_means;
  double variance_ratio, f_low, f_high, p_variances; /* F */
  double levene, p_levene;
} fg_comparison;

/* FG_ERR_DATA for fewer than two values in either, or no spread in both. */
fg_status fg_comparison_compute(fg_context *ctx, fg_sample a, fg_sample b, double confidence,
                                fg_comparison *comparison);

/* Effective degrees of freedom of a sum of independent contributions u_i with nu_i (Welch and
 * Satterthwaite; GUM eq G.2b). nu may be infinite. */
double fg_effective_dof(const double *u, const double *dof, size_t count);

/* Gauge repeatability and reproducibility from a crossed study: every operator measures every part
 * `trials` times. By analysis of variance (the interaction is pooled with the repeatability when
 * its p-value exceeds 0.25) and, for comparison, by means and ranges. All are standard deviations.
 * AIAG Measurement Systems Analysis, 4th ed.; ndc = 1.41 part / grr. */
typedef struct fg_gauge_study {
  size_t parts, operators, trials;
  double repeatability, reproducibility, interaction, grr, part, total;
  double grr_pct; /* 100 grr / total */
  double distinct_categories;
  bool pooled;
  double ss_operator, ss_part, ss_interaction, ss_repeat, f_interaction, p_interaction;
  double range_repeatability, range_reproducibility, range_grr, range_part, range_total;
} fg_gauge_study;

/* value[(part * operators + operator) * trials + trial]. FG_ERR_DATA for fewer than two parts,
 * operators or trials. */
fg_status fg_gauge_study_compute(fg_context *ctx, const double *value, size_t parts,
                                 size_t operators, size_t trials, fg_gauge_study *study);

#ifdef __cplusplus
}
#endif
#endif

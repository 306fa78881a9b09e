/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gauge study with cells of unequal size, or none: scans that failed, a foil that one operator left
 * out.
 *
 * Parts, operators and their interaction are random, y = mu + p + o + i + e. The variances maximise
 * the restricted likelihood (Patterson and Thompson 1971), as R's lmer does. On a complete study
 * without negative components that is the analysis of variance. As there, the interaction is pooled
 * with the repeatability where its p-value, of the F ratio beside fixed parts and operators,
 * exceeds 0.25 or the cells leave it no degree of freedom. */
#ifndef FOILGAUGE_GAUGE_UNEVEN_H
#define FOILGAUGE_GAUGE_UNEVEN_H

#include "foilgauge/comparison.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Part and operator by index from 0, and the value. */
typedef struct fg_gauge_trial {
  size_t part, who;
  double value;
} fg_gauge_trial;

/* Cells at most: the work grows by their cube. */
enum { FG_GAUGE_CELLS_MAX = 120 };

/* `trials` of the study is that of the fullest cell; sums of squares of parts and operators and
 * everything by ranges are NaN. FG_ERR_DATA for fewer than two parts or operators, no repeated
 * trial, or too many cells. */
fg_status fg_gauge_study_uneven(fg_context *ctx, const fg_gauge_trial *trial, size_t count,
                                fg_gauge_study *study);

#ifdef __cplusplus
}
#endif
#endif

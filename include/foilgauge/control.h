/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Control charts, which show whether a process has changed.
 *
 * Limits lie three sigma from the centre; sigma is the spread within subgroups (or from one
 * value to the next), never that of all values, which would hide the changes that the chart seeks.
 * Unbiasing factors follow from the normal distribution: c4(n) = sqrt(2 / (n-1)) Gamma(n/2) /
 * Gamma((n-1)/2), d2(n) = ∫ (1 - (1 - Phi)^n - Phi^n) dx. Subgroups may differ in size: sigma is
 * the mean of s_i / c4(n_i) (or R_i / d2(n_i)) over subgroups of two or more.
 *
 * Run rules (Nelson 1984), zones in sigma of the plotted points:
 *   1 one point beyond 3          5 two of three beyond 2 on one side
 *   2 nine in a row on one side   6 four of five beyond 1 on one side
 *   3 six rising or falling       7 fifteen in a row within 1
 *   4 fourteen alternating        8 eight in a row beyond 1, on both sides
 */
#ifndef FOILGAUGE_CONTROL_H
#define FOILGAUGE_CONTROL_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { FG_RUN_RULES = 8 };

typedef enum fg_sigma_from {
  FG_SIGMA_FROM_SD,    /* s of each subgroup */
  FG_SIGMA_FROM_RANGE, /* R of each subgroup */
} fg_sigma_from;

typedef struct fg_chart_point {
  double value, lower, upper; /* limits at this point: they follow the subgroup's size */
  unsigned rules;             /* bits: rule r that ends here is bit r - 1 */
} fg_chart_point;

typedef struct fg_chart {
  double centre;
  fg_chart_point *point; /* owned */
  size_t count;
  size_t signals; /* points at which a rule ends */
  double sigma;   /* of one value: the limits are made of it */
} fg_chart;

double fg_chart_c4(size_t n); /* NaN below 2 */
double fg_chart_d2(size_t n);

/* Individuals: sigma = mean moving range / d2(2). FG_ERR_DATA for fewer than two values. */
fg_status fg_chart_individuals(fg_context *ctx, const double *values, size_t count, unsigned rules,
                               fg_chart *chart);

typedef struct fg_subgroups {
  const double *values; /* subgroup after subgroup */
  const size_t *size;   /* values of each; 0: the subgroup is left out */
  size_t count;         /* subgroups */
} fg_subgroups;

/* Chart of the subgroups' means, and of their standard deviations (run rule 1 only; subgroups of
 * one are left out of it with NaN); either may be NULL. FG_ERR_DATA when no subgroup has two
 * values. */
fg_status fg_chart_subgroups(fg_context *ctx, const fg_subgroups *subgroups, fg_sigma_from from,
                             unsigned rules, fg_chart *means, fg_chart *deviations);

void fg_chart_free(fg_chart *chart);

/* Expected number of points with a signal on a chart of `count` independent normal values of a
 * steady process with known limits, by these rules. A point with two rules counts twice, so it is a
 * few percent too large. */
double fg_chart_chance_signals(size_t count, unsigned rules);

/* Signals of the chart of a steady process, by chance alone. */
typedef struct fg_chart_chance {
  double expected; /* signals, by chance */
  size_t max;      /* signals that chance alone explains */
  size_t outliers; /* points farther out than chance explains, of all points together */
  bool steady;     /* no more signals than max, no outliers */
} fg_chart_chance;

/* Judges whether chance alone explains a chart's signals: the chart of a steady process of
 * independent normal values is called not steady with a probability of about `level` (0.01), half
 * of it by the number of its signals (a negative binomial, as signals of run rules come in runs),
 * half by its farthest point. Outliers are those of rule 1: without that rule there are none.
 * size: of the subgroups. */
void fg_chart_judge_individuals(const fg_chart *chart, unsigned rules, double level,
                                fg_chart_chance *chance);
void fg_chart_judge_deviations(const fg_chart *chart, const size_t *size, unsigned rules,
                               double level, fg_chart_chance *chance);

/* The number of points that a rule covers, 1 to FG_RUN_RULES. */
size_t fg_run_rule_length(unsigned rule);

/* The rule in words, 1 to FG_RUN_RULES. */
const char *fg_run_rule_words(unsigned rule);

#ifdef __cplusplus
}
#endif
#endif

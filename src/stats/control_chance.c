/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signals that chance alone gives the chart of a steady process. */
#include <gsl/gsl_cdf.h>
#include <math.h>

#include "foilgauge/control.h"

/* Probability that a rule ends at a point, with p1, p2, p3 beyond 1, 2, 3 sigma on one side.
 * Permutations of n values: 2 of n! are monotonic, 2 E_n alternate (E_14 = 199360981, Andre 1881).
 */
static double chance_of_rule(unsigned rule) {
  const double p1 = erfc(1 / M_SQRT2) / 2, p2 = erfc(2 / M_SQRT2) / 2, p3 = erfc(3 / M_SQRT2) / 2;
  const double alternating_14 = 2 * 199360981 / 87178291200.0;
  switch (rule) {
  case 1:
    return 2 * p3;
  case 2:
    return 2 * pow(0.5, 9);
  case 3:
    return 2 / 720.0;
  case 4:
    return alternating_14;
  case 5:
    return 2 * p2 * (1 - pow(1 - p2, 2));
  case 6:
    return 2 * p1 * pow(p1, 3) * (4 * (1 - p1) + p1);
  case 7:
    return pow(1 - 2 * p1, 15);
  default:
    return pow(2 * p1, 8) - 2 * pow(p1, 8);
  }
}

double fg_chart_chance_signals(size_t count, unsigned rules) {
  double sum = 0;
  for (unsigned rule = 1; rule <= FG_RUN_RULES; rule++) {
    size_t length = fg_run_rule_length(rule);
    if (rules & (1u << (rule - 1)) && count >= length)
      sum += (double)(count + 1 - length) * chance_of_rule(rule);
  }
  return sum;
}

/* Probability that a rule that ends at a point ends at the next one, too: its signals come in runs.
 */
static double chance_to_go_on(unsigned rule) {
  static const double known[FG_RUN_RULES] = {0, 1 / 2.0, 1 / 7.0, 2 / M_PI, 0.05, 0.3, 0.68, 0.32};
  return known[rule - 1];
}

/* Variance of the number of signals over its mean: runs of geometric length q have (1 + q) /
 * (1 - q), and those of several rules the mean of it. */
static double find_dispersion(size_t count, unsigned rules) {
  double sum = 0, all = 0;
  for (unsigned rule = 1; rule <= FG_RUN_RULES; rule++) {
    double mean = fg_chart_chance_signals(count, rules & (1u << (rule - 1)));
    double go_on = chance_to_go_on(rule);
    sum += mean * (1 + go_on) / (1 - go_on);
    all += mean;
  }
  return all > 0 ? sum / all : 1;
}

/* Returns the smallest number that a negative binomial of that mean and dispersion (Poisson's for
 * 1) passes with `level` at most. */
static size_t find_count_limit(double mean, double dispersion, double level) {
  enum { MANY = 300 }; /* normal from there on, and the first term has no underflow below */
  double more = dispersion - 1;
  if (mean > MANY)
    return (size_t)ceil(mean + gsl_cdf_ugaussian_Qinv(level) * sqrt(mean * dispersion));
  double term = exp(-mean * (more > 1e-9 ? log1p(more) / more : 1)), sum = term;
  size_t limit = 0;
  for (; sum < 1 - level; limit++) {
    term *= (mean + (double)limit * more) / dispersion / (double)(limit + 1);
    sum += term;
  }
  return limit;
}

/* Half of the level is that of the number of signals, half that of the farthest point. */
void fg_chart_judge_individuals(const fg_chart *chart, unsigned rules, double level,
                                fg_chart_chance *chance) {
  double expected = fg_chart_chance_signals(chart->count, rules);
  *chance = (fg_chart_chance){.expected = expected};
  chance->max = find_count_limit(expected, find_dispersion(chart->count, rules), level / 2);
  double far = gsl_cdf_ugaussian_Qinv(level / 4 / (double)chart->count);
  for (size_t i = 0; i < chart->count && rules & 1u; i++)
    chance->outliers += fabs(chart->point[i].value - chart->centre) > far * chart->sigma;
  chance->steady = chart->signals <= chance->max && !chance->outliers;
}

/* Probability that s is below `value`, in sigma, of a subgroup of normal values. */
static double chance_below(double value, size_t size) {
  double dof = (double)size - 1;
  return value > 0 ? gsl_cdf_chisq_P(dof * value * value, dof) : 0;
}

static double chance_above(double value, size_t size) {
  double dof = (double)size - 1;
  return value > 0 ? gsl_cdf_chisq_Q(dof * value * value, dof) : 1;
}

void fg_chart_judge_deviations(const fg_chart *chart, const size_t *size, unsigned rules,
                               double level, fg_chart_chance *chance) {
  *chance = (fg_chart_chance){0};
  for (size_t i = 0, at = 0; at < chart->count; i++) {
    if (!size[i]) continue;
    const fg_chart_point *point = &chart->point[at++];
    if (size[i] < 2 || !(rules & 1u) || !(chart->sigma > 0)) continue;
    double share = level / 4 / (double)chart->count, sigma = chart->sigma;
    chance->expected +=
        chance_below(point->lower / sigma, size[i]) + chance_above(point->upper / sigma, size[i]);
    chance->outliers += chance_below(point->value / sigma, size[i]) < share ||
                        chance_above(point->value / sigma, size[i]) < share;
  }
  chance->max = find_count_limit(chance->expected, 1, level / 2);
  chance->steady = chart->signals <= chance->max && !chance->outliers;
}

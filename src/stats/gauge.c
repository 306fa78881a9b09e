/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gauge study: analysis of variance of a crossed design, and means and ranges. */
#include <math.h>
#include <stdlib.h>

#include "foilgauge/comparison.h"
#include "foilgauge/control.h"
#include "foilgauge/distribution.h"

/* The study's numbers; sums run over parts p, operators o, trials t. */
typedef struct layout {
  const double *value;
  size_t parts, operators, trials;
  double grand;
} layout;

static double at(const layout *l, size_t part, size_t who, size_t trial) {
  return l->value[(part * l->operators + who) * l->trials + trial];
}

static double cell_mean(const layout *l, size_t part, size_t who) {
  double sum = 0;
  for (size_t t = 0; t < l->trials; t++)
    sum += at(l, part, who, t);
  return sum / (double)l->trials;
}

static double part_mean(const layout *l, size_t part) {
  double sum = 0;
  for (size_t o = 0; o < l->operators; o++)
    sum += cell_mean(l, part, o);
  return sum / (double)l->operators;
}

static double operator_mean(const layout *l, size_t who) {
  double sum = 0;
  for (size_t p = 0; p < l->parts; p++)
    sum += cell_mean(l, p, who);
  return sum / (double)l->parts;
}

static double square(double x) {
  return x * x;
}

static void sums_of_squares(const layout *l, fg_gauge_study *study) {
  double p_count = (double)l->parts, o_count = (double)l->operators, t_count = (double)l->trials;
  for (size_t p = 0; p < l->parts; p++)
    study->ss_part += o_count * t_count * square(part_mean(l, p) - l->grand);
  for (size_t o = 0; o < l->operators; o++)
    study->ss_operator += p_count * t_count * square(operator_mean(l, o) - l->grand);
  for (size_t p = 0; p < l->parts; p++)
    for (size_t o = 0; o < l->operators; o++) {
      double mean = cell_mean(l, p, o);
      study->ss_interaction +=
          t_count * square(mean - part_mean(l, p) - operator_mean(l, o) + l->grand);
      for (size_t t = 0; t < l->trials; t++)
        study->ss_repeat += square(at(l, p, o, t) - mean);
    }
}

static double root(double variance) {
  return sqrt(fmax(0, variance));
}

static void components(const layout *l, fg_gauge_study *study) {
  double p = (double)l->parts, o = (double)l->operators, t = (double)l->trials;
  double f_part = p - 1, f_operator = o - 1, f_inter = f_part * f_operator, f_rep = p * o * (t - 1);
  double ms_inter = study->ss_interaction / f_inter, ms_rep = study->ss_repeat / f_rep;
  study->f_interaction = ms_inter / ms_rep;
  study->p_interaction = fg_distribution_f_upper(study->f_interaction, f_inter, f_rep);
  study->pooled = !(study->p_interaction <= 0.25);
  if (study->pooled)
    ms_rep = ms_inter = (study->ss_interaction + study->ss_repeat) / (f_inter + f_rep);
  study->repeatability = sqrt(ms_rep);
  study->interaction = root((ms_inter - ms_rep) / t);
  double who = root((study->ss_operator / f_operator - ms_inter) / (p * t));
  study->reproducibility = hypot(who, study->interaction);
  study->part = root((study->ss_part / f_part - ms_inter) / (o * t));
  study->grr = hypot(study->repeatability, study->reproducibility);
  study->total = hypot(study->grr, study->part);
  study->grr_pct = 100 * study->grr / study->total;
  study->distinct_categories = 1.41 * study->part / study->grr;
}

static double mean_range(const layout *l) {
  double sum = 0;
  for (size_t p = 0; p < l->parts; p++)
    for (size_t o = 0; o < l->operators; o++) {
      double low = INFINITY, high = -INFINITY;
      for (size_t t = 0; t < l->trials; t++) {
        low = fmin(low, at(l, p, o, t));
        high = fmax(high, at(l, p, o, t));
      }
      sum += high - low;
    }
  return sum / (double)(l->parts * l->operators);
}

static double range_of(const layout *l, double (*mean)(const layout *, size_t), size_t count) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < count; i++) {
    low = fmin(low, mean(l, i));
    high = fmax(high, mean(l, i));
  }
  return high - low;
}

/* d2* of one range of n values (Duncan 1955): sqrt(d2² + d3²), the root of E R². With the density
 * of the range from two order statistics this is a double integral; the trapezium rule over ±8
 * sigma is exact to nine digits for such a smooth function. */
static double d2_star(size_t n) {
  enum { STEPS = 320 };
  double step = 16.0 / STEPS, sum = 0, m = (double)n;
  for (int i = 0; i < STEPS; i++)
    for (int k = i + 1; k <= STEPS; k++) {
      double low = -8 + i * step, high = -8 + k * step;
      double between = (erfc(-high / sqrt(2)) - erfc(-low / sqrt(2))) / 2;
      sum += square(high - low) * pow(between, m - 2) * exp(-(low * low + high * high) / 2);
    }
  return sqrt(m * (m - 1) * sum * step * step / (2 * 3.14159265358979323846));
}

static void by_ranges(const layout *l, fg_gauge_study *study) {
  double p = (double)l->parts, t = (double)l->trials;
  study->range_repeatability = mean_range(l) / fg_chart_d2(l->trials);
  double who = range_of(l, operator_mean, l->operators) / d2_star(l->operators);
  study->range_reproducibility = root(square(who) - square(study->range_repeatability) / (p * t));
  study->range_part = range_of(l, part_mean, l->parts) / d2_star(l->parts);
  study->range_grr = hypot(study->range_repeatability, study->range_reproducibility);
  study->range_total = hypot(study->range_grr, study->range_part);
}

fg_status fg_gauge_study_compute(fg_context *ctx, const double *value, size_t parts,
                                 size_t operators, size_t trials, fg_gauge_study *study) {
  layout l = {.value = value, .parts = parts, .operators = operators, .trials = trials};
  *study = (fg_gauge_study){.parts = parts, .operators = operators, .trials = trials};
  if (parts < 2 || operators < 2 || trials < 2)
    return fg_fail(ctx, FG_ERR_DATA,
                   "a gauge study needs two parts, operators and trials at least; there are %zu, "
                   "%zu and %zu",
                   parts, operators, trials);
  for (size_t p = 0; p < parts; p++)
    l.grand += part_mean(&l, p) / (double)parts;
  sums_of_squares(&l, study);
  components(&l, study);
  by_ranges(&l, study);
  return FG_OK;
}

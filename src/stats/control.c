/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/control.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/numerics.h"

double fg_chart_c4(size_t n) {
  if (n < 2) return NAN;
  double dof = (double)n - 1;
  return sqrt(2 / dof) * exp(fg_log_gamma((double)n / 2) - fg_log_gamma(dof / 2));
}

/* Simpson's rule over ±9 sigma: the density beyond is below 1e-18. */
double fg_chart_d2(size_t n) {
  enum { STEPS = 2000 };
  if (n < 2) return NAN;
  double sum = 0, step = 18.0 / STEPS;
  for (int i = 0; i <= STEPS; i++) {
    double below = erfc(-(-9 + i * step) / sqrt(2)) / 2;
    double value = 1 - pow(1 - below, (double)n) - pow(below, (double)n);
    sum += value * (i == 0 || i == STEPS ? 1 : i % 2 ? 4 : 2);
  }
  return sum * step / 3;
}

const char *fg_run_rule_words(unsigned rule) {
  static const char *const words[FG_RUN_RULES] = {
      "one point beyond three sigma",
      "nine in a row on one side of the centre",
      "six in a row rising or falling",
      "fourteen in a row alternating",
      "two of three beyond two sigma on one side",
      "four of five beyond one sigma on one side",
      "fifteen in a row within one sigma",
      "eight in a row beyond one sigma on both sides",
  };
  return rule >= 1 && rule <= FG_RUN_RULES ? words[rule - 1] : "";
}

size_t fg_run_rule_length(unsigned rule) {
  static const size_t lengths[FG_RUN_RULES] = {1, 9, 6, 14, 3, 5, 15, 8};
  return lengths[rule - 1];
}

/* Distance from the centre in sigma of this point. */
static double zone(const fg_chart *chart, size_t i) {
  const fg_chart_point *point = &chart->point[i];
  double sigma = (point->upper - chart->centre) / 3;
  if (sigma > 0) return (point->value - chart->centre) / sigma;
  return point->value == chart->centre ? 0 : copysign(INFINITY, point->value - chart->centre);
}

/* Returns true when at least `min` of the last `length` points lie beyond `limit` on the side of
 * `sign`, the last one among them. */
static bool is_beyond(const fg_chart *chart, size_t i, size_t length, size_t min, double limit,
                      double sign) {
  size_t found = 0;
  if (i + 1 < length || !(sign * zone(chart, i) > limit)) return false;
  for (size_t k = i + 1 - length; k <= i; k++)
    found += sign * zone(chart, k) > limit;
  return found >= min;
}

static bool either_side(const fg_chart *chart, size_t i, size_t length, size_t min, double limit) {
  return is_beyond(chart, i, length, min, limit, 1) || is_beyond(chart, i, length, min, limit, -1);
}

static bool monotonic(const fg_chart *chart, size_t i, size_t length, double sign) {
  if (i + 1 < length) return false;
  for (size_t k = i + 2 - length; k <= i; k++)
    if (!(sign * (chart->point[k].value - chart->point[k - 1].value) > 0)) return false;
  return true;
}

static bool alternating(const fg_chart *chart, size_t i, size_t length) {
  if (i + 1 < length) return false;
  for (size_t k = i + 3 - length; k <= i; k++) {
    double before = chart->point[k - 1].value - chart->point[k - 2].value;
    if (!(before * (chart->point[k].value - chart->point[k - 1].value) < 0)) return false;
  }
  return true;
}

static bool all_zones(const fg_chart *chart, size_t i, size_t length, bool within) {
  if (i + 1 < length) return false;
  for (size_t k = i + 1 - length; k <= i; k++)
    if ((fabs(zone(chart, k)) < 1) != within) return false;
  return true;
}

/* Rule 8 requires points on both sides: eight on one side only are rule 6. */
static bool mixed(const fg_chart *chart, size_t i) {
  bool above = false, below = false;
  if (!all_zones(chart, i, 8, false)) return false;
  for (size_t k = i - 7; k <= i; k++) {
    above = above || zone(chart, k) > 0;
    below = below || zone(chart, k) < 0;
  }
  return above && below;
}

static unsigned rules_at(const fg_chart *chart, size_t i) {
  const bool holds[FG_RUN_RULES] = {
      either_side(chart, i, 1, 1, 3),
      either_side(chart, i, 9, 9, 0),
      monotonic(chart, i, 6, 1) || monotonic(chart, i, 6, -1),
      alternating(chart, i, 14),
      either_side(chart, i, 3, 2, 2),
      either_side(chart, i, 5, 4, 1),
      all_zones(chart, i, 15, true),
      mixed(chart, i),
  };
  unsigned rules = 0;
  for (unsigned rule = 0; rule < FG_RUN_RULES; rule++)
    if (holds[rule]) rules |= 1u << rule;
  return rules;
}

static void apply_rules(fg_chart *chart, unsigned rules) {
  chart->signals = 0;
  for (size_t i = 0; i < chart->count; i++) {
    if (!isfinite(chart->point[i].value)) continue;
    chart->point[i].rules = rules_at(chart, i) & rules;
    chart->signals += chart->point[i].rules != 0;
  }
}

static fg_status open_chart(fg_context *ctx, size_t count, fg_chart *chart) {
  void *block;
  *chart = (fg_chart){.count = count};
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *chart->point, &block));
  chart->point = block;
  return FG_OK;
}

void fg_chart_free(fg_chart *chart) {
  free(chart->point);
  *chart = (fg_chart){0};
}

fg_status fg_chart_individuals(fg_context *ctx, const double *values, size_t count, unsigned rules,
                               fg_chart *chart) {
  *chart = (fg_chart){0};
  if (count < 2)
    return fg_fail(ctx, FG_ERR_DATA, "a chart of individuals needs two values; there are %zu",
                   count);
  FG_TRY(open_chart(ctx, count, chart));
  double moving = 0;
  for (size_t i = 0; i < count; i++) {
    chart->centre += (values[i] - values[0]) / (double)count;
    if (i) moving += fabs(values[i] - values[i - 1]) / (double)(count - 1);
  }
  chart->centre += values[0]; /* so that equal values have a mean that is theirs to the last bit */
  chart->sigma = moving / fg_chart_d2(2);
  for (size_t i = 0; i < count; i++)
    chart->point[i] = (fg_chart_point){values[i], chart->centre - 3 * chart->sigma,
                                       chart->centre + 3 * chart->sigma, 0};
  apply_rules(chart, rules);
  return FG_OK;
}

typedef struct subgroup {
  double mean, sd, range;
} subgroup;

static subgroup describe_subgroup(const double *values, size_t count) {
  subgroup group = {.mean = 0};
  double low = INFINITY, high = -INFINITY, squares = 0;
  for (size_t i = 0; i < count; i++) {
    group.mean += (values[i] - values[0]) / (double)count;
    low = fmin(low, values[i]);
    high = fmax(high, values[i]);
  }
  if (count) group.mean += values[0];
  for (size_t i = 0; i < count; i++)
    squares += (values[i] - group.mean) * (values[i] - group.mean);
  group.sd = count > 1 ? sqrt(squares / (double)(count - 1)) : NAN;
  group.range = count ? high - low : NAN;
  return group;
}

/* Subgroups with the parameters of their charts. */
typedef struct chart_basis {
  const double *values;
  const size_t *size;
  size_t count;
  double sigma, grand_mean;
} chart_basis;

static fg_status find_sigma(fg_context *ctx, fg_sigma_from from, chart_basis *all) {
  size_t used = 0, total = 0, at = 0;
  for (size_t i = 0; i < all->count; at += all->size[i++]) {
    subgroup group = describe_subgroup(all->values + at, all->size[i]);
    total += all->size[i];
    if (all->size[i]) all->grand_mean += group.mean * (double)all->size[i];
    if (all->size[i] < 2) continue;
    all->sigma += from == FG_SIGMA_FROM_SD ? group.sd / fg_chart_c4(all->size[i])
                                           : group.range / fg_chart_d2(all->size[i]);
    used++;
  }
  if (!used)
    return fg_fail(ctx, FG_ERR_DATA, "a chart of subgroups needs one of two values at least");
  all->grand_mean /= (double)total;
  all->sigma /= (double)used;
  return FG_OK;
}

static void plot_means(const chart_basis *all, unsigned rules, fg_chart *chart) {
  size_t at = 0, plotted = 0;
  chart->centre = all->grand_mean;
  for (size_t i = 0; i < all->count; at += all->size[i++]) {
    if (!all->size[i]) continue;
    double reach = 3 * all->sigma / sqrt((double)all->size[i]);
    chart->point[plotted++] =
        (fg_chart_point){describe_subgroup(all->values + at, all->size[i]).mean,
                         chart->centre - reach, chart->centre + reach, 0};
  }
  chart->count = plotted;
  apply_rules(chart, rules);
}

/* s has the mean c4 sigma and the variance (1 - c4²) sigma². The centre line is that of the
 * largest subgroup. */
static void plot_deviations(const chart_basis *all, unsigned rules, fg_chart *chart) {
  size_t at = 0, plotted = 0, largest = 0;
  for (size_t i = 0; i < all->count; at += all->size[i++]) {
    if (!all->size[i]) continue;
    double c4 = fg_chart_c4(all->size[i]), centre = c4 * all->sigma;
    double reach = 3 * all->sigma * sqrt(1 - c4 * c4);
    if (all->size[i] > largest) largest = all->size[i];
    chart->point[plotted++] = (fg_chart_point){describe_subgroup(all->values + at, all->size[i]).sd,
                                               fmax(0, centre - reach), centre + reach, 0};
  }
  chart->count = plotted;
  chart->centre = fg_chart_c4(largest) * all->sigma;
  for (size_t i = 0; i < plotted; i++) {
    fg_chart_point *point = &chart->point[i];
    bool out = point->value > point->upper || point->value < point->lower;
    point->rules = out ? rules & 1u : 0;
    chart->signals += point->rules != 0;
  }
}

fg_status fg_chart_subgroups(fg_context *ctx, const fg_subgroups *subgroups, fg_sigma_from from,
                             unsigned rules, fg_chart *means, fg_chart *deviations) {
  chart_basis all = {
      .values = subgroups->values, .size = subgroups->size, .count = subgroups->count};
  if (means) *means = (fg_chart){0};
  if (deviations) *deviations = (fg_chart){0};
  FG_TRY(find_sigma(ctx, from, &all));
  if (means) {
    FG_TRY(open_chart(ctx, all.count, means));
    means->sigma = all.sigma;
    plot_means(&all, rules, means);
  }
  if (deviations) {
    FG_TRY(open_chart(ctx, all.count, deviations));
    deviations->sigma = all.sigma;
    plot_deviations(&all, rules, deviations);
  }
  return FG_OK;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/capability.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "foilgauge/design.h"
#include "foilgauge/distribution.h"

enum { NORMALITY_MIN = 8 };

static void find_mean_and_sd(const double *values, size_t count, double *mean, double *sd) {
  double squares = 0;
  *mean = 0;
  for (size_t i = 0; i < count; i++)
    *mean += (values[i] - values[0]) / (double)count;
  *mean += values[0];
  for (size_t i = 0; i < count; i++)
    squares += (values[i] - *mean) * (values[i] - *mean);
  *sd = count > 1 ? sqrt(squares / (double)(count - 1)) : NAN;
}

/* ln of the normal distribution's lower tail, also far out. */
static double log_below(double z) {
  return log(fmax(erfc(-z / sqrt(2)) / 2, 1e-300));
}

/* D'Agostino and Stephens 1986, table 4.9. */
static double anderson_darling_p(double a2) {
  if (a2 >= 10) return 0;
  if (a2 >= 0.6) return exp(1.2937 - 5.709 * a2 + 0.0186 * a2 * a2);
  if (a2 > 0.34) return exp(0.9177 - 4.279 * a2 - 1.38 * a2 * a2);
  if (a2 > 0.2) return 1 - exp(-8.318 + 42.796 * a2 - 59.938 * a2 * a2);
  return 1 - exp(-13.436 + 101.14 * a2 - 223.73 * a2 * a2);
}

static double anderson_darling(const double *sorted, size_t count, double mean, double sd) {
  double sum = 0, n = (double)count;
  for (size_t i = 0; i < count; i++) {
    double low = (sorted[i] - mean) / sd, high = (sorted[count - 1 - i] - mean) / sd;
    sum += (2 * (double)i + 1) * (log_below(low) + log_below(-high));
  }
  return (-n - sum / n) * (1 + 0.75 / n + 2.25 / (n * n));
}

fg_status fg_normality_test(fg_context *ctx, const double *values, size_t count,
                            fg_normality *normality) {
  void *block;
  double mean, sd;
  *normality = (fg_normality){NAN, NAN};
  if (count < NORMALITY_MIN) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *values, &block));
  double *sorted = block;
  memcpy(sorted, values, count * sizeof *values);
  fg_sort(sorted, count);
  find_mean_and_sd(sorted, count, &mean, &sd);
  if (sd > 0) {
    normality->a2 = anderson_darling(sorted, count, mean, sd);
    normality->p_value = anderson_darling_p(normality->a2);
  }
  free(sorted);
  return FG_OK;
}

/* ---- values in groups ---- */

static bool has_groups(fg_value_groups groups) {
  for (size_t i = 0; groups.size && i < groups.count; i++)
    if (groups.size[i] > 1) return true;
  return false;
}

/* Sum of a group's values, less `origin` each. */
static double sum_from(const double *values, size_t count, double origin) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += values[i] - origin;
  return sum;
}

/* Values of groups, parted into the groups' means and the deviations from them. */
typedef struct parted_values {
  double *mean, *deviation; /* owned */
  size_t means, deviations;
} parted_values;

/* Parts `count` values; groups of one have no deviation. */
static void part_values(const double *values, size_t count, fg_value_groups groups,
                        parted_values *parted) {
  size_t at = 0, single = 0;
  for (size_t i = 0; i < groups.count; at += groups.size[i++]) {
    size_t n = groups.size[i];
    if (!n) continue;
    double mean = values[at] + sum_from(values + at, n, values[at]) / (double)n;
    parted->mean[parted->means++] = mean;
    single += n == 1;
    /* Of n values, deviations are smaller by the share that the mean has taken. */
    for (size_t k = at; n > 1 && k < at + n; k++)
      parted->deviation[k - single] = (values[k] - mean) * sqrt((double)n / (double)(n - 1));
  }
  parted->deviations = count - single;
}

fg_status fg_normality_test_groups(fg_context *ctx, const double *values, size_t count,
                                   fg_value_groups groups, fg_normality *normality) {
  parted_values parted = {.mean = NULL};
  fg_normality of_means, of_deviations;
  fg_status status = FG_OK;
  if (!has_groups(groups)) return fg_normality_test(ctx, values, count, normality);
  FG_TRY_EXIT(fg_memory_allocate(ctx, groups.count, sizeof *parted.mean, (void **)&parted.mean));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *parted.deviation, (void **)&parted.deviation));
  part_values(values, count, groups, &parted);
  FG_TRY_EXIT(fg_normality_test(ctx, parted.mean, parted.means, &of_means));
  FG_TRY_EXIT(fg_normality_test(ctx, parted.deviation, parted.deviations, &of_deviations));
  bool both = isfinite(of_means.p_value) && isfinite(of_deviations.p_value);
  *normality = of_means.p_value < of_deviations.p_value || !isfinite(of_deviations.p_value)
                   ? of_means
                   : of_deviations;
  if (both) normality->p_value = fmin(1, 2 * normality->p_value);
exit:
  free(parted.mean);
  free(parted.deviation);
  return status;
}

/* Interval of the standard deviation of a value, and weight of the mean. */
typedef struct spread {
  double sd_low, sd_high; /* interval of the process's standard deviation */
  double sd;              /* its estimate that the interval belongs to */
  double mean_count;      /* number of independent values that would know the mean as well */
} spread;

/* Part of a variance: a mean square times its coefficient. */
typedef struct component {
  double value, dof;
} component;

static double add_distances(const component part[2], double probability) {
  double sum = 0;
  for (int i = 0; i < 2; i++)
    if (part[i].dof > 0)
      sum += pow((part[i].dof / fg_distribution_chi2_quantile(probability, part[i].dof) - 1) *
                     part[i].value,
                 2);
  return sqrt(sum);
}

static spread grouped_spread(const fg_capability_input *input, double mean, double alpha) {
  double between = 0, within = 0, known = 0, squares = 0, n = (double)input->count;
  size_t at = 0;
  for (size_t i = 0; i < input->groups.count; at += input->groups.size[i++]) {
    double size = (double)input->groups.size[i];
    if (!(size > 0)) continue;
    double level = mean + sum_from(input->values + at, input->groups.size[i], mean) / size;
    between += size * (level - mean) * (level - mean);
    for (size_t k = at; k < at + input->groups.size[i]; k++)
      within += (input->values[k] - level) * (input->values[k] - level);
    known++;
    squares += size * size;
  }
  double n0 = (n - squares / n) / (known - 1), b = between / (known - 1), w = within / (n - known);
  component part[2] = {{b / n0, known - 1}, {(1 - 1 / n0) * w, n - known}};
  double variance = part[0].value + part[1].value;
  double level = fmax(0, b - w) / n0; /* variance of the groups' own levels */
  return (spread){.sd_low = sqrt(variance - add_distances(part, 1 - alpha / 2)),
                  .sd_high = sqrt(variance + add_distances(part, alpha / 2)),
                  .sd = sqrt(variance),
                  .mean_count = variance / (level * squares / (n * n) + w / n)};
}

static bool is_one_group(fg_value_groups groups) {
  size_t known = 0;
  for (size_t i = 0; i < groups.count; i++)
    known += groups.size[i] > 0;
  return known == 1;
}

/* ---- ratios ---- */

static fg_ratio spread_ratio(double width, double sigma, double dof, double alpha) {
  fg_ratio ratio = {NAN, NAN, NAN};
  if (!isfinite(width) || !(sigma > 0)) return ratio;
  ratio.value = width / (6 * sigma);
  ratio.low = ratio.value * sqrt(fg_distribution_chi2_quantile(alpha / 2, dof) / dof);
  ratio.high = ratio.value * sqrt(fg_distribution_chi2_quantile(1 - alpha / 2, dof) / dof);
  return ratio;
}

static fg_ratio room_ratio(double distance, double sigma, double count, double dof, double alpha) {
  fg_ratio ratio = {NAN, NAN, NAN};
  if (!(sigma > 0)) return ratio;
  ratio.value = distance / (3 * sigma);
  double z = fg_distribution_normal_quantile(1 - alpha / 2);
  double reach = z * sqrt(1 / (9 * count) + ratio.value * ratio.value / (2 * dof));
  ratio.low = ratio.value - reach;
  ratio.high = ratio.value + reach;
  return ratio;
}

/* Pp and Ppk of values in groups: the ratio stays that of all values, its interval is that of the
 * groups. */
static void apply_groups(const spread *s, double width, double distance, double alpha,
                         fg_capability *capability) {
  double z = fg_distribution_normal_quantile(1 - alpha / 2), k = distance / (3 * s->sd);
  double mean = z / (3 * sqrt(s->mean_count));
  double low = distance / 3 / (distance > 0 ? s->sd_high : s->sd_low);
  double high = distance / 3 / (distance > 0 ? s->sd_low : s->sd_high);
  capability->p = (fg_ratio){NAN, NAN, NAN};
  if (isfinite(width))
    capability->p =
        (fg_ratio){width / (6 * capability->sd), width / (6 * s->sd_high), width / (6 * s->sd_low)};
  capability->pk = (fg_ratio){distance / (3 * capability->sd), k - hypot(mean, k - low),
                              k + hypot(mean, high - k)};
}

static void apply_quantiles(const fg_capability_input *input, fg_capability *capability) {
  static const double probability[3] = {0.00135, 0.5, 0.99865};
  double *x = capability->quantile;
  for (int i = 0; i < 3; i++)
    x[i] = fg_density_quantile(input->density, probability[i]);
  if (isfinite(input->upper - input->lower))
    capability->quantile_p = (input->upper - input->lower) / (x[2] - x[0]);
  capability->quantile_pk =
      fmin((input->upper - x[1]) / (x[2] - x[1]), (x[1] - input->lower) / (x[1] - x[0]));
}

fg_status fg_capability_compute(fg_context *ctx, const fg_capability_input *input,
                                fg_capability *capability) {
  const fg_ratio unknown = {NAN, NAN, NAN};
  double alpha = 1 - (input->confidence > 0 ? input->confidence : 0.95);
  double n = (double)input->count, width = input->upper - input->lower;
  *capability = (fg_capability){.count = input->count,
                                .c = unknown,
                                .ck = unknown,
                                .quantile_p = NAN,
                                .quantile_pk = NAN,
                                .quantile = {NAN, NAN, NAN},
                                .stable = input->stable};
  if (!isfinite(input->lower) && !isfinite(input->upper))
    return fg_fail(ctx, FG_ERR_USAGE, "a capability needs a limit");
  find_mean_and_sd(input->values, input->count, &capability->mean, &capability->sd);
  if (!(capability->sd > 0))
    return fg_fail(ctx, FG_ERR_DATA, "a capability needs two different values at least");
  double distance = fg_margin_to(input->lower, input->upper, capability->mean).inside;
  capability->p = spread_ratio(width, capability->sd, n - 1, alpha);
  capability->pk = room_ratio(distance, capability->sd, n, n - 1, alpha);
  if (has_groups(input->groups) && is_one_group(input->groups)) {
    /* One group does not tell how groups differ. */
    capability->p.low = capability->p.high = capability->pk.low = capability->pk.high = NAN;
  } else if (has_groups(input->groups)) {
    spread s = grouped_spread(input, capability->mean, alpha);
    apply_groups(&s, width, distance, alpha, capability);
    n = fmin(n, s.mean_count);
  }
  if (input->stable && input->sigma > 0) {
    capability->c = spread_ratio(width, input->sigma, input->sigma_dof, alpha);
    capability->ck = room_ratio(distance, input->sigma, n, input->sigma_dof, alpha);
  }
  FG_TRY(fg_normality_test_groups(ctx, input->values, input->count, input->groups,
                                  &capability->normality));
  capability->normal = !(capability->normality.p_value < 0.05);
  if (input->density) apply_quantiles(input, capability);
  return FG_OK;
}

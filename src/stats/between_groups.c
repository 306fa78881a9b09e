/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stats/between_groups.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "foilgauge/distribution.h"

/* Halvings of the interval of tau²: more than a double has digits. */
enum { STEPS = 60 };

static double centre_at(const fg_group_mean *groups, size_t count, double tau2, double *weight) {
  double sum = 0, weights = 0;
  for (size_t i = 0; i < count; i++) {
    double w = 1 / (tau2 + groups[i].variance);
    weights += w;
    sum += w * (groups[i].mean - groups[0].mean);
  }
  *weight = weights;
  return groups[0].mean + sum / weights; /* equal means have it to the bit */
}

/* Falls as tau² grows. */
static double spread_at(const fg_group_mean *groups, size_t count, double tau2) {
  double weight, centre = centre_at(groups, count, tau2, &weight), sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += (groups[i].mean - centre) * (groups[i].mean - centre) / (tau2 + groups[i].variance);
  return sum;
}

/* Finds tau² at which the spread equals `target`; 0 when it is smaller already at 0. `high` is an
 * upper bound. */
static double solve_tau_square(const fg_group_mean *groups, size_t count, double target) {
  double low = 0, high = 0, min = groups[0].mean, max = min;
  for (size_t i = 1; i < count; i++) {
    min = fmin(min, groups[i].mean);
    max = fmax(max, groups[i].mean);
  }
  /* At tau² = k range² / target the sum is at most k range² / tau² = target. */
  high = (double)count * (max - min) * (max - min) / target;
  double tiny = 1e-12 * high; /* variances of nothing: the sum at 0 would be infinite */
  if (!(high > 0) || spread_at(groups, count, tiny) <= target) return 0;
  for (int i = 0; i < STEPS; i++) {
    double middle = (low + high) / 2;
    if (spread_at(groups, count, fmax(middle, tiny)) > target)
      low = middle;
    else
      high = middle;
  }
  return (low + high) / 2;
}

fg_between fg_between_groups(const fg_group_mean *groups, size_t count, double confidence) {
  fg_between result = {NAN, NAN, NAN, NAN, NAN};
  if (count < 2) return result;
  double weight, dof = (double)count - 1, tau2 = solve_tau_square(groups, count, dof);
  result.sd = sqrt(tau2);
  result.sd_low = sqrt(
      solve_tau_square(groups, count, fg_distribution_chi2_quantile((1 + confidence) / 2, dof)));
  result.sd_high = sqrt(
      solve_tau_square(groups, count, fg_distribution_chi2_quantile((1 - confidence) / 2, dof)));
  result.centre = centre_at(groups, count, fmax(tau2, 1e-300), &weight);
  result.u_centre = 1 / sqrt(weight);
  return result;
}

double fg_between_reach(const fg_between *between, size_t count, double variance,
                        double confidence) {
  if (count < 2) return NAN;
  double t = fg_distribution_t_quantile((1 + confidence) / 2, (double)count - 1);
  return t * sqrt(between->sd * between->sd + variance + between->u_centre * between->u_centre);
}

typedef struct ranked {
  double p;
  size_t place;
} ranked;

static int compare_p(const void *left, const void *right) {
  const ranked *a = left, *b = right;
  if (a->p != b->p) return a->p < b->p ? -1 : 1;
  return a->place < b->place ? -1 : a->place > b->place;
}

fg_status fg_holm_adjust(fg_context *ctx, const double *p, size_t count, double *adjusted) {
  void *block;
  size_t members = 0;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof(ranked), &block));
  ranked *list = block;
  for (size_t i = 0; i < count; i++) {
    adjusted[i] = NAN;
    if (!isnan(p[i])) list[members++] = (ranked){p[i], i};
  }
  fg_sort_items(list, members, sizeof *list, compare_p);
  double max = 0;
  for (size_t i = 0; i < members; i++) {
    max = fmax(max, fmin(1, (double)(members - i) * list[i].p));
    adjusted[list[i].place] = max;
  }
  free(list);
  return FG_OK;
}

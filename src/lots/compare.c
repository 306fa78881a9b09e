/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Comparison of lots: pairs that differ beyond the scatter of their foils, and lots whose mean the
 * other lots do not make likely. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/text.h"
#include "foilgauge/distribution.h"
#include "lot/statistics/analysis.h"
#include "lots/index.h"

void fg_index_welch(fg_index_pair *pair, const double mean[2], const double u[2],
                    const double dof[2]) {
  const double squares[2] = {u[0] * u[0], u[1] * u[1]};
  double sum = squares[0] + squares[1], shares = 0;
  for (int i = 0; i < 2; i++)
    if (squares[i] > 0) shares += squares[i] * squares[i] / dof[i];
  pair->difference = mean[0] - mean[1];
  pair->u = sqrt(sum);
  pair->dof = sum * sum / shares; /* Welch and Satterthwaite */
  pair->p = fg_distribution_t_two_sided(pair->difference / pair->u, pair->dof);
  double reach = pair->u * fg_distribution_t_quantile((1 + FG_INDEX_CONFIDENCE) / 2, pair->dof);
  pair->low = pair->difference - reach;
  pair->high = pair->difference + reach;
}

static int compare_texts(const void *left, const void *right) {
  return strcmp(left, right);
}

/* Both lists are sorted. */
static size_t count_shared(const fg_index_lot *a, const fg_index_lot *b) {
  size_t shared = 0;
  for (size_t i = 0, k = 0; i < a->scan_sums && k < b->scan_sums;) {
    int order = strcmp(a->scan_sum[i], b->scan_sum[k]);
    shared += order == 0;
    i += order <= 0;
    k += order >= 0;
  }
  return shared;
}

/* Marks pairs of lots that share scans: their likeness is no evidence. */
static fg_status mark_shared(fg_context *ctx, fg_index *index, bool *shared) {
  for (size_t i = 0; i < index->read; i++)
    if (index->lots[i].scan_sums)
      fg_sort_items(index->lots[i].scan_sum, index->lots[i].scan_sums,
                    sizeof *index->lots[i].scan_sum, compare_texts);
  for (size_t i = 0; i < index->read; i++)
    for (size_t k = i + 1; k < index->read; k++) {
      size_t scans = count_shared(&index->lots[i], &index->lots[k]);
      shared[i * index->read + k] = shared[k * index->read + i] = scans > 0;
      if (scans)
        FG_TRY(fg_text_append(ctx, &index->notes,
                              "%s and %s share %zu scans: they are not compared with each other\n",
                              index->lots[i].folder, index->lots[k].folder, scans));
    }
  return FG_OK;
}

static bool is_comparable(const fg_index_axis *axis) {
  return axis->scale != FG_INDEX_APART && axis->same_as == FG_INDEX_NONE;
}

static fg_status add_pair(fg_context *ctx, fg_index *index, size_t axis, size_t first,
                          size_t second) {
  const fg_index_stat *stat[2] = {fg_index_stat_of(&index->axes[axis], &index->lots[first]),
                                  fg_index_stat_of(&index->axes[axis], &index->lots[second])};
  if (!stat[0] || !stat[1] || stat[0]->foils < 2 || stat[1]->foils < 2) return FG_OK;
  bool swapped = stat[0]->foil_mean < stat[1]->foil_mean;
  const fg_index_stat *a = stat[swapped], *b = stat[!swapped];
  fg_index_pair pair = {.axis = axis,
                        .a = swapped ? second : first,
                        .b = swapped ? first : second,
                        .foils_a = a->foils,
                        .foils_b = b->foils,
                        .p_holm = NAN};
  const double mean[2] = {a->foil_mean, b->foil_mean},
               u[2] = {a->foil_sd / sqrt((double)a->foils), b->foil_sd / sqrt((double)b->foils)},
               dof[2] = {(double)a->foils - 1, (double)b->foils - 1};
  if (!(u[0] + u[1] > 0)) return FG_OK; /* no test without scatter */
  fg_index_welch(&pair, mean, u, dof);
  FG_TRY(fg_memory_reserve(ctx, index->pair_count + 1, sizeof *index->pairs, &index->pair_capacity,
                           (void **)&index->pairs));
  index->pairs[index->pair_count++] = pair;
  return FG_OK;
}

static int compare_pair_p(const void *left, const void *right) {
  const fg_index_pair *a = left, *b = right;
  if (a->p != b->p) return a->p < b->p ? -1 : 1;
  if (a->axis != b->axis) return a->axis < b->axis ? -1 : 1;
  if (a->a != b->a) return a->a < b->a ? -1 : 1;
  return a->b < b->b ? -1 : a->b > b->b;
}

static fg_status adjust_pairs(fg_context *ctx, fg_index *index) {
  double *p = NULL;
  FG_TRY(fg_memory_allocate(ctx, 2 * index->pair_count, sizeof *p, (void **)&p));
  fg_sort_items(index->pairs, index->pair_count, sizeof *index->pairs, compare_pair_p);
  for (size_t i = 0; i < index->pair_count; i++)
    p[i] = index->pairs[i].p;
  double *adjusted = p + index->pair_count;
  fg_status status = fg_holm_adjust(ctx, p, index->pair_count, adjusted);
  for (size_t i = 0; i < index->pair_count && status == FG_OK; i++) {
    index->pairs[i].p_holm = adjusted[i];
    index->differing += adjusted[i] < 1 - FG_INDEX_CONFIDENCE;
  }
  free(p);
  return status;
}

static fg_status compare_pairs(fg_context *ctx, fg_index *index) {
  bool *shared = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, index->read * index->read, sizeof *shared, (void **)&shared));
  FG_TRY_EXIT(mark_shared(ctx, index, shared));
  for (size_t axis = 0; axis < index->axis_count; axis++)
    for (size_t a = 0; a < index->read && is_comparable(&index->axes[axis]); a++)
      for (size_t b = a + 1; b < index->read; b++)
        if (!shared[a * index->read + b]) FG_TRY_EXIT(add_pair(ctx, index, axis, a, b));
  FG_TRY_EXIT(adjust_pairs(ctx, index));
exit:
  free(shared);
  return status;
}

/* Pools the scatter of foils within their lots, and tests whether the lots' means scatter by more.
 */
static void analyse_variance(const fg_index *index, fg_index_axis *axis) {
  double n = 0, sum = 0, squares = 0, within = 0, between = 0, first = NAN;
  for (size_t i = 0; i < index->read; i++) {
    const fg_index_stat *stat = fg_index_stat_of(axis, &index->lots[i]);
    if (!stat || !stat->foils) continue;
    if (isnan(first)) first = stat->foil_mean;
    double foils = (double)stat->foils, mean = stat->foil_mean - first;
    axis->lots++;
    n += foils;
    sum += foils * mean;
    squares += foils * mean * mean;
    if (stat->foils > 1) within += (foils - 1) * stat->foil_sd * stat->foil_sd;
  }
  double lots = (double)axis->lots;
  if (!(n > lots)) return; /* one foil each: the scatter within lots is unknown */
  between = fmax(0, squares - sum * sum / n);
  axis->within_sd = sqrt(within / (n - lots));
  if (axis->lots > 1 && within > 0)
    axis->p_equal =
        fg_distribution_f_upper(between / (lots - 1) / (within / (n - lots)), lots - 1, n - lots);
}

/* Compares each lot with the interval that the others give. */
static void expect_means(const fg_index_axis *axis, fg_index_stat **stat,
                         const fg_group_mean *groups, fg_group_mean *others) {
  for (size_t i = 0; i < axis->lots; i++) {
    memcpy(others, groups, i * sizeof *others);
    memcpy(others + i, groups + i + 1, (axis->lots - i - 1) * sizeof *others);
    fg_between rest = fg_between_groups(others, axis->lots - 1, FG_INDEX_CONFIDENCE);
    double reach = fg_between_reach(&rest, axis->lots - 1, groups[i].variance, FG_INDEX_EXPECTED);
    stat[i]->expected_low = rest.centre - reach;
    stat[i]->expected_high = rest.centre + reach;
    stat[i]->unexpected = fabs(stat[i]->foil_mean - rest.centre) > reach;
  }
}

static fg_status analyse_axis(fg_context *ctx, fg_index *index, fg_index_axis *axis) {
  fg_group_mean *groups = NULL;
  fg_index_stat **stats = NULL;
  fg_status status = FG_OK;
  axis->between = fg_between_groups(NULL, 0, FG_INDEX_CONFIDENCE);
  if (axis->scale == FG_INDEX_APART) return FG_OK;
  analyse_variance(index, axis);
  FG_TRY_EXIT(fg_memory_allocate(ctx, 2 * axis->lots, sizeof *groups, (void **)&groups));
  FG_TRY_EXIT(fg_memory_allocate(ctx, axis->lots, sizeof *stats, (void **)&stats));
  double within = isfinite(axis->within_sd) ? axis->within_sd : 0;
  for (size_t i = 0, at = 0; i < index->read; i++) {
    fg_index_stat *stat = fg_index_stat_of(axis, &index->lots[i]);
    if (!stat || !stat->foils) continue;
    groups[at] = (fg_group_mean){stat->foil_mean, within * within / (double)stat->foils};
    stats[at++] = stat;
  }
  axis->between = fg_between_groups(groups, axis->lots, FG_INDEX_CONFIDENCE);
  if (axis->lots >= FG_INDEX_LOTS_MIN) expect_means(axis, stats, groups, groups + axis->lots);
exit:
  free(groups);
  free(stats);
  return status;
}

fg_status fg_index_compare(fg_context *ctx, fg_index *index) {
  for (size_t i = 0; i < index->axis_count; i++)
    FG_TRY(analyse_axis(ctx, index, &index->axes[i]));
  return compare_pairs(ctx, index);
}

static fg_status describe_ratios(fg_context *ctx, const double *values, size_t count,
                                 fg_index_spread *spread) {
  fg_lot_settings settings;
  fg_lot_spread s;
  fg_lot_settings_default(&settings);
  FG_TRY(fg_lot_find_spread(ctx, values, count, settings.bandwidth, &s));
  *spread = (fg_index_spread){.count = count,
                              .mean = s.mean,
                              .mode = s.mode,
                              .relative_sd_pct = s.relative_sd_pct,
                              .min = s.min,
                              .max = s.max};
  /* Values that differ only in their last digits have no density. */
  if (!(s.relative_sd_pct > 1e-7)) return FG_OK;
  spread->has_density = true;
  return fg_density_fit(ctx, values, count, settings.bandwidth, &spread->density);
}

static size_t gather_die_ratios(const fg_index *index, size_t die, double *values) {
  size_t count = 0;
  for (size_t i = 0; i < index->read; i++) {
    const fg_index_lot *lot = &index->lots[i];
    for (size_t k = 0; k < lot->ratios; k++)
      if (lot->die[lot->ratio_foil[k]] == die) values[count++] = lot->ratio[k];
  }
  return count;
}

static void count_die_ratios(const fg_index *index, size_t die) {
  for (size_t i = 0; i < index->read; i++) {
    size_t foils = 0;
    for (size_t k = 0; k < index->lots[i].foil_count; k++)
      foils += index->lots[i].die[k] == die;
    index->dies[die].foils += foils;
    index->dies[die].lots += foils > 0;
  }
}

fg_status fg_index_spreads(fg_context *ctx, fg_index *index) {
  size_t all = 0;
  double *values = NULL;
  fg_status status = FG_OK;
  for (size_t i = 0; i < index->read; i++) {
    fg_index_lot *lot = &index->lots[i];
    all += lot->ratios;
    FG_TRY(describe_ratios(ctx, lot->ratio, lot->ratios, &lot->spread));
  }
  FG_TRY(fg_memory_allocate(ctx, all, sizeof *values, (void **)&values));
  for (size_t die = 0; die < index->die_count && status == FG_OK; die++) {
    count_die_ratios(index, die);
    status = describe_ratios(ctx, values, gather_die_ratios(index, die, values),
                             &index->dies[die].spread);
  }
  free(values);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Comparison of the groups of a lot (dies, coils). */
#include <gsl/gsl_sf_psi.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/spread.h"
#include "lot/statistics/analysis.h"
#include "lot/statistics/foil_levels.h"
#include "stats/between_groups.h"
#include "stats/relabelled_spread.h"

/* Relabellings for a test of the page: Holm divides 5 % by the number of tests, and the smallest p
 * must be well below that. */
enum { DRAWS_PER_TEST = 200, DRAWS_MIN = 9999 };

/* Foils of the lot with their groups. */
typedef struct grouping {
  const fg_manifest_words *words;
  size_t *group, *owner; /* by foil of the analysis */
  size_t draws, pairs;   /* of groups */
  fg_lot_analysis *analysis;
  size_t *differences; /* number of each quantity; they begin at a multiple of `pairs` */
} grouping;

/* Quantity whose groups are compared. */
typedef struct comparing {
  const fg_lot_analysis *analysis;
  const fg_lot_quantity *quantity;
  fg_foil_levels levels;
  double *values; /* room for two samples */
} comparing;

static double sd_about_mean(const double *values, size_t count, double mean) {
  return sqrt(fg_squares_about(values, count, mean) / (double)(count - 1));
}

static size_t select_levels(const fg_foil_levels *levels, size_t group, double *values,
                            size_t *parts) {
  size_t count = 0;
  *parts = 0;
  for (size_t i = 0; i < levels->count; i++) {
    if (levels->foil[i].group != group) continue;
    values[count++] = levels->foil[i].level;
    *parts += levels->foil[i].values;
  }
  return count;
}

/* Selects ln s of the foils' parts. ln s of n values is biased by -(ln(nu / 2) - psi(nu / 2)) / 2,
 * nu = n - 1. */
static size_t select_within(const fg_foil_levels *levels, size_t group, double *values,
                            double *pooled) {
  size_t count = 0;
  double squares = 0, dof = 0;
  for (size_t i = 0; i < levels->count; i++) {
    const fg_foil_level *foil = &levels->foil[i];
    if (foil->group != group || isnan(foil->within_sd)) continue;
    double nu = (double)foil->values - 1;
    squares += nu * foil->within_sd * foil->within_sd;
    dof += nu;
    if (foil->within_sd > 0)
      values[count++] = log(foil->within_sd) + (log(nu / 2) - gsl_sf_psi(nu / 2)) / 2;
  }
  *pooled = sqrt(squares / dof);
  return count;
}

/* Skips samples that are too few, or that do not scatter. */
static fg_status compare_samples(const double *values, size_t a, size_t b, double confidence,
                                 fg_comparison *comparison, bool *compared) {
  fg_context unused;
  fg_status status = fg_comparison_compute(&unused, (fg_sample){values, a},
                                           (fg_sample){values + a, b}, confidence, comparison);
  *compared = status == FG_OK;
  return status == FG_ERR_DATA ? FG_OK : status;
}

static fg_status compare_within(const comparing *of, size_t a, size_t b,
                                fg_lot_difference *difference) {
  fg_comparison comparison;
  bool compared;
  size_t first = select_within(&of->levels, a, of->values, &difference->within_sd_a),
         second = select_within(&of->levels, b, of->values + first, &difference->within_sd_b);
  FG_TRY(compare_samples(of->values, first, second, of->analysis->lot->settings.confidence,
                         &comparison, &compared));
  if (compared) difference->p[FG_LOT_TEST_WITHIN] = comparison.p_means;
  return FG_OK;
}

/* *compared is false for samples that are skipped. */
static fg_status compare_pair(fg_context *ctx, const comparing *of, const grouping *by, size_t a,
                              size_t b, fg_lot_difference *d, bool *compared) {
  fg_relabelled_spread spread;
  *d = (fg_lot_difference){
      .quantity = of->quantity, .a = by->words->word[a], .b = by->words->word[b]};
  d->within_sd_a = d->within_sd_b = NAN;
  for (size_t t = 0; t < FG_LOT_GROUP_TESTS; t++)
    d->p[t] = d->p_holm[t] = NAN;
  d->foils_a = select_levels(&of->levels, a, of->values, &d->count_a);
  double *second = of->values + d->foils_a;
  d->foils_b = select_levels(&of->levels, b, second, &d->count_b);
  FG_TRY(compare_samples(of->values, d->foils_a, d->foils_b, of->analysis->lot->settings.confidence,
                         &d->comparison, compared));
  if (!*compared) return FG_OK;
  d->mean_a = fg_mean(of->values, d->foils_a);
  d->mean_b = fg_mean(second, d->foils_b);
  d->sd_a = sd_about_mean(of->values, d->foils_a, d->mean_a);
  d->sd_b = sd_about_mean(second, d->foils_b, d->mean_b);
  FG_TRY(fg_relabel_spreads(ctx, (fg_sample){of->values, d->foils_a},
                            (fg_sample){second, d->foils_b}, by->draws, &spread));
  d->p[FG_LOT_TEST_MEANS] = d->comparison.p_means;
  d->p[FG_LOT_TEST_VARIANCES] = spread.p_variances;
  d->p[FG_LOT_TEST_LEVENE] = spread.p_levene;
  return fg_owner_is_part(of->quantity->owner) ? compare_within(of, a, b, d) : FG_OK;
}

static fg_status compare_quantity(fg_context *ctx, void *shared, size_t i) {
  const grouping *by = shared;
  comparing of = {.analysis = by->analysis, .quantity = &by->analysis->quantities[i]};
  fg_lot_difference *differences = by->analysis->differences + i * by->pairs;
  fg_status status = FG_OK;
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, 2 * of.analysis->foil_count, sizeof *of.values, (void **)&of.values));
  FG_TRY_EXIT(fg_foil_levels_make(ctx, of.analysis, of.quantity, by->group, by->owner, &of.levels));
  for (size_t a = 0; a < by->words->count; a++)
    for (size_t b = a + 1; b < by->words->count; b++) {
      bool compared;
      FG_TRY_EXIT(compare_pair(ctx, &of, by, a, b, &differences[by->differences[i]], &compared));
      by->differences[i] += compared;
    }
exit:
  fg_foil_levels_free(&of.levels);
  free(of.values);
  return status;
}

/* Leaves out the room of pairs that were skipped. */
static void join_differences(const grouping *by) {
  fg_lot_analysis *analysis = by->analysis;
  for (size_t i = 0; i < analysis->quantity_count; i++) {
    memmove(analysis->differences + analysis->difference_count,
            analysis->differences + i * by->pairs,
            by->differences[i] * sizeof *analysis->differences);
    analysis->difference_count += by->differences[i];
  }
}

static fg_status compare_quantities(fg_context *ctx, grouping *by) {
  fg_lot_analysis *analysis = by->analysis;
  free(analysis->differences); /* of an earlier comparison */
  analysis->difference_count = 0;
  FG_TRY(fg_memory_allocate(ctx, analysis->quantity_count * by->pairs,
                            sizeof *analysis->differences, (void **)&analysis->differences));
  FG_TRY(
      fg_parallel_run(ctx, analysis->lot->threads, analysis->quantity_count, compare_quantity, by));
  join_differences(by);
  return FG_OK;
}

/* Adjusts all tests as one family, for a reader looks for the smallest p of the page. */
static fg_status adjust_p_values(fg_context *ctx, fg_lot_analysis *analysis) {
  size_t count = analysis->difference_count * FG_LOT_GROUP_TESTS;
  double *p = NULL;
  FG_TRY(fg_memory_allocate(ctx, 2 * count, sizeof *p, (void **)&p));
  for (size_t i = 0; i < analysis->difference_count; i++)
    memcpy(p + i * FG_LOT_GROUP_TESTS, analysis->differences[i].p, sizeof analysis->differences->p);
  fg_status status = fg_holm_adjust(ctx, p, count, p + count);
  analysis->group_tests = analysis->group_tests_differ = 0;
  for (size_t i = 0; i < analysis->difference_count && status == FG_OK; i++)
    for (size_t t = 0; t < FG_LOT_GROUP_TESTS; t++) {
      double adjusted = p[count + i * FG_LOT_GROUP_TESTS + t];
      analysis->differences[i].p_holm[t] = adjusted;
      if (!isnan(adjusted)) analysis->group_tests++;
      if (fg_lot_group_differs(analysis, adjusted)) analysis->group_tests_differ++;
    }
  free(p);
  return status;
}

bool fg_lot_group_differs(const fg_lot_analysis *analysis, double p_holm) {
  return p_holm < 1 - analysis->lot->settings.confidence;
}

static fg_status compare_groups(fg_context *ctx, fg_lot_analysis *analysis, size_t column,
                                const fg_manifest_words *words) {
  grouping by = {
      .words = words, .pairs = words->count * (words->count - 1) / 2, .analysis = analysis};
  fg_status status = FG_OK;
  size_t foils = analysis->foil_count;
  size_t draws = (size_t)DRAWS_PER_TEST * FG_LOT_GROUP_TESTS * by.pairs * analysis->quantity_count;
  by.draws = draws > DRAWS_MIN ? draws : DRAWS_MIN;
  FG_TRY_EXIT(fg_memory_allocate(ctx, foils, sizeof *by.group, (void **)&by.group));
  FG_TRY_EXIT(fg_memory_allocate(ctx, foils, sizeof *by.owner, (void **)&by.owner));
  FG_TRY_EXIT(fg_memory_allocate(ctx, analysis->quantity_count, sizeof *by.differences,
                                 (void **)&by.differences));
  FG_TRY_EXIT(fg_lot_find_owners(ctx, analysis, by.owner));
  for (size_t i = 0; i < foils; i++) {
    const char *word = fg_manifest_cell(&analysis->lot->manifest, analysis->foils[i].item, column);
    by.group[i] = FG_NO_COLUMN;
    for (size_t g = 0; g < words->count; g++)
      if (!strcmp(words->word[g], word)) by.group[i] = g;
  }
  FG_TRY_EXIT(compare_quantities(ctx, &by));
  FG_TRY_EXIT(adjust_p_values(ctx, analysis));
exit:
  free(by.group);
  free(by.owner);
  free(by.differences);
  return status;
}

fg_status fg_lot_analyse_groups(fg_context *ctx, fg_lot_analysis *analysis) {
  const fg_lot *lot = analysis->lot;
  size_t column = fg_manifest_column(&lot->manifest, lot->settings.group_column);
  void *block;
  if (column == FG_NO_COLUMN && lot->settings.group_column[0])
    return fg_fail(ctx, FG_ERR_DATA, "group_column (--group): the manifest has no column '%s'",
                   lot->settings.group_column);
  if (column == FG_NO_COLUMN) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(fg_manifest_words), &block));
  fg_manifest_words *words = block;
  fg_lot_list_words(analysis, column, words);
  fg_status status = FG_OK;
  if (words->count > FG_LOT_GROUPS_MAX)
    status = fg_fail(ctx, FG_ERR_DATA, "group_column '%s' has %zu groups; at most %d are compared",
                     lot->settings.group_column, words->count, FG_LOT_GROUPS_MAX);
  else if (words->count > 1)
    status = compare_groups(ctx, analysis, column, words);
  free(words);
  return status;
}

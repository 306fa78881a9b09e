/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Comparison of the groups of a lot (dies, coils). */
#include <gsl/gsl_sf_psi.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
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
  double *values;        /* room for two samples */
  size_t draws;
} grouping;

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

static fg_status compare_within(const fg_lot_analysis *analysis, const fg_foil_levels *levels,
                                const grouping *by, size_t a, size_t b,
                                fg_lot_difference *difference) {
  fg_comparison comparison;
  bool compared;
  size_t first = select_within(levels, a, by->values, &difference->within_sd_a),
         second = select_within(levels, b, by->values + first, &difference->within_sd_b);
  FG_TRY(compare_samples(by->values, first, second, analysis->lot->settings.confidence, &comparison,
                         &compared));
  if (compared) difference->p[FG_LOT_TEST_WITHIN] = comparison.p_means;
  return FG_OK;
}

static fg_status add_difference(fg_context *ctx, fg_lot_analysis *analysis,
                                const fg_lot_difference *difference) {
  FG_TRY(fg_memory_reserve(ctx, analysis->difference_count + 1, sizeof *analysis->differences,
                           &analysis->difference_capacity, (void **)&analysis->differences));
  analysis->differences[analysis->difference_count++] = *difference;
  return FG_OK;
}

static fg_status compare_pair(fg_context *ctx, fg_lot_analysis *analysis,
                              const fg_lot_quantity *quantity, const fg_foil_levels *levels,
                              const grouping *by, size_t a, size_t b) {
  fg_lot_difference d = {.quantity = quantity, .a = by->words->word[a], .b = by->words->word[b]};
  fg_relabelled_spread spread;
  bool compared;
  d.within_sd_a = d.within_sd_b = NAN;
  for (size_t t = 0; t < FG_LOT_GROUP_TESTS; t++)
    d.p[t] = d.p_holm[t] = NAN;
  d.foils_a = select_levels(levels, a, by->values, &d.count_a);
  double *second = by->values + d.foils_a;
  d.foils_b = select_levels(levels, b, second, &d.count_b);
  FG_TRY(compare_samples(by->values, d.foils_a, d.foils_b, analysis->lot->settings.confidence,
                         &d.comparison, &compared));
  if (!compared) return FG_OK;
  d.mean_a = fg_mean(by->values, d.foils_a);
  d.mean_b = fg_mean(second, d.foils_b);
  d.sd_a = sd_about_mean(by->values, d.foils_a, d.mean_a);
  d.sd_b = sd_about_mean(second, d.foils_b, d.mean_b);
  FG_TRY(fg_relabel_spreads(ctx, (fg_sample){by->values, d.foils_a}, (fg_sample){second, d.foils_b},
                            by->draws, &spread));
  d.p[FG_LOT_TEST_MEANS] = d.comparison.p_means;
  d.p[FG_LOT_TEST_VARIANCES] = spread.p_variances;
  d.p[FG_LOT_TEST_LEVENE] = spread.p_levene;
  if (fg_owner_is_part(quantity->owner)) FG_TRY(compare_within(analysis, levels, by, a, b, &d));
  return add_difference(ctx, analysis, &d);
}

static fg_status compare_quantity(fg_context *ctx, fg_lot_analysis *analysis,
                                  const fg_lot_quantity *quantity, const grouping *by) {
  fg_foil_levels levels;
  FG_TRY(fg_foil_levels_make(ctx, analysis, quantity, by->group, by->owner, &levels));
  fg_status status = FG_OK;
  for (size_t a = 0; a < by->words->count; a++)
    for (size_t b = a + 1; b < by->words->count && status == FG_OK; b++)
      status = compare_pair(ctx, analysis, quantity, &levels, by, a, b);
  fg_foil_levels_free(&levels);
  return status;
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
  grouping by = {.words = words};
  fg_status status = FG_OK;
  size_t foils = analysis->foil_count, pairs = words->count * (words->count - 1) / 2;
  size_t draws = (size_t)DRAWS_PER_TEST * FG_LOT_GROUP_TESTS * pairs * analysis->quantity_count;
  by.draws = draws > DRAWS_MIN ? draws : DRAWS_MIN;
  FG_TRY_EXIT(fg_memory_allocate(ctx, foils, sizeof *by.group, (void **)&by.group));
  FG_TRY_EXIT(fg_memory_allocate(ctx, foils, sizeof *by.owner, (void **)&by.owner));
  FG_TRY_EXIT(fg_memory_allocate(ctx, 2 * foils, sizeof *by.values, (void **)&by.values));
  FG_TRY_EXIT(fg_lot_find_owners(ctx, analysis, by.owner));
  for (size_t i = 0; i < foils; i++) {
    const char *word = fg_manifest_cell(&analysis->lot->manifest, analysis->foils[i].item, column);
    by.group[i] = FG_NO_COLUMN;
    for (size_t g = 0; g < words->count; g++)
      if (!strcmp(words->word[g], word)) by.group[i] = g;
  }
  for (size_t q = 0; q < analysis->quantity_count; q++)
    FG_TRY_EXIT(compare_quantity(ctx, analysis, &analysis->quantities[q], &by));
  FG_TRY_EXIT(adjust_p_values(ctx, analysis));
exit:
  free(by.group);
  free(by.owner);
  free(by.values);
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

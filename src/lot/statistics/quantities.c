/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statistics of each quantity. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/spread.h"
#include "foilgauge/distribution.h"
#include "lot/statistics/analysis.h"
#include "quantity/quantity_rows.h"

static bool is_quantity_listed(const fg_lot_analysis *analysis, const fg_quantity *row) {
  for (size_t i = 0; i < analysis->quantity_count; i++)
    if (analysis->quantities[i].row == row) return true;
  return false;
}

static void list_quantity(fg_lot_analysis *analysis, fg_quantity_owner owner,
                          const fg_quantity *row) {
  if (!row || is_quantity_listed(analysis, row)) return;
  const fg_design *design = &analysis->lot->settings.design;
  fg_lot_quantity *quantity = &analysis->quantities[analysis->quantity_count++];
  *quantity = (fg_lot_quantity){.row = row, .owner = owner, .mode = NAN};
  for (size_t i = 0; i < design->tolerance_count; i++)
    if (!strcmp(design->tolerances[i].quantity, row->name))
      quantity->tolerance = &design->tolerances[i];
}

/* Lists the quantities that every report shows, then those with a tolerance. */
static fg_status list_quantities(fg_context *ctx, fg_lot_analysis *analysis) {
  const fg_quantity_owner owners[] = {analysis->parts, FG_QUANTITY_OF_FOIL};
  enum { OWNERS = sizeof owners / sizeof owners[0] };
  const fg_design *design = &analysis->lot->settings.design;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, OWNERS * (FG_QUANTITY_SHOWN_MAX + FG_TOLERANCES_MAX),
                            sizeof *analysis->quantities, &block));
  analysis->quantities = block;
  for (size_t o = 0; o < OWNERS; o++) {
    const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX];
    size_t count = fg_quantity_shown(owners[o], FG_QUANTITY_IN_LOT, design->kind, shown);
    for (size_t i = 0; i < count; i++)
      list_quantity(analysis, owners[o], shown[i]);
  }
  for (size_t i = 0; i < design->tolerance_count; i++)
    for (size_t o = 0; o < OWNERS; o++)
      list_quantity(analysis, owners[o],
                    fg_quantity_find(owners[o], design->tolerances[i].quantity));
  return FG_OK;
}

static void append_value(fg_lot_quantity *quantity, size_t foil, double value) {
  if (!isfinite(value)) return;
  quantity->value[quantity->count++] = value;
  quantity->size[foil]++;
}

static fg_status collect_values(fg_context *ctx, const fg_lot_analysis *analysis,
                                fg_lot_quantity *quantity) {
  size_t max = 0;
  void *block;
  for (size_t i = 0; i < analysis->foil_count; i++)
    max += 1 + fg_part_count(analysis->foils[i].foil, quantity->owner);
  FG_TRY(fg_memory_allocate(ctx, max, sizeof *quantity->value, &block));
  quantity->value = block;
  FG_TRY(fg_memory_allocate(ctx, analysis->foil_count, sizeof *quantity->size, &block));
  quantity->size = block;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_foil *foil = analysis->foils[i].foil;
    if (!fg_foil_is_measured(foil)) continue;
    if (quantity->owner == FG_QUANTITY_OF_FOIL)
      append_value(quantity, i, fg_quantity_value(quantity->row, foil));
    for (size_t k = 0; k < fg_part_count(foil, quantity->owner); k++) {
      const fg_foil_part part = fg_part_at(foil, quantity->owner, k);
      if (fg_lot_part_counts(foil, quantity->owner, &part))
        append_value(quantity, i, fg_quantity_value(quantity->row, part.object));
    }
  }
  return FG_OK;
}

static fg_status find_value_median(fg_context *ctx, const double *values, size_t count,
                                   double *median) {
  void *block;
  *median = NAN;
  if (count == 0) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *values, &block));
  memcpy(block, values, count * sizeof *values);
  *median = fg_median(block, count);
  free(block);
  return FG_OK;
}

static fg_status describe_values(fg_context *ctx, const fg_lot_settings *settings,
                                 fg_lot_quantity *quantity) {
  fg_lot_spread spread;
  FG_TRY(fg_lot_find_spread_and_density(ctx, quantity->value, quantity->count, settings->bandwidth,
                                        &spread, &quantity->density));
  quantity->has_density = quantity->density.count > 0;
  quantity->mean = spread.mean;
  quantity->sd = spread.sd;
  quantity->min = spread.min;
  quantity->max = spread.max;
  quantity->mode = spread.mode;
  return find_value_median(ctx, quantity->value, quantity->count, &quantity->median);
}

static size_t highest_number(const fg_lot_analysis *analysis) {
  int highest = 0;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_foil *foil = analysis->foils[i].foil;
    size_t parts = fg_foil_is_measured(foil) ? fg_part_count(foil, analysis->parts) : 0;
    for (size_t k = 0; k < parts; k++) {
      const fg_foil_part part = fg_part_at(foil, analysis->parts, k);
      int number = fg_lot_part_number(foil, &part);
      highest = number > highest ? number : highest;
    }
  }
  return (size_t)highest;
}

static void add_to_place(fg_lot_place *place, double value) {
  if (!isfinite(value)) return;
  place->count++;
  double step = value - place->mean;
  place->mean += step / (double)place->count;
  place->sd += step * (value - place->mean); /* a sum of squares until all values are added */
}

/* Finds mean and sd of each number over the foils (running sums of Welford). */
static fg_status describe_places(fg_context *ctx, const fg_lot_analysis *analysis,
                                 fg_lot_quantity *quantity) {
  void *block;
  if (!fg_owner_is_part(quantity->owner)) return FG_OK;
  quantity->places = highest_number(analysis);
  FG_TRY(fg_memory_allocate(ctx, quantity->places, sizeof *quantity->place, &block));
  quantity->place = block;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_foil *foil = analysis->foils[i].foil;
    for (size_t k = 0; k < fg_part_count(foil, quantity->owner); k++) {
      const fg_foil_part part = fg_part_at(foil, quantity->owner, k);
      int number = fg_lot_part_number(foil, &part);
      if (number >= 1 && fg_lot_part_counts(foil, quantity->owner, &part))
        add_to_place(&quantity->place[number - 1], fg_quantity_value(quantity->row, part.object));
    }
  }
  for (size_t i = 0; i < quantity->places; i++) {
    fg_lot_place *place = &quantity->place[i];
    place->sd = place->count > 1 ? sqrt(place->sd / (double)(place->count - 1)) : NAN;
    if (!place->count) place->mean = NAN;
  }
  return FG_OK;
}

/* Finds the mean of each foil's values; foils without values are left out. */
static fg_status find_foil_means(fg_context *ctx, const fg_lot_quantity *quantity, size_t foils,
                                 double **means, size_t *count) {
  void *block;
  size_t at = 0;
  FG_TRY(fg_memory_allocate(ctx, foils, sizeof **means, &block));
  *means = block;
  *count = 0;
  for (size_t i = 0; i < foils; i++) {
    double sum = 0;
    for (size_t k = 0; k < quantity->size[i]; k++)
      sum += quantity->value[at + k];
    at += quantity->size[i];
    if (quantity->size[i]) (*means)[(*count)++] = sum / (double)quantity->size[i];
  }
  return FG_OK;
}

fg_status fg_lot_chart_quantity(fg_context *ctx, unsigned rules, size_t foils,
                                fg_lot_quantity *quantity) {
  double *means;
  size_t count;
  FG_TRY(find_foil_means(ctx, quantity, foils, &means, &count));
  fg_status status = FG_OK;
  quantity->has_chart = count >= 2;
  if (quantity->has_chart)
    status = fg_chart_individuals(ctx, means, count, rules, &quantity->chart);
  free(means);
  FG_TRY(status);
  fg_context unused;
  quantity->has_subgroups =
      fg_owner_is_part(quantity->owner) &&
      fg_chart_subgroups(&unused, quantity->value, quantity->size, foils, FG_SIGMA_FROM_SD, rules,
                         &quantity->means, &quantity->deviations) == FG_OK;
  quantity->stable = quantity->has_chart && quantity->chart.signals == 0 &&
                     (!quantity->has_subgroups || quantity->deviations.signals == 0);
  return FG_OK;
}

/* Returns the standard deviation of the process: between foils, and between the parts of a foil.
 * The variance of a mean of n bumps contains within² / n, which is subtracted before within² is
 * added. The degrees of freedom are the smaller of that and those of a moving range (0.62 (n - 1),
 * Wetherill and Brown 1991). */
static double process_sigma(const fg_lot_quantity *quantity) {
  if (!quantity->has_subgroups) return quantity->chart.sigma;
  double parts = (double)quantity->count / (double)quantity->chart.count;
  double within = quantity->means.sigma * quantity->means.sigma;
  double between = quantity->chart.sigma * quantity->chart.sigma - within / parts;
  return sqrt(fmax(between, 0) + within);
}

/* Foil that every scan's foil is, by foil of the analysis. */
typedef struct lot_owners {
  fg_lot_analysis *analysis;
  size_t *owner;
} lot_owners;

/* `values` are those of the quantity, in groups that belong together. */
static fg_status judge_groups(fg_context *ctx, double confidence, const double *values,
                              fg_value_groups groups, fg_lot_quantity *quantity) {
  if (!quantity->tolerance || !quantity->has_chart || !(quantity->sd > 0)) return FG_OK;
  const fg_capability_input input = {.values = values,
                                     .count = quantity->count,
                                     .groups = groups,
                                     .lower = quantity->tolerance->lower,
                                     .upper = quantity->tolerance->upper,
                                     .sigma = process_sigma(quantity),
                                     .sigma_dof = 0.62 * (double)(quantity->chart.count - 1),
                                     .stable = quantity->stable,
                                     .confidence = confidence,
                                     .density = quantity->has_density ? &quantity->density : NULL};
  quantity->has_capability = isfinite(input.lower) || isfinite(input.upper);
  if (!quantity->has_capability) return FG_OK;
  return fg_capability_compute(ctx, &input, &quantity->capability);
}

fg_status fg_lot_judge_capability(fg_context *ctx, double confidence, size_t foils,
                                  fg_lot_quantity *quantity) {
  return judge_groups(ctx, confidence, quantity->value, (fg_value_groups){quantity->size, foils},
                      quantity);
}

/* Scans of one foil (column `foil`) are one group: the foil was made once. */
static fg_status judge_foils(fg_context *ctx, const lot_owners *of, fg_lot_quantity *quantity) {
  size_t foils = of->analysis->foil_count, *size = NULL, *next = NULL, at = 0;
  double *values = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, foils, sizeof *size, (void **)&size));
  FG_TRY_EXIT(fg_memory_allocate(ctx, foils, sizeof *next, (void **)&next));
  FG_TRY_EXIT(fg_memory_allocate(ctx, quantity->count, sizeof *values, (void **)&values));
  for (size_t i = 0; i < foils; i++)
    size[of->owner[i]] += quantity->size[i];
  for (size_t i = 0; i < foils; at += size[i++])
    next[i] = at;
  at = 0;
  for (size_t i = 0; i < foils; at += quantity->size[i++])
    for (size_t k = 0; k < quantity->size[i]; k++)
      values[next[of->owner[i]]++] = quantity->value[at + k];
  FG_TRY_EXIT(judge_groups(ctx, of->analysis->lot->settings.confidence, values,
                           (fg_value_groups){size, foils}, quantity));
exit:
  free(size);
  free(next);
  free(values);
  return status;
}

static fg_status analyse_quantity(fg_context *ctx, void *shared, size_t i) {
  const lot_owners *of = shared;
  fg_lot_analysis *analysis = of->analysis;
  const fg_lot_settings *settings = &analysis->lot->settings;
  fg_lot_quantity *quantity = &analysis->quantities[i];
  FG_TRY(collect_values(ctx, analysis, quantity));
  FG_TRY(describe_values(ctx, settings, quantity));
  FG_TRY(describe_places(ctx, analysis, quantity));
  FG_TRY(fg_lot_chart_quantity(ctx, settings->run_rules, analysis->foil_count, quantity));
  return judge_foils(ctx, of, quantity);
}

fg_status fg_lot_analyse_quantities(fg_context *ctx, fg_lot_analysis *analysis) {
  lot_owners of = {.analysis = analysis};
  fg_status status = FG_OK;
  FG_TRY_EXIT(list_quantities(ctx, analysis));
  FG_TRY_EXIT(fg_memory_allocate(ctx, analysis->foil_count, sizeof *of.owner, (void **)&of.owner));
  FG_TRY_EXIT(fg_lot_find_owners(ctx, analysis, of.owner));
  FG_TRY_EXIT(fg_parallel_run(ctx, analysis->lot->threads, analysis->quantity_count,
                              analyse_quantity, &of));
exit:
  free(of.owner);
  return status;
}

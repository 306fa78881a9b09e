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

/* Values of a quantity as they are collected. Of several scans of a foil the parts of one number
 * are one value, their mean: the foil was made once. */
typedef struct collection {
  const fg_lot_analysis *analysis;
  fg_lot_quantity *quantity;
  const size_t *next; /* next scan of the same foil, by foil of the lot; 0: none */
  double *sum;        /* by number of the part; 0: the whole foil */
  size_t *count, numbers;
  int *place; /* by value: number of its part where it is known, else 0 */
} collection;

static void append_value(const collection *c, size_t foil, int place, double value) {
  fg_lot_quantity *quantity = c->quantity;
  if (!isfinite(value)) return;
  c->place[quantity->count] = place;
  quantity->value[quantity->count++] = value;
  quantity->size[foil]++;
}

typedef void take_value(const collection *c, size_t foil, int number, int place, double value);

/* Passes the values of one scan on. */
static void visit_values(const collection *c, size_t scan, size_t foil, take_value *take) {
  const fg_quantity_owner owner = c->quantity->owner;
  const fg_foil *of = c->analysis->foils[scan].foil;
  if (!fg_foil_is_measured(of)) return;
  if (owner == FG_QUANTITY_OF_FOIL) take(c, foil, 0, 0, fg_quantity_value(c->quantity->row, of));
  for (size_t k = 0; k < fg_part_count(of, owner); k++) {
    const fg_foil_part part = fg_part_at(of, owner, k);
    if (fg_lot_part_counts(of, owner, &part))
      take(c, foil, part.number, fg_lot_part_number(of, &part),
           fg_quantity_value(c->quantity->row, part.object));
  }
}

static void take_one(const collection *c, size_t foil, int number, int place, double value) {
  (void)number;
  append_value(c, foil, place, value);
}

static void add_one(const collection *c, size_t foil, int number, int place, double value) {
  (void)foil, (void)place;
  if (!isfinite(value) || number < 0) return;
  c->sum[number] += value;
  c->count[number]++;
}

static void collect_foil(const collection *c, size_t foil) {
  if (!c->next[foil]) {
    visit_values(c, foil, foil, take_one);
    return;
  }
  bool places = true;
  for (size_t scan = foil;; scan = c->next[scan]) {
    visit_values(c, scan, foil, add_one);
    places = places && !(c->analysis->foils[scan].foil->flags & FG_FOIL_BEAM_PLACES_UNKNOWN);
    if (!c->next[scan]) break;
  }
  for (size_t n = 0; n < c->numbers; n++) {
    if (c->count[n]) append_value(c, foil, places ? (int)n : 0, c->sum[n] / (double)c->count[n]);
    c->sum[n] = 0;
    c->count[n] = 0;
  }
}

static size_t highest_number(const fg_lot_analysis *analysis, bool of_part) {
  int highest = 0;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_foil *foil = analysis->foils[i].foil;
    size_t parts = fg_foil_is_measured(foil) ? fg_part_count(foil, analysis->parts) : 0;
    for (size_t k = 0; k < parts; k++) {
      const fg_foil_part part = fg_part_at(foil, analysis->parts, k);
      int number = of_part ? part.number : fg_lot_part_number(foil, &part);
      highest = number > highest ? number : highest;
    }
  }
  return (size_t)highest;
}

static fg_status collect_values(fg_context *ctx, collection *c) {
  const fg_lot_analysis *analysis = c->analysis;
  fg_lot_quantity *quantity = c->quantity;
  size_t max = 0;
  for (size_t i = 0; i < analysis->foil_count; i++)
    max += 1 + fg_part_count(analysis->foils[i].foil, quantity->owner);
  c->numbers = highest_number(analysis, true) + 1;
  FG_TRY(fg_memory_allocate(ctx, max, sizeof *quantity->value, (void **)&quantity->value));
  FG_TRY(fg_memory_allocate(ctx, analysis->foil_count, sizeof *quantity->size,
                            (void **)&quantity->size));
  FG_TRY(fg_memory_allocate(ctx, max, sizeof *c->place, (void **)&c->place));
  FG_TRY(fg_memory_allocate(ctx, c->numbers, sizeof *c->sum, (void **)&c->sum));
  FG_TRY(fg_memory_allocate(ctx, c->numbers, sizeof *c->count, (void **)&c->count));
  for (size_t i = 0; i < analysis->foil_count; i++)
    if (analysis->foils[i].owner == i) collect_foil(c, i);
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

static void add_to_place(fg_lot_place *place, double value) {
  if (!isfinite(value)) return;
  place->count++;
  double step = value - place->mean;
  place->mean += step / (double)place->count;
  place->sd += step * (value - place->mean); /* a sum of squares until all values are added */
}

/* Finds mean and sd of each number over the foils (running sums of Welford). */
static fg_status describe_places(fg_context *ctx, const collection *c) {
  fg_lot_quantity *quantity = c->quantity;
  void *block;
  if (!fg_owner_is_part(quantity->owner)) return FG_OK;
  quantity->places = highest_number(c->analysis, false);
  FG_TRY(fg_memory_allocate(ctx, quantity->places, sizeof *quantity->place, &block));
  quantity->place = block;
  for (size_t i = 0; i < quantity->count; i++) {
    size_t number = c->place[i] > 0 ? (size_t)c->place[i] : 0;
    if (number >= 1 && number <= quantity->places)
      add_to_place(&quantity->place[number - 1], quantity->value[i]);
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

static const double chart_level = FG_LOT_CHART_LEVEL_PCT / 100.0;

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
  const fg_subgroups by_foil = {quantity->value, quantity->size, foils};
  quantity->has_subgroups = fg_owner_is_part(quantity->owner) &&
                            fg_chart_subgroups(&unused, &by_foil, FG_SIGMA_FROM_SD, rules,
                                               &quantity->means, &quantity->deviations) == FG_OK;
  quantity->chance = quantity->spread_chance = (fg_chart_chance){.steady = true};
  if (quantity->has_chart)
    fg_chart_judge_individuals(&quantity->chart, rules, chart_level, &quantity->chance);
  if (quantity->has_subgroups)
    fg_chart_judge_deviations(&quantity->deviations, quantity->size, rules, chart_level,
                              &quantity->spread_chance);
  quantity->stable =
      quantity->has_chart && quantity->chance.steady && quantity->spread_chance.steady;
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

fg_status fg_lot_judge_capability(fg_context *ctx, double confidence, size_t foils,
                                  fg_lot_quantity *quantity) {
  if (!quantity->tolerance || !quantity->has_chart || !(quantity->sd > 0)) return FG_OK;
  const fg_capability_input input = {.values = quantity->value,
                                     .count = quantity->count,
                                     .groups = {quantity->size, foils},
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

/* Analysis with the scans of each foil. */
typedef struct lot_scans {
  fg_lot_analysis *analysis;
  size_t *next; /* as in `collection` */
} lot_scans;

static fg_status analyse_quantity(fg_context *ctx, void *shared, size_t i) {
  const lot_scans *of = shared;
  fg_lot_analysis *analysis = of->analysis;
  const fg_lot_settings *settings = &analysis->lot->settings;
  fg_lot_quantity *quantity = &analysis->quantities[i];
  collection c = {.analysis = analysis, .quantity = quantity, .next = of->next};
  fg_status status = FG_OK;
  FG_TRY_EXIT(collect_values(ctx, &c));
  FG_TRY_EXIT(describe_values(ctx, settings, quantity));
  FG_TRY_EXIT(describe_places(ctx, &c));
  FG_TRY_EXIT(fg_lot_chart_quantity(ctx, settings->run_rules, analysis->foil_count, quantity));
  FG_TRY_EXIT(fg_lot_judge_capability(ctx, settings->confidence, analysis->foil_count, quantity));
exit:
  free(c.place);
  free(c.sum);
  free(c.count);
  return status;
}

/* Links the scans of each foil in their order. */
static fg_status link_scans(fg_context *ctx, const fg_lot_analysis *analysis, size_t *next) {
  size_t *last;
  FG_TRY(fg_memory_allocate(ctx, analysis->foil_count, sizeof *last, (void **)&last));
  for (size_t i = 0; i < analysis->foil_count; i++) {
    size_t owner = analysis->foils[i].owner;
    if (owner != i) next[last[owner]] = i;
    last[owner] = i;
  }
  free(last);
  return FG_OK;
}

fg_status fg_lot_analyse_quantities(fg_context *ctx, fg_lot_analysis *analysis) {
  lot_scans of = {.analysis = analysis};
  fg_status status = FG_OK;
  FG_TRY_EXIT(list_quantities(ctx, analysis));
  FG_TRY_EXIT(fg_memory_allocate(ctx, analysis->foil_count, sizeof *of.next, (void **)&of.next));
  FG_TRY_EXIT(link_scans(ctx, analysis, of.next));
  FG_TRY_EXIT(fg_parallel_run(ctx, analysis->lot->threads, analysis->quantity_count,
                              analyse_quantity, &of));
exit:
  free(of.next);
  return status;
}

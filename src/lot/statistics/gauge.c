/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Repeated scans of a lot as a gauge study. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "foilgauge/gauge_uneven.h"
#include "lot/statistics/analysis.h"

/* Scans of a gauge study: part, operator and foil of each. */
typedef struct gauge_scans {
  fg_manifest_words parts, operators;
  size_t count;
  fg_gauge_trial *at; /* `value` is of the quantity in hand */
  const fg_foil **foil;
  fg_gauge_trial *known; /* those with a value */
  double *table;         /* values by part, operator and trial of a complete study */
  size_t *seen;          /* by part and operator */
} gauge_scans;

/* Share of a complete study that must be there: where operators have hardly a part in common, they
 * and the parts are one. */
#define FILLED_MIN 0.75

/* Lists the scans with both cells. */
static void list_scans(const fg_lot_analysis *analysis, size_t part_column, size_t operator_column,
                       gauge_scans *scans) {
  const fg_manifest *manifest = &analysis->lot->manifest;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    size_t item = analysis->foils[i].item;
    size_t part =
        fg_manifest_word_index(&scans->parts, fg_manifest_cell(manifest, item, part_column));
    size_t who = fg_manifest_word_index(&scans->operators,
                                        fg_manifest_cell(manifest, item, operator_column));
    if (part >= scans->parts.count || who >= scans->operators.count) continue;
    scans->foil[scans->count] = analysis->foils[i].foil;
    scans->at[scans->count++] = (fg_gauge_trial){.part = part, .who = who};
  }
}

/* Counts the scans of each cell; returns the largest count. */
static size_t count_trials(gauge_scans *scans, size_t count) {
  size_t max = 0, operators = scans->operators.count;
  memset(scans->seen, 0, scans->parts.count * operators * sizeof *scans->seen);
  for (size_t i = 0; i < count; i++) {
    size_t seen = ++scans->seen[scans->known[i].part * operators + scans->known[i].who];
    max = seen > max ? seen : max;
  }
  return max;
}

/* Orders the values of a complete study. */
static void order_values(gauge_scans *scans, size_t count, size_t trials) {
  memset(scans->seen, 0, scans->parts.count * scans->operators.count * sizeof *scans->seen);
  for (size_t i = 0; i < count; i++) {
    size_t cell = scans->known[i].part * scans->operators.count + scans->known[i].who;
    scans->table[cell * trials + scans->seen[cell]++] = scans->known[i].value;
  }
}

/* Sets *known where the values make a study: all of it, or with some missing. */
static fg_status compute_study(fg_context *ctx, gauge_scans *scans, size_t count,
                               fg_gauge_study *study, bool *known) {
  size_t parts = scans->parts.count, operators = scans->operators.count;
  size_t trials = count_trials(scans, count), whole = parts * operators * trials;
  fg_context ignored = {0};
  *known = trials >= 2 && (double)count >= FILLED_MIN * (double)whole;
  if (!*known) return FG_OK;
  if (count == whole) {
    order_values(scans, count, trials);
    return fg_gauge_study_compute(ctx, scans->table, parts, operators, trials, study);
  }
  fg_status status = fg_gauge_study_uneven(&ignored, scans->known, count, study);
  *known = status == FG_OK;
  return status == FG_ERR_DATA ? FG_OK : status;
}

static double value_of_number(const fg_lot_quantity *quantity, const fg_foil *foil, int number) {
  if (!number) return fg_quantity_value(quantity->row, foil);
  for (size_t i = 0; i < fg_part_count(foil, quantity->owner); i++) {
    const fg_foil_part part = fg_part_at(foil, quantity->owner, i);
    if (fg_lot_part_number(foil, &part) == number &&
        fg_lot_part_counts(foil, quantity->owner, &part))
      return fg_quantity_value(quantity->row, part.object);
  }
  return NAN;
}

static fg_status study_number(fg_context *ctx, fg_lot_analysis *analysis, gauge_scans *scans,
                              const fg_lot_quantity *quantity, int number) {
  fg_lot_gauge gauge = {.quantity = quantity, .number = number};
  size_t count = 0;
  bool known;
  for (size_t i = 0; i < scans->count; i++) {
    double value = value_of_number(quantity, scans->foil[i], number);
    if (!isfinite(value)) continue;
    scans->known[count] = scans->at[i];
    scans->known[count++].value = value;
  }
  FG_TRY(compute_study(ctx, scans, count, &gauge.study, &known));
  if (!known) return FG_OK;
  FG_TRY(fg_memory_reserve(ctx, analysis->gauge_count + 1, sizeof *analysis->gauges,
                           &analysis->gauge_capacity, (void **)&analysis->gauges));
  analysis->gauges[analysis->gauge_count++] = gauge;
  return FG_OK;
}

static fg_status study_quantities(fg_context *ctx, fg_lot_analysis *analysis, gauge_scans *scans) {
  for (size_t q = 0; q < analysis->quantity_count; q++) {
    const fg_lot_quantity *quantity = &analysis->quantities[q];
    int parts = (int)quantity->places;
    for (int number = parts ? 1 : 0; number <= parts; number++)
      FG_TRY(study_number(ctx, analysis, scans, quantity, number));
  }
  return FG_OK;
}

static fg_status run_gauge_study(fg_context *ctx, fg_lot_analysis *analysis, gauge_scans *scans,
                                 size_t part_column, size_t operator_column) {
  size_t foils = analysis->foil_count;
  fg_status status = FG_OK;
  fg_lot_list_words(analysis, part_column, &scans->parts);
  fg_lot_list_words(analysis, operator_column, &scans->operators);
  size_t cells = scans->parts.count * scans->operators.count;
  if (scans->parts.count < 2 || scans->operators.count < 2) return FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, cells, sizeof *scans->seen, (void **)&scans->seen));
  FG_TRY_EXIT(fg_memory_allocate(ctx, foils, sizeof *scans->foil, (void **)&scans->foil));
  FG_TRY_EXIT(fg_memory_allocate(ctx, foils, sizeof *scans->at, (void **)&scans->at));
  FG_TRY_EXIT(fg_memory_allocate(ctx, foils, sizeof *scans->known, (void **)&scans->known));
  FG_TRY_EXIT(fg_memory_allocate(ctx, foils, sizeof *scans->table, (void **)&scans->table));
  list_scans(analysis, part_column, operator_column, scans);
  FG_TRY_EXIT(study_quantities(ctx, analysis, scans));
exit:
  free(scans->seen);
  free(scans->foil);
  free(scans->at);
  free(scans->known);
  free(scans->table);
  return status;
}

fg_status fg_lot_analyse_gauge(fg_context *ctx, fg_lot_analysis *analysis) {
  const fg_lot *lot = analysis->lot;
  size_t part = fg_manifest_column(&lot->manifest, lot->settings.part_column);
  size_t who = fg_manifest_column(&lot->manifest, lot->settings.operator_column);
  void *block;
  if (part == FG_NO_COLUMN || who == FG_NO_COLUMN) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(gauge_scans), &block));
  fg_status status = run_gauge_study(ctx, analysis, block, part, who);
  free(block);
  return status;
}

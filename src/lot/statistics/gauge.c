/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Repeated scans of a lot as a gauge study. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "lot/statistics/analysis.h"

/* Full table of part × operator × trial, which a gauge study needs. */
typedef struct gauge_table {
  fg_manifest_words parts, operators;
  size_t trials;
  size_t *seen; /* number of scans by part and operator */
  const fg_foil **foil;
} gauge_table;

static size_t count_trials(const fg_lot_analysis *analysis, size_t part_column,
                           size_t operator_column) {
  const fg_manifest *manifest = &analysis->lot->manifest;
  const char *part = NULL, *who = NULL;
  size_t trials = 0;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const char *this_part = fg_manifest_cell(manifest, analysis->foils[i].item, part_column);
    const char *this_one = fg_manifest_cell(manifest, analysis->foils[i].item, operator_column);
    if (!part) {
      part = this_part;
      who = this_one;
    }
    trials += !strcmp(part, this_part) && !strcmp(who, this_one);
  }
  return trials;
}

/* Returns false when the scans do not fill the table; there is no study then. */
static bool fill_gauge_table(const fg_lot_analysis *analysis, gauge_table *table,
                             size_t part_column, size_t operator_column) {
  const fg_manifest *manifest = &analysis->lot->manifest;
  size_t parts = table->parts.count, operators = table->operators.count;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    size_t item = analysis->foils[i].item;
    size_t part =
        fg_manifest_word_index(&table->parts, fg_manifest_cell(manifest, item, part_column));
    size_t who = fg_manifest_word_index(&table->operators,
                                        fg_manifest_cell(manifest, item, operator_column));
    size_t cell = part * operators + who;
    if (part >= parts || who >= operators) return false; /* an empty cell */
    if (table->seen[cell] >= table->trials) return false;
    table->foil[cell * table->trials + table->seen[cell]++] = analysis->foils[i].foil;
  }
  for (size_t i = 0; i < parts * operators; i++)
    if (table->seen[i] != table->trials) return false;
  return true;
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

static fg_status study_number(fg_context *ctx, fg_lot_analysis *analysis, const gauge_table *table,
                              const fg_lot_quantity *quantity, int number, double *values) {
  fg_lot_gauge gauge = {.quantity = quantity, .number = number};
  size_t count = table->parts.count * table->operators.count * table->trials;
  for (size_t i = 0; i < count; i++) {
    values[i] = value_of_number(quantity, table->foil[i], number);
    if (!isfinite(values[i])) return FG_OK;
  }
  FG_TRY(fg_gauge_study_compute(ctx, values, table->parts.count, table->operators.count,
                                table->trials, &gauge.study));
  FG_TRY(fg_memory_reserve(ctx, analysis->gauge_count + 1, sizeof *analysis->gauges,
                           &analysis->gauge_capacity, (void **)&analysis->gauges));
  analysis->gauges[analysis->gauge_count++] = gauge;
  return FG_OK;
}

static fg_status study_quantities(fg_context *ctx, fg_lot_analysis *analysis,
                                  const gauge_table *table, double *values) {
  for (size_t q = 0; q < analysis->quantity_count; q++) {
    const fg_lot_quantity *quantity = &analysis->quantities[q];
    int parts = (int)quantity->places;
    for (int number = parts ? 1 : 0; number <= parts; number++)
      FG_TRY(study_number(ctx, analysis, table, quantity, number, values));
  }
  return FG_OK;
}

static fg_status run_gauge_study(fg_context *ctx, fg_lot_analysis *analysis, gauge_table *table,
                                 size_t part_column, size_t operator_column) {
  void *values = NULL, *block;
  fg_status status = FG_OK;
  fg_lot_list_words(analysis, part_column, &table->parts);
  fg_lot_list_words(analysis, operator_column, &table->operators);
  table->trials = count_trials(analysis, part_column, operator_column);
  size_t cells = table->parts.count * table->operators.count;
  if (table->parts.count < 2 || table->operators.count < 2 || table->trials < 2 ||
      cells * table->trials != analysis->foil_count)
    return FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, cells, sizeof *table->seen, &block));
  table->seen = block;
  FG_TRY_EXIT(fg_memory_allocate(ctx, analysis->foil_count, sizeof *table->foil, &block));
  table->foil = block;
  FG_TRY_EXIT(fg_memory_allocate(ctx, analysis->foil_count, sizeof(double), &values));
  if (fill_gauge_table(analysis, table, part_column, operator_column))
    FG_TRY_EXIT(study_quantities(ctx, analysis, table, values));
exit:
  free(values);
  free(table->seen);
  free(table->foil);
  return status;
}

fg_status fg_lot_analyse_gauge(fg_context *ctx, fg_lot_analysis *analysis) {
  const fg_lot *lot = analysis->lot;
  size_t part = fg_manifest_column(&lot->manifest, lot->settings.part_column);
  size_t who = fg_manifest_column(&lot->manifest, lot->settings.operator_column);
  void *block;
  if (part == FG_NO_COLUMN || who == FG_NO_COLUMN) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(gauge_table), &block));
  fg_status status = run_gauge_study(ctx, analysis, block, part, who);
  free(block);
  return status;
}

/* Groups of a lot against each other (dies, coils), and repeated scans as a gauge study. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "lot/analysis.h"

enum { WORDS_MAX = 4096 };

/* Distinct cells of a column, in order of appearance. */
typedef struct words {
  const char *word[WORDS_MAX];
  size_t count;
} words;

static size_t word_index(words *list, const char *word) {
  for (size_t i = 0; i < list->count; i++)
    if (!strcmp(list->word[i], word)) return i;
  if (list->count == WORDS_MAX) return WORDS_MAX;
  list->word[list->count] = word;
  return list->count++;
}

static void list_words(const fg_lot_analysis *analysis, size_t column, words *list) {
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const char *word = fg_manifest_cell(&analysis->lot->manifest, analysis->foils[i].item, column);
    if (*word) word_index(list, word);
  }
}

/* The values of a quantity whose foils have this word in the column. */
static size_t select_values(const fg_lot_analysis *analysis, const fg_lot_quantity *quantity,
                            size_t column, const char *word, double *values) {
  size_t at = 0, count = 0;
  for (size_t i = 0; i < analysis->foil_count; at += quantity->size[i++]) {
    if (strcmp(fg_manifest_cell(&analysis->lot->manifest, analysis->foils[i].item, column), word))
      continue;
    memcpy(values + count, quantity->value + at, quantity->size[i] * sizeof *values);
    count += quantity->size[i];
  }
  return count;
}

static void describe(const double *values, size_t count, double *mean, double *sd) {
  double sum = 0, squares = 0;
  for (size_t i = 0; i < count; i++)
    sum += values[i];
  *mean = sum / (double)count;
  for (size_t i = 0; i < count; i++)
    squares += (values[i] - *mean) * (values[i] - *mean);
  *sd = sqrt(squares / (double)(count - 1));
}

static fg_status add_difference(fg_context *ctx, fg_lot_analysis *analysis,
                                const fg_lot_difference *difference) {
  FG_TRY(fg_memory_reserve(ctx, analysis->difference_count + 1, sizeof *analysis->differences,
                           &analysis->difference_capacity, (void **)&analysis->differences));
  analysis->differences[analysis->difference_count++] = *difference;
  return FG_OK;
}

static fg_status compare(fg_context *ctx, fg_lot_analysis *analysis,
                         const fg_lot_quantity *quantity, size_t column, const char *a,
                         const char *b) {
  fg_lot_difference difference = {.quantity = quantity, .a = a, .b = b};
  void *block;
  FG_TRY(fg_memory_allocate(ctx, 2 * quantity->count, sizeof(double), &block));
  double *values = block;
  difference.count_a = select_values(analysis, quantity, column, a, values);
  double *second = values + difference.count_a;
  difference.count_b = select_values(analysis, quantity, column, b, second);
  fg_context unused;
  fg_status status = fg_comparison_compute(
      &unused, (fg_sample){values, difference.count_a}, (fg_sample){second, difference.count_b},
      analysis->lot->settings.confidence, &difference.comparison);
  if (status == FG_OK) {
    describe(values, difference.count_a, &difference.mean_a, &difference.sd_a);
    describe(second, difference.count_b, &difference.mean_b, &difference.sd_b);
    status = add_difference(ctx, analysis, &difference);
  } else if (status == FG_ERR_DATA) {
    status = FG_OK; /* too few to compare: nothing is said */
  }
  free(values);
  return status;
}

static fg_status compare_pairs(fg_context *ctx, fg_lot_analysis *analysis, const words *groups,
                               size_t column) {
  for (size_t q = 0; q < analysis->quantity_count; q++)
    for (size_t a = 0; a < groups->count; a++)
      for (size_t b = a + 1; b < groups->count; b++)
        FG_TRY(compare(ctx, analysis, &analysis->quantities[q], column, groups->word[a],
                       groups->word[b]));
  return FG_OK;
}

fg_status fg_lot_analyse_groups(fg_context *ctx, fg_lot_analysis *analysis) {
  const fg_lot *lot = analysis->lot;
  size_t column = fg_manifest_column(&lot->manifest, lot->settings.group_column);
  void *block;
  if (column == FG_NO_COLUMN && lot->settings.group_column[0])
    return fg_fail(ctx, FG_ERR_DATA, "group_column (--group): the manifest has no column '%s'",
                   lot->settings.group_column);
  if (column == FG_NO_COLUMN) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(words), &block));
  words *groups = block;
  list_words(analysis, column, groups);
  fg_status status = FG_OK;
  if (groups->count > FG_LOT_GROUPS_MAX)
    status = fg_fail(ctx, FG_ERR_DATA, "group_column '%s' has %zu groups; at most %d are compared",
                     lot->settings.group_column, groups->count, FG_LOT_GROUPS_MAX);
  else
    status = compare_pairs(ctx, analysis, groups, column);
  free(groups);
  return status;
}

/* A gauge study needs a whole table of part × operator × trial. */
typedef struct gauge_table {
  words parts, operators;
  size_t trials;
  size_t *seen; /* scans of each part and operator */
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

/* False when the scans do not fill the table: then there is no study. */
static bool fill_table(const fg_lot_analysis *analysis, gauge_table *table, size_t part_column,
                       size_t operator_column) {
  const fg_manifest *manifest = &analysis->lot->manifest;
  size_t parts = table->parts.count, operators = table->operators.count;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    size_t item = analysis->foils[i].item;
    size_t part = word_index(&table->parts, fg_manifest_cell(manifest, item, part_column));
    size_t who = word_index(&table->operators, fg_manifest_cell(manifest, item, operator_column));
    size_t cell = part * operators + who;
    if (part >= parts || who >= operators) return false; /* an empty cell */
    if (table->seen[cell] >= table->trials) return false;
    table->foil[cell * table->trials + table->seen[cell]++] = analysis->foils[i].foil;
  }
  for (size_t i = 0; i < parts * operators; i++)
    if (table->seen[i] != table->trials) return false;
  return true;
}

static double foil_value(const fg_lot_quantity *quantity, const fg_foil *foil, int number) {
  if (!number) return fg_quantity_value(quantity->row, foil);
  for (size_t i = 0; i < fg_part_count(foil, quantity->owner); i++) {
    const fg_foil_part part = fg_part_at(foil, quantity->owner, i);
    if (part.number == number && fg_lot_part_counts(foil, quantity->owner, &part))
      return fg_quantity_value(quantity->row, part.object);
  }
  return NAN;
}

static fg_status study(fg_context *ctx, fg_lot_analysis *analysis, const gauge_table *table,
                       const fg_lot_quantity *quantity, int number, double *values) {
  fg_lot_gauge gauge = {.quantity = quantity, .number = number};
  size_t count = table->parts.count * table->operators.count * table->trials;
  for (size_t i = 0; i < count; i++) {
    values[i] = foil_value(quantity, table->foil[i], number);
    if (!isfinite(values[i])) return FG_OK;
  }
  FG_TRY(fg_gauge_study_compute(ctx, values, table->parts.count, table->operators.count,
                                table->trials, &gauge.study));
  FG_TRY(fg_memory_reserve(ctx, analysis->gauge_count + 1, sizeof *analysis->gauges,
                           &analysis->gauge_capacity, (void **)&analysis->gauges));
  analysis->gauges[analysis->gauge_count++] = gauge;
  return FG_OK;
}

static fg_status study_all(fg_context *ctx, fg_lot_analysis *analysis, const gauge_table *table,
                           double *values) {
  for (size_t q = 0; q < analysis->quantity_count; q++) {
    const fg_lot_quantity *quantity = &analysis->quantities[q];
    int parts = (int)quantity->places;
    for (int number = parts ? 1 : 0; number <= parts; number++)
      FG_TRY(study(ctx, analysis, table, quantity, number, values));
  }
  return FG_OK;
}

static fg_status run_study(fg_context *ctx, fg_lot_analysis *analysis, gauge_table *table,
                           size_t part_column, size_t operator_column) {
  void *values = NULL, *block;
  fg_status status = FG_OK;
  list_words(analysis, part_column, &table->parts);
  list_words(analysis, operator_column, &table->operators);
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
  if (fill_table(analysis, table, part_column, operator_column))
    FG_TRY_EXIT(study_all(ctx, analysis, table, values));
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
  fg_status status = run_study(ctx, analysis, block, part, who);
  free(block);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stats/column.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/csv.h"
#include "core/extended.h"
#include "core/memory.h"
#include "core/text.h"

/* FNV-1a. */
static size_t hash_word(const char *word) {
  uint64_t hash = 1469598103934665603u;
  for (; *word; word++)
    hash = (hash ^ (unsigned char)*word) * 1099511628211u;
  return (size_t)hash;
}

/* Returns the slot of the name, or the free slot for it. */
static size_t *find_name(const fg_table *table, const char *name) {
  size_t mask = table->name_slots - 1;
  for (size_t i = hash_word(name) & mask;; i = (i + 1) & mask) {
    size_t *slot = &table->name_slot[i];
    if (!*slot || strcmp(table->column[*slot - 1].name, name) == 0) return slot;
  }
}

/* Grows the hash, so that adding a column takes constant time in a table of 100,000 columns too. */
static fg_status grow_names(fg_context *ctx, fg_table *table) {
  if ((table->columns + 1) * 2 < table->name_slots) return FG_OK;
  size_t count = 16;
  void *slots = NULL;
  while (count <= (table->columns + 1) * 2)
    count *= 2;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *table->name_slot, &slots));
  free(table->name_slot);
  table->name_slot = slots;
  table->name_slots = count;
  for (size_t i = 0; i < table->columns; i++)
    *find_name(table, table->column[i].name) = i + 1;
  return FG_OK;
}

size_t fg_column_find(const fg_table *table, const char *name) {
  size_t i = 0;
  if (table->name_slots) {
    size_t slot = *find_name(table, name);
    return slot ? slot - 1 : table->columns;
  }
  while (i < table->columns && strcmp(table->column[i].name, name) != 0) /* one was taken out */
    i++;
  return i;
}

fg_status fg_column_open(fg_context *ctx, fg_table *table, const char *name, fg_column **column) {
  FG_TRY(grow_names(ctx, table));
  if (fg_column_find(table, name) < table->columns)
    return fg_fail(ctx, FG_ERR_USAGE, "the table has a column '%s' already", name);
  FG_TRY(fg_memory_reserve(ctx, table->columns + 1, sizeof *table->column, &table->column_capacity,
                           (void **)&table->column));
  fg_column *added = &table->column[table->columns];
  memset(added, 0, sizeof *added);
  FG_TRY(fg_text_print(ctx, &added->name, "%s", name));
  *find_name(table, added->name) = ++table->columns;
  *column = added;
  return FG_OK;
}

void fg_column_free(fg_column *column) {
  for (size_t i = 0; i < column->word_count; i++)
    free(column->words[i]);
  free(column->words);
  free(column->slot);
  free(column->word);
  free(column->number);
  free(column->uncertainty);
  free(column->name);
}

void fg_column_drop(fg_table *table, size_t index) {
  fg_column_free(&table->column[index]);
  table->columns--;
  memmove(&table->column[index], &table->column[index + 1],
          (table->columns - index) * sizeof *table->column);
  free(table->name_slot);
  table->name_slot = NULL;
  table->name_slots = 0;
}

void fg_column_drop_last(fg_table *table) {
  fg_column_drop(table, table->columns - 1);
}

static fg_status push_cell(fg_context *ctx, fg_column *column, size_t row, fg_extended number,
                           size_t mark) {
  FG_TRY(fg_memory_reserve(ctx, row + 1, sizeof *column->number, &column->capacity,
                           (void **)&column->number));
  column->number[row] = number;
  /* Marks are allocated at the first cell that is not a number: most columns never need them. */
  if (!column->word && mark == FG_TABLE_NOT_A_WORD) return FG_OK;
  bool first = !column->word;
  FG_TRY(fg_memory_reserve(ctx, row + 1, sizeof *column->word, &column->mark_capacity,
                           (void **)&column->word));
  if (first)
    for (size_t i = 0; i < row; i++)
      column->word[i] = FG_TABLE_NOT_A_WORD;
  column->word[row] = mark;
  return FG_OK;
}

fg_status fg_column_push_number(fg_context *ctx, fg_column *column, size_t row,
                                fg_extended number) {
  if (!isfinite(number.value)) return fg_column_push_missing(ctx, column, row);
  FG_TRY(push_cell(ctx, column, row, number, FG_TABLE_NOT_A_WORD));
  column->number_count++;
  return FG_OK;
}

fg_status fg_column_push_missing(fg_context *ctx, fg_column *column, size_t row) {
  FG_TRY(push_cell(ctx, column, row, fg_extended_of(0.0), FG_TABLE_MISSING));
  column->missing_count++;
  return FG_OK;
}

/* The slot where the word is, or the free one where it belongs. */
static size_t *find_slot(const fg_column *column, const char *word) {
  size_t mask = column->slot_count - 1;
  for (size_t i = hash_word(word) & mask;; i = (i + 1) & mask) {
    size_t *slot = &column->slot[i];
    if (!*slot || strcmp(column->words[*slot - 1], word) == 0) return slot;
  }
}

static fg_status grow_slots(fg_context *ctx, fg_column *column) {
  if (column->word_count * 2 < column->slot_count) return FG_OK;
  size_t count = column->slot_count ? column->slot_count * 2 : 16;
  void *slots = NULL;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *column->slot, &slots));
  free(column->slot);
  column->slot = slots;
  column->slot_count = count;
  for (size_t i = 0; i < column->word_count; i++)
    *find_slot(column, column->words[i]) = i + 1;
  return FG_OK;
}

fg_status fg_column_push_word(fg_context *ctx, fg_column *column, size_t row, const char *word) {
  FG_TRY(grow_slots(ctx, column));
  size_t *slot = find_slot(column, word);
  if (!*slot) {
    FG_TRY(fg_memory_reserve(ctx, column->word_count + 1, sizeof *column->words,
                             &column->word_capacity, (void **)&column->words));
    FG_TRY(fg_text_print(ctx, &column->words[column->word_count], "%s", word));
    *slot = ++column->word_count;
  }
  return push_cell(ctx, column, row, fg_extended_of(0.0), *slot - 1);
}

static bool is_missing(const char *text, size_t length) {
  static const char *const spellings[] = {"NA",   "N/A",  "NaN",      "nan",  "inf",
                                          "+inf", "-inf", "infinity", "null", "#N/A"};
  if (length == 0) return true;
  for (size_t i = 0; i < sizeof spellings / sizeof *spellings; i++)
    if (strlen(spellings[i]) == length && strncasecmp(text, spellings[i], length) == 0) return true;
  return false;
}

/* false: it is no number. */
static bool parse_cell_number(fg_column *column, size_t row, const char *text, size_t length,
                              bool commas, fg_extended *number) {
  char pointed[128];
  if (fg_extended_parse(text, length, number)) {
    if (!column->point_row && memchr(text, '.', length)) column->point_row = row + 1;
    return true;
  }
  if (!commas || fg_csv_number_kind(text, length) != FG_CSV_COMMA) return false;
  if (!column->comma_row) column->comma_row = row + 1;
  column->comma_proven = column->comma_proven || !fg_csv_may_be_thousands(text, length);
  return fg_csv_point(text, length, pointed, sizeof pointed) &&
         fg_extended_parse(pointed, length, number);
}

static void trim(const char **text, size_t *length) {
  while (*length && ((*text)[0] == ' ' || (*text)[0] == '\t'))
    ++*text, --*length;
  while (*length && ((*text)[*length - 1] == ' ' || (*text)[*length - 1] == '\t'))
    --*length;
}

fg_status fg_column_push_as_word(fg_context *ctx, fg_column *column, size_t row, const char *text,
                                 size_t length) {
  char *word = NULL;
  trim(&text, &length);
  if (!length) return fg_column_push_missing(ctx, column, row);
  FG_TRY(fg_text_print(ctx, &word, "%.*s", (int)length, text));
  fg_status status = fg_column_push_word(ctx, column, row, word);
  free(word);
  return status;
}

fg_status fg_column_push_text(fg_context *ctx, fg_column *column, size_t row, const char *text,
                              size_t length, bool commas) {
  fg_extended number;
  trim(&text, &length);
  if (parse_cell_number(column, row, text, length, commas, &number))
    return fg_column_push_number(ctx, column, row, number);
  if (is_missing(text, length)) return fg_column_push_missing(ctx, column, row);
  return fg_column_push_as_word(ctx, column, row, text, length);
}

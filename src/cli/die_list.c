/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/die_list.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "foilgauge/file.h"
#include "foilgauge/memory.h"
#include "foilgauge/table.h"
#include "foilgauge/text.h"

enum { LIST_BYTES_MAX = 1 << 20 };

fg_status fg_die_sources_add(fg_context *ctx, fg_die_sources *sources,
                             const fg_die_source *source) {
  FG_TRY(fg_memory_reserve(ctx, sources->count + 1, sizeof *sources->source, &sources->capacity,
                           (void **)&sources->source));
  sources->source[sources->count++] = *source;
  return FG_OK;
}

void fg_die_sources_free(fg_die_sources *sources) {
  for (size_t i = 0; i < sources->path_count; i++)
    free(sources->path[i]);
  free(sources->path);
  free(sources->source);
  memset(sources, 0, sizeof *sources);
}

bool fg_die_read_half(const char *text, const char **half) {
  for (int h = 0; h < FG_DIE_HALVES; h++)
    if (!strcmp(text, fg_die_half_word((fg_die_half)h))) {
      *half = fg_die_half_word((fg_die_half)h);
      return true;
    }
  return false;
}

static fg_die_unit read_unit(const char *text, size_t length) {
  for (int unit = FG_DIE_MM; unit <= FG_DIE_NM; unit++) {
    const char *word = fg_die_unit_word((fg_die_unit)unit);
    if (length == strlen(word) && !strncmp(text, word, length)) return (fg_die_unit)unit;
  }
  bool micro = length == 3 && (!strncmp(text, "\xc2\xb5m", 3) || !strncmp(text, "\xce\xbcm", 3));
  return micro ? FG_DIE_UM : FG_DIE_UNIT_NONE;
}

bool fg_die_read_units(const char *text, fg_die_unit unit[2]) {
  const char *comma = strchr(text, ',');
  unit[0] = read_unit(text, comma ? (size_t)(comma - text) : strlen(text));
  unit[1] = comma ? read_unit(comma + 1, strlen(comma + 1)) : unit[0];
  return unit[0] && unit[1];
}

bool fg_die_read_columns(const char *text, size_t column[2]) {
  char *end, *last;
  if (strspn(text, "0123456789,") != strlen(text)) return false;
  column[0] = strtoul(text, &end, 10);
  if (*end != ',') return false;
  column[1] = strtoul(end + 1, &last, 10);
  return !*last && column[0] > 0 && column[1] > 0 && column[0] != column[1];
}

/* A table being read. */
typedef struct list {
  fg_context *ctx;
  const char *path;
  const fg_table *table;
  size_t row;
} list;

static const fg_column *column_of(const list *l, const char *name) {
  for (size_t i = 0; i < l->table->columns; i++)
    if (!strcmp(l->table->column[i].name, name)) return &l->table->column[i];
  return NULL;
}

/* The word of a cell; NULL where there is none. */
static const char *word_at(const list *l, const char *name) {
  const fg_column *column = column_of(l, name);
  if (!column || !column->word || column->word[l->row] >= column->word_count) return NULL;
  return column->words[column->word[l->row]];
}

static bool read_number_at(const list *l, const char *name, double *value) {
  const fg_column *column = column_of(l, name);
  if (!column || (column->word && column->word[l->row] != FG_TABLE_NOT_A_WORD)) return false;
  *value = column->number[l->row].value;
  return true;
}

static fg_status fail_at_cell(const list *l, const char *name, const char *wanted) {
  return fg_fail(l->ctx, FG_ERR_DATA, "%s: row %zu: %s must be %s", l->path, l->row + 1, name,
                 wanted);
}

static fg_status read_die_numbers(const list *l, fg_die_source *source) {
  double value;
  if (read_number_at(l, "tip_um", &value)) source->tip_um = value;
  if (word_at(l, "tip_um") || source->tip_um < 0)
    return fail_at_cell(l, "tip_um", "a number from 0");
  if (read_number_at(l, "first_bump", &value)) {
    if (value < 1 || value > 1000 || value != floor(value))
      return fail_at_cell(l, "first_bump", "a whole number from 1");
    source->first_bump = (int)value;
  }
  return word_at(l, "first_bump") ? fail_at_cell(l, "first_bump", "a whole number from 1") : FG_OK;
}

static fg_status read_words(const list *l, fg_die_source *source) {
  const char *half = word_at(l, "half"), *unit = word_at(l, "unit");
  const char *columns = word_at(l, "columns"), *reversed = word_at(l, "reversed");
  if (half && !fg_die_read_half(half, &source->half))
    return fail_at_cell(l, "half", "concave or convex");
  if (unit && !fg_die_read_units(unit, source->unit))
    return fail_at_cell(l, "unit", "mm, um or nm, or two of them: mm,um");
  if (columns && !fg_die_read_columns(columns, source->column))
    return fail_at_cell(l, "columns", "two numbers from 1: 1,3");
  if (reversed && strcmp(reversed, "yes") != 0 && strcmp(reversed, "no") != 0)
    return fail_at_cell(l, "reversed", "yes or no");
  if (reversed) source->reversed = !strcmp(reversed, "yes");
  return FG_OK;
}

static fg_status make_path(const list *l, const char *name, fg_die_sources *sources,
                           const char **path) {
  const char *slash = strrchr(l->path, '/');
  int folder = slash && name[0] != '/' ? (int)(slash - l->path + 1) : 0;
  FG_TRY(fg_memory_reserve(l->ctx, sources->path_count + 1, sizeof *sources->path,
                           &sources->path_capacity, (void **)&sources->path));
  FG_TRY(
      fg_text_print(l->ctx, &sources->path[sources->path_count], "%.*s%s", folder, l->path, name));
  *path = sources->path[sources->path_count++];
  return FG_OK;
}

static fg_status read_die_rows(list *l, const fg_die_source *said, fg_die_sources *sources) {
  static const char *const known[] = {"profile", "half",       "unit",     "columns",
                                      "tip_um",  "first_bump", "reversed", NULL};
  for (size_t i = 0; i < l->table->columns; i++) {
    size_t k = 0;
    while (known[k] && strcmp(known[k], l->table->column[i].name) != 0)
      k++;
    if (!known[k])
      return fg_fail(l->ctx, FG_ERR_DATA,
                     "%s: no column '%s' is read; there are profile, half, unit, columns, tip_um, "
                     "first_bump, reversed",
                     l->path, l->table->column[i].name);
  }
  for (l->row = 0; l->row < l->table->rows; l->row++) {
    fg_die_source source = *said;
    const char *name = word_at(l, "profile");
    if (!name) return fail_at_cell(l, "profile", "the name of a file");
    FG_TRY(read_words(l, &source));
    FG_TRY(read_die_numbers(l, &source));
    FG_TRY(make_path(l, name, sources, &source.path));
    FG_TRY(fg_die_sources_add(l->ctx, sources, &source));
  }
  return FG_OK;
}

fg_status fg_die_list_load(fg_context *ctx, const char *path, const fg_die_source *said,
                           fg_die_sources *sources) {
  char *text = NULL;
  fg_table table = {0};
  fg_status status = FG_OK;
  FG_TRY(fg_file_read_text(ctx, path, LIST_BYTES_MAX, &text));
  FG_TRY_EXIT(fg_table_parse(ctx, path, text, strlen(text), &table));
  list l = {.ctx = ctx, .path = path, .table = &table};
  status = read_die_rows(&l, said, sources);
exit:
  fg_table_free(&table);
  free(text);
  return status;
}

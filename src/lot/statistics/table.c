/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/sha256.h"
#include "foilgauge/lot_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/foil_kind.h"
#include "lot/statistics/analysis.h"
#include "quantity/quantity_rows.h"

enum {
  TEXT_BYTES_MAX = 1 << 30,
  /* a column with more names cannot be an effect (FG_LOOP_COLUMNS), and may be a count */
  LEVELS_MAX = 12,
};

typedef enum lot_file { RESULTS, MANIFEST, RECIPE, FILES } lot_file;
static const char *const file_name[FILES] = {"results.jsonl", "manifest.csv", "recipe.json"};

typedef struct reading {
  const fg_lot_table_options *options;
  const char *folder;
  fg_lot_table *out;
  fg_lot lot;
  fg_table manifest;
  const fg_quantity *row;
  fg_quantity_owner owner;
  /* Rows that are made. */
  size_t rows, *item;
  double *value, *radius, *bump, *number;
  char **label;
  size_t repeated; /* foils whose name an earlier one has */
  size_t several;  /* foils that share their scan with another */
  size_t failed, foreign, crushed, unknown;
} reading;

static fg_status find_response(fg_context *ctx, reading *r) {
  fg_foil_kind kind = r->out->design.kind;
  const fg_quantity_owner owners[] = {fg_foil_kind_parts(kind), FG_QUANTITY_OF_FOIL};
  char list[700] = "";
  for (size_t i = 0; i < 2; i++) {
    r->row = fg_quantity_find(owners[i], r->options->quantity);
    r->owner = owners[i];
    fg_quantity_list(owners[i], kind, false, list, sizeof list);
    if (r->row && r->row->kind == FG_QUANTITY_NUMBER) return FG_OK;
  }
  return fg_fail(ctx, FG_ERR_DATA, "'%s' is no quantity that a lot holds; there are: %s",
                 r->options->quantity, list);
}

static fg_status check_file_sum(fg_context *ctx, const reading *r, lot_file file,
                                const char *expected) {
  if (!strcmp(r->out->sha256[file], expected)) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: not the one that %s was made with; run `foilgauge lot` with --resume",
                 r->out->path[file], file_name[RESULTS]);
}

static fg_status read_folder(fg_context *ctx, reading *r) {
  char *text[FILES] = {NULL};
  fg_lot_table *out = r->out;
  fg_status status = FG_OK;
  for (int i = 0; i < FILES; i++) {
    FG_TRY_EXIT(fg_lot_path(ctx, r->folder, file_name[i], &out->path[i]));
    FG_TRY_EXIT(fg_file_read_text(ctx, out->path[i], TEXT_BYTES_MAX, &text[i]));
    fg_sha256_text(text[i], out->sha256[i]);
  }
  fg_lot_settings_default(&r->lot.settings);
  FG_TRY_EXIT(fg_lot_settings_parse(ctx, out->path[RECIPE], text[RECIPE], &r->lot.settings));
  FG_TRY_EXIT(fg_manifest_parse(ctx, out->path[MANIFEST], text[MANIFEST], "", &r->lot.manifest));
  FG_TRY_EXIT(fg_table_parse(ctx, out->path[MANIFEST], text[MANIFEST], strlen(text[MANIFEST]),
                             &r->manifest));
  if (r->manifest.rows != r->lot.manifest.items)
    FG_TRY_EXIT(
        fg_fail(ctx, FG_ERR_DATA, "%s: not as `foilgauge lot` wrote it", out->path[MANIFEST]));
  FG_TRY_EXIT(fg_lot_load(ctx, r->folder, &r->lot));
  FG_TRY_EXIT(check_file_sum(ctx, r, RECIPE, r->lot.head.recipe_sha256));
  FG_TRY_EXIT(check_file_sum(ctx, r, MANIFEST, r->lot.head.manifest_sha256));
  out->design = r->lot.settings.design;
exit:
  for (int i = 0; i < FILES; i++)
    free(text[i]);
  return status;
}

static bool is_of_parts(const reading *r) {
  return fg_owner_is_part(r->owner);
}

static size_t count_rows(const reading *r) {
  size_t rows = 0;
  for (size_t i = 0; i < r->lot.manifest.items; i++)
    for (size_t f = 0; f < r->lot.records[i].foil_count; f++)
      rows += is_of_parts(r) ? fg_part_count(&r->lot.records[i].foils[f], r->owner) : 1;
  return rows;
}

static fg_status allocate_rows(fg_context *ctx, reading *r) {
  size_t rows = count_rows(r);
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *r->item, (void **)&r->item));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *r->value, (void **)&r->value));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *r->radius, (void **)&r->radius));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *r->bump, (void **)&r->bump));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *r->number, (void **)&r->number));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *r->label, (void **)&r->label));
  return fg_memory_allocate(ctx, rows, sizeof *r->out->name, (void **)&r->out->name);
}

/* Adds a row of the object; an object without a value is counted. */
static fg_status append_row(fg_context *ctx, reading *r, size_t item, const fg_foil *foil,
                            const fg_foil_part *part) {
  size_t at = r->rows, foils = r->lot.records[item].foil_count;
  double value = fg_quantity_value(r->row, part ? part->object : (const void *)foil);
  const fg_bump *bump = part && r->owner == FG_QUANTITY_OF_BUMP ? part->object : NULL;
  const char *label = fg_manifest_label(&r->lot.manifest, item);
  if (!isfinite(value)) {
    r->unknown++;
    return FG_OK;
  }
  r->item[at] = item;
  r->value[at] = value;
  r->radius[at] = bump ? bump->radius_mm : 0;
  r->bump[at] = part ? part->number : 0;
  r->number[at] = foil->number;
  r->out->names = ++r->rows;
  FG_TRY(fg_text_print(ctx, &r->label[at], foils > 1 ? "%s #%d" : "%s", label, foil->number));
  if (!part) return fg_text_print(ctx, &r->out->name[at], "foil %s", r->label[at]);
  return fg_text_print(ctx, &r->out->name[at], "foil %s, %s %d", r->label[at],
                       fg_part_word(r->owner), part->number);
}

static fg_status append_foil_rows(fg_context *ctx, reading *r, size_t item, const fg_foil *foil) {
  r->several += r->lot.records[item].foil_count > 1;
  if (!fg_foil_is_measured(foil)) {
    r->foreign++;
    return FG_OK;
  }
  if (!is_of_parts(r)) return append_row(ctx, r, item, foil, NULL);
  for (size_t k = 0; k < fg_part_count(foil, r->owner); k++) {
    const fg_foil_part part = fg_part_at(foil, r->owner, k);
    bool counts = fg_lot_part_counts(foil, r->owner, &part);
    r->crushed += !counts;
    if (counts) FG_TRY(append_row(ctx, r, item, foil, &part));
  }
  return FG_OK;
}

static fg_status make_rows(fg_context *ctx, reading *r) {
  FG_TRY(allocate_rows(ctx, r));
  for (size_t i = 0; i < r->lot.manifest.items; i++) {
    const fg_record *record = &r->lot.records[i];
    r->failed += record->error != NULL;
    for (size_t f = 0; f < record->foil_count; f++)
      FG_TRY(append_foil_rows(ctx, r, i, &record->foils[f]));
  }
  if (r->rows) return FG_OK;
  const fg_foil_traits *kind = fg_foil_traits_of(r->out->design.kind);
  if (is_of_parts(r) && kind->is_plain_strip)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: a lot of %s (form %s) has no %s, which is of bumps; choose another "
                   "--response, such as %s",
                   r->folder, kind->plural, kind->name, r->options->quantity, kind->own_quantities);
  return fg_fail(ctx, FG_ERR_DATA, "%s: not one value of %s in %zu scans", r->folder,
                 r->options->quantity, r->lot.manifest.items);
}

static bool is_named(const reading *r, const char *column) {
  for (size_t i = 0; i < r->options->withouts; i++)
    if (!strcmp(r->options->without[i], column)) return true;
  return false;
}

/* Chooses the columns of the manifest that may be causes: sound ones, but for those that the table
 * makes itself. */
static fg_status choose_cause_columns(fg_context *ctx, reading *r) {
  const char *own[] = {
      "scan", "foil", "foil_number", fg_part_word(r->owner), "radius_mm", r->options->quantity};
  const fg_column *column;
  for (size_t i = 0; i < r->options->withouts; i++)
    FG_TRY(fg_table_find(ctx, &r->manifest, r->options->without[i], &column));
  for (size_t i = r->manifest.columns; i-- > 0;) {
    const char *name = r->manifest.column[i].name;
    bool drop = is_named(r, name);
    for (size_t k = 0; k < sizeof own / sizeof *own; k++)
      drop = drop || !strcmp(name, own[k]);
    FG_TRY(drop ? fg_table_drop(ctx, &r->manifest, name) : fg_table_check(ctx, &r->manifest, name));
  }
  return fg_table_count_words(ctx, &r->manifest, LEVELS_MAX, &r->out->said);
}

/* Returns true when a name stands at several foils, which were then measured again. */
static bool has_repeats(fg_context *ctx, const reading *r, fg_status *status) {
  fg_table names = {0};
  *status = fg_table_add_words(ctx, &names, "foil", (const char *const *)r->label, r->rows);
  bool repeats = *status == FG_OK && names.column[0].word_count < r->rows;
  fg_table_free(&names);
  return repeats;
}

static fg_status fill_lot_table(fg_context *ctx, reading *r) {
  fg_table *table = &r->out->table;
  fg_status status = FG_OK;
  bool grouped = is_of_parts(r) || has_repeats(ctx, r, &status);
  FG_TRY(status);
  FG_TRY(fg_table_select(ctx, &r->manifest, r->item, r->rows, table));
  free(table->line); /* the table's rows are not the manifest's */
  table->line = NULL;
  free(table->source);
  table->source = NULL;
  FG_TRY(fg_text_print(ctx, &table->source, "%s", r->folder));
  if (grouped) {
    FG_TRY(fg_table_add_words(ctx, table, "foil", (const char *const *)r->label, r->rows));
    r->out->group = "foil";
  }
  if (r->several) FG_TRY(fg_table_add_numbers(ctx, table, "foil_number", r->number, r->rows));
  if (is_of_parts(r))
    FG_TRY(fg_table_add_numbers(ctx, table, fg_part_word(r->owner), r->bump, r->rows));
  if (r->options->with_radius && r->owner == FG_QUANTITY_OF_BUMP &&
      strcmp(r->options->quantity, "radius_mm") != 0)
    FG_TRY(fg_table_add_numbers(ctx, table, "radius_mm", r->radius, r->rows));
  return fg_table_add_numbers(ctx, table, r->options->quantity, r->value, r->rows);
}

static fg_status describe_left_out(fg_context *ctx, reading *r) {
  bool beams = r->owner == FG_QUANTITY_OF_BEAM;
  const struct {
    size_t count;
    const char *words;
  } counts[] = {
      {r->failed, "scans that could not be measured"},
      {r->foreign, "foils that are none of the design"},
      {r->crushed, beams ? "torn, bent or hidden beams" : "crushed bumps"},
      {r->unknown, beams            ? "beams without a value"
                   : is_of_parts(r) ? "bumps without a value"
                                    : "foils without a value"},
  };
  for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
    if (counts[i].count)
      FG_TRY(fg_text_append_remark(ctx, &r->out->said, "left out: %zu %s", counts[i].count,
                                   counts[i].words));
  return FG_OK;
}

static fg_status read_lot_table(fg_context *ctx, reading *r) {
  FG_TRY(read_folder(ctx, r));
  FG_TRY(find_response(ctx, r));
  FG_TRY(make_rows(ctx, r));
  FG_TRY(choose_cause_columns(ctx, r));
  FG_TRY(describe_left_out(ctx, r));
  return fill_lot_table(ctx, r);
}

fg_status fg_lot_table_read(fg_context *ctx, const char *folder,
                            const fg_lot_table_options *options, fg_lot_table *out) {
  reading r = {.options = options, .folder = folder, .out = out};
  *out = (fg_lot_table){0};
  fg_status status = read_lot_table(ctx, &r);
  for (size_t i = 0; i < r.rows; i++)
    free(r.label[i]);
  free(r.label);
  free(r.item);
  free(r.value);
  free(r.radius);
  free(r.bump);
  free(r.number);
  fg_table_free(&r.manifest);
  fg_lot_free(&r.lot);
  if (status != FG_OK) fg_lot_table_free(out);
  return status;
}

void fg_lot_table_free(fg_lot_table *out) {
  for (size_t i = 0; i < out->names; i++)
    free(out->name[i]);
  free(out->name);
  fg_table_free(&out->table);
  for (int i = 0; i < FILES; i++)
    free(out->path[i]);
  free(out->said);
  *out = (fg_lot_table){0};
}

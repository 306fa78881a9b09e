/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "manual/documents.h"

#include <stdlib.h>
#include <string.h>

#include "compensation/members.h"
#include "lot/input/recipe_members.h"
#include "lots/members.h"
#include "process/plan_file.h"
#include "render/truth.h"
#include "report/design/members.h"
#include "report/die/members.h"
#include "report/doe/members.h"
#include "report/film/members.h"
#include "report/forming/members.h"
#include "report/grid_loop/members.h"
#include "report/load_test/members.h"
#include "report/lot/members.h"
#include "report/measure/members.h"
#include "report/scan_loop/members.h"
#include "report/scanner_change/members.h"
#include "report/table_loop/members.h"
#include "scan_loop/scanner_model.h"
#include "station/settings.h"

const fg_document *const fg_documents[] = {
    &fg_design_document,
    &fg_die_document,
    &fg_doe_document,
    &fg_expected_document,
    &fg_film_document,
    &fg_forming_document,
    &fg_forming_fit_document,
    &fg_grid_loop_document,
    &fg_hub_document,
    &fg_index_document,
    &fg_load_document,
    &fg_loop_document,
    &fg_loop_model_document,
    &fg_lot_document,
    &fg_next_die_document,
    &fg_nominal_document,
    &fg_outbox_document,
    &fg_part_document,
    &fg_plan_document,
    &fg_recipe_document,
    &fg_render_truth_document,
    &fg_scan_loop_document,
    &fg_scanner_change_document,
    &fg_scanner_model_document,
    &fg_station_settings_document,
    &fg_measure_document,
    NULL,
};

/* Writes the default of a member as JSON has it; nothing where there is none. */
static void write_usual(const fg_member *row, const void *usual, FILE *out) {
  char *text = NULL;
  size_t size;
  fg_json json;
  const fg_subject subject = {.object = usual, .whole = usual};
  if (!usual || row->kind == FG_MEMBER_HEAD || row->kind == FG_MEMBER_WRITTEN || row->members)
    return;
  FILE *stream = open_memstream(&text, &size);
  if (!stream) abort();
  fg_json_begin(&json, stream);
  fg_json_object(&json, NULL);
  fg_json_line(&json);
  fg_member_json(&json, row, &subject);
  fg_json_object_end(&json);
  fg_json_end(&json);
  if (fclose(stream) != 0) abort();
  const char *value = strstr(text, "\": ");
  if (value && !strchr(value, '{'))
    fprintf(out, " Default: %.*s.", (int)strcspn(value + 3, "}"), value + 3);
  free(text);
}

/* Writes the rows of an object, each with the names of the objects around it; `usual` is the object
 * with its defaults, or NULL. */
static void write_member_rows(const fg_members *members, const char *before, const void *usual,
                              FILE *out);

static const void *find_part(const fg_member *row, const void *usual) {
  const fg_subject subject = {.object = usual, .whole = usual};
  if (!usual || row->kind != FG_MEMBER_OBJECT || !fg_member_is_present(row, &subject)) return NULL;
  return fg_member_part(row, &subject).object;
}

/* Members of another document stand in the list of that. */
static bool is_elsewhere(const fg_member *row) {
  return row->schema && strstr(row->schema, ".schema.json") != NULL;
}

static void write_member_row(const fg_member *row, const char *before, const void *usual,
                             FILE *out) {
  char inside[400];
  bool list = row->kind == FG_MEMBER_LIST, map = row->kind == FG_MEMBER_MAP;
  if (row->options & FG_MEMBER_NOT_IN_JSON) return;
  if (row->kind == FG_MEMBER_SAME) {
    fg_member each;
    for (size_t i = 0; row->row_at && row->row_at(i, &each); i++)
      write_member_row(&each, before, usual, out);
    if (row->members) write_member_rows(row->members, before, usual, out);
    return;
  }
  const char *name = row->kind == FG_MEMBER_HEAD ? "schema" : row->name;
  if (!name && map) name = "*", map = false;
  if (!name) return;
  fprintf(out, "| `%s%s` | ", before, name);
  for (const char *c = row->words ? row->words : ""; *c; c++)
    fputs(*c == '|' ? "\\|" : (char[]){*c, '\0'}, out);
  if (row->kind == FG_MEMBER_HEAD) fprintf(out, "`%s`", row->name);
  if (row->highest > row->lowest && row->kind != FG_MEMBER_NUMBERS)
    fprintf(out, " From %.16g to %.16g.", row->lowest, row->highest);
  write_usual(row, usual, out);
  fputs(" |\n", out);
  if (row->kind == FG_MEMBER_HEAD && !(row->options & FG_MEMBER_NO_VERSION))
    fprintf(out, "| `%sversion` | of the program that wrote it |\n", before);
  if (row->sd_offset) fprintf(out, "| `%ssd_%s` | its standard deviation |\n", before, name);
  if (fg_member_has_u(row) || (row->kind == FG_MEMBER_PAIR && row->u_offset))
    fprintf(out, "| `%su_%s` | its standard uncertainty |\n", before, name);
  if (row->repeat_offset)
    fprintf(out, "| `%su_repeat_%s` | the same, of repeats alone |\n", before, name);
  if (!row->members || is_elsewhere(row)) return;
  snprintf(inside, sizeof inside, "%s%s%s.", before, name, list ? "[]" : map ? ".*" : "");
  write_member_rows(row->members, inside, find_part(row, usual), out);
}

static void write_member_rows(const fg_members *members, const char *before, const void *usual,
                              FILE *out) {
  for (size_t i = 0; i < members->count; i++)
    write_member_row(&members->rows[i], before, usual, out);
}

void fg_document_write_list(const fg_document *document, FILE *out) {
  fputs("| member | what it is |\n|---|---|\n", out);
  write_member_rows(document->members, document->inside ? document->inside : "",
                    document->find_usual ? document->find_usual() : NULL, out);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "manual/documents.h"

#include "lots/members.h"
#include "report/die/members.h"
#include "report/doe/members.h"
#include "report/forming/members.h"
#include "report/load_test/members.h"
#include "report/table_loop/members.h"

const fg_document *const fg_documents[] = {
    &fg_die_document,
    &fg_doe_document,
    &fg_forming_document,
    &fg_forming_fit_document,
    &fg_load_document,
    &fg_loop_document,
    &fg_loop_model_document,
    &fg_index_document,
    NULL,
};

/* Writes the rows of an object, each with the names of the objects around it. */
static void write_member_rows(const fg_members *members, const char *before, FILE *out);

static void write_member_row(const fg_member *row, const char *before, FILE *out) {
  char inside[400];
  bool list = row->kind == FG_MEMBER_LIST, map = row->kind == FG_MEMBER_MAP;
  if (row->options & FG_MEMBER_NOT_IN_JSON) return;
  if (row->kind == FG_MEMBER_SAME) {
    fg_member each;
    for (size_t i = 0; row->row_at && row->row_at(i, &each); i++)
      write_member_row(&each, before, out);
    if (row->members) write_member_rows(row->members, before, out);
    return;
  }
  const char *name = row->kind == FG_MEMBER_HEAD ? "schema" : row->name;
  if (!name && map) name = "*", map = false;
  if (!name) return;
  fprintf(out, "| `%s%s` | ", before, name);
  for (const char *c = row->words ? row->words : ""; *c; c++)
    fputs(*c == '|' ? "\\|" : (char[]){*c, '\0'}, out);
  if (row->kind == FG_MEMBER_HEAD) fprintf(out, "`%s`; beside it `version`", row->name);
  if (row->highest > row->lowest && row->kind != FG_MEMBER_NUMBERS)
    fprintf(out, " From %.16g to %.16g.", row->lowest, row->highest);
  fputs(" |\n", out);
  if (row->sd_offset) fprintf(out, "| `%ssd_%s` | its standard deviation |\n", before, name);
  if (fg_member_has_u(row)) fprintf(out, "| `%su_%s` | its standard uncertainty |\n", before, name);
  if (row->repeat_offset)
    fprintf(out, "| `%su_repeat_%s` | the same, of repeats alone |\n", before, name);
  if (!row->members) return;
  snprintf(inside, sizeof inside, "%s%s%s.", before, name, list ? "[]" : map ? ".*" : "");
  write_member_rows(row->members, inside, out);
}

static void write_member_rows(const fg_members *members, const char *before, FILE *out) {
  for (size_t i = 0; i < members->count; i++)
    write_member_row(&members->rows[i], before, out);
}

void fg_document_write_list(const fg_document *document, FILE *out) {
  fputs("| member | what it is |\n|---|---|\n", out);
  write_member_rows(document->members, "", out);
}

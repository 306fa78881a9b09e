/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members as lines of CSV: the column of a number with an uncertainty is followed by its u_. */
#include <math.h>

#include "core/csv.h"
#include "core/member.h"
#include "core/utf8.h"

void fg_members_csv_heading(FILE *out, const fg_member_columns *columns) {
  for (size_t i = 0; i < columns->count; i++) {
    const fg_member *row = columns->rows[i];
    const char *name = fg_member_heading(row, FG_ON_CSV);
    fprintf(out, "%s%s", i ? "," : "", name);
    if (fg_member_has_u(row) && !row->csv.no_u) fprintf(out, ",u_%s", name);
  }
}

static void put_number(FILE *out, const fg_member *member, double value) {
  char digits[32];
  if (!isfinite(value)) return;
  if (member->kind == FG_MEMBER_NUMBER && member->csv.decimals) {
    fprintf(out, "%.*f", member->csv.decimals, value);
  } else if (member->kind == FG_MEMBER_NUMBER) {
    fg_json_format(digits, member->csv.scale != 0 ? member->csv.scale * value : value);
    fputs(digits, out);
  } else if (member->kind == FG_MEMBER_FLAG) {
    fputs(value != 0 ? "true" : "false", out);
  } else {
    fprintf(out, "%.0f", value);
  }
}

void fg_members_csv_cells(FILE *out, const fg_member_columns *columns, const fg_subject *element) {
  char buffer[FG_MEMBER_TEXT_MAX];
  for (size_t i = 0; i < columns->count; i++) {
    const fg_member *row = columns->rows[i];
    const char *text = fg_member_text(row, element, buffer);
    if (i) fputc(',', out);
    if (text) fg_csv_put_text(out, text, fg_utf8_put);
    put_number(out, row, fg_member_value(row, element));
    if (!fg_member_has_u(row) || row->csv.no_u) continue;
    fputc(',', out);
    put_number(out, row, fg_member_u(row, element));
  }
}

void fg_members_csv(FILE *out, const fg_members *members, const fg_subject *list,
                    fg_member_element *element) {
  fg_subject row = {.whole = list->whole};
  fg_member_columns columns;
  fg_member_columns_of(members, FG_ON_CSV, list, &columns);
  fg_members_csv_heading(out, &columns);
  fputc('\n', out);
  for (size_t i = 0; fg_list_next(list, element, i, &row); i++) {
    if (!row.object) continue;
    fg_members_csv_cells(out, &columns, &row);
    fputc('\n', out);
  }
}

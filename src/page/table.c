/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "page/table.h"

#include <string.h>

#include "page/page.h"

static void put_column_heading(FILE *out, const fg_member *column) {
  const char *heading = fg_member_heading(column, FG_ON_PAGE);
  if (!*heading && !column->words) {
    fputs("<td></td>", out);
    return;
  }
  fputs(column->page.words ? "<th class=\"w\"" : "<th", out);
  if (column->words) {
    fputs(" title=\"", out);
    fg_html_text(out, column->words);
    fputc('"', out);
  }
  fputc('>', out);
  while (*heading) {
    char line[200];
    size_t length = strcspn(heading, "\n");
    snprintf(line, sizeof line, "%.*s", (int)length, heading);
    fg_html_text(out, line);
    heading += length;
    if (*heading) fputs("<br>", out), heading++;
  }
  fputs("</th>", out);
}

/* Writes text, a number with the sign of print. */
static void put_shown(FILE *out, const fg_member *column, const char *text) {
  bool number = fg_member_is_number(column) && text[0] == '-' && text[1];
  bool negative = number && text[1 + strspn(text + 1, "0.")];
  if (negative) fputs("−", out);
  fg_html_text(out, number ? text + 1 : text);
}

static void put_cell(FILE *out, const fg_member *column, const fg_subject *element) {
  char text[FG_MEMBER_TEXT_MAX];
  const char *look = column->look ? column->look(element) : NULL;
  if (column->page.words && !look) look = "words";
  fputs("<td", out);
  if (look && *look) fprintf(out, " class=\"%s\"", look);
  if (column->named) fputs(" translate=\"no\"", out);
  if (column->label) fprintf(out, " data-name=\"%s\"", column->label);
  fputc('>', out);
  if (column->markup) {
    column->markup(out, element);
    fputs("</td>", out);
    return;
  }
  fg_member_show(column, FG_ON_PAGE, element, text, sizeof text);
  put_shown(out, column, text);
  fg_member_show_u(column, FG_ON_PAGE, element, text, sizeof text);
  if (*text) fprintf(out, " <i>± %s</i>", text);
  fputs("</td>", out);
}

void fg_html_table_begin(FILE *out, const fg_member_columns *columns) {
  const char *frame = columns->members ? columns->members->frame : NULL;
  fprintf(out, "<div class=\"scroll%s%s\"><table>\n<thead><tr>", frame ? " " : "",
          frame ? frame : "");
  for (size_t i = 0; i < columns->count; i++)
    put_column_heading(out, columns->rows[i]);
}

void fg_html_table_rows(FILE *out) {
  fputs("</tr></thead>\n<tbody>\n", out);
}

void fg_html_table_row(FILE *out, const fg_member_columns *columns, const fg_subject *element) {
  const char *look = columns->members->look ? columns->members->look(element) : NULL;
  fputs("<tr", out);
  if (look) fprintf(out, " class=\"%s\"", look);
  fputc('>', out);
  for (size_t i = 0; i < columns->count; i++)
    put_cell(out, columns->rows[i], element);
}

void fg_html_table_end(FILE *out) {
  fputs("</tbody></table></div>\n", out);
}

void fg_html_table(FILE *out, const fg_members *members, const fg_subject *list,
                   fg_member_element *element) {
  fg_subject row = {.whole = list->whole};
  fg_member_columns columns;
  fg_member_columns_of(members, FG_ON_PAGE, list, &columns);
  fg_html_table_begin(out, &columns);
  fg_html_table_rows(out);
  for (size_t i = 0; fg_list_next(list, element, i, &row); i++) {
    if (!row.object) continue;
    fg_html_table_row(out, &columns, &row);
    fputs("</tr>\n", out);
  }
  fg_html_table_end(out);
}

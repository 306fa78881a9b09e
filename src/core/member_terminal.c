/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members as a table of the terminal: lines of the heading, then a line per element. */
#include <string.h>

#include "core/member.h"
#include "core/text.h"
#include "core/utf8.h"

enum { CELL_MAX = 1000, HEADING_LINES_MAX = 4, LINE_MAX = 4000 };

typedef struct column {
  const fg_member *member;
  int width, u_width; /* u_width 0: without U */
} column;

static int wider(int width, const char *text, size_t length) {
  char line[CELL_MAX];
  snprintf(line, sizeof line, "%.*s", (int)length, text);
  int count = (int)fg_utf8_count(line);
  return count > width ? count : width;
}

/* Returns line `k` of a heading and its length, without the comma before a unit; the empty text
 * behind the last. */
static const char *heading_line(const char *heading, int k, size_t *length) {
  for (; k > 0 && *heading; k--) {
    heading += strcspn(heading, "\n");
    if (*heading) heading++;
  }
  *length = strcspn(heading, "\n");
  if (*length && heading[*length] && heading[*length - 1] == ',') --*length;
  return heading;
}

static int measure_heading(column *target) {
  const char *heading = fg_member_heading(target->member, FG_ON_TERMINAL);
  int lines = 1;
  size_t length;
  for (int k = 0; k < HEADING_LINES_MAX; k++) {
    const char *line = heading_line(heading, k, &length);
    if (length) lines = k + 1;
    target->width = wider(target->width, line, length);
  }
  return lines;
}

static void measure_cell(column *target, const fg_subject *element) {
  char text[CELL_MAX];
  fg_member_show(target->member, FG_ON_TERMINAL, element, text, sizeof text);
  target->width = wider(target->width, text, strlen(text));
  fg_member_show_u(target->member, FG_ON_TERMINAL, element, text, sizeof text);
  target->u_width = wider(target->u_width, text, strlen(text));
}

/* A cell goes to a line of its own first: blanks at its end are not written. */
typedef struct terminal_line {
  char text[LINE_MAX];
  size_t used;
} terminal_line;

static void add_padded(terminal_line *to, const char *text, size_t length, int width, bool left) {
  int gap = width - wider(0, text, length), before = left || gap < 0 ? 0 : gap;
  int after = left && gap > 0 ? gap : 0;
  fg_text_clip(to->text + to->used, sizeof to->text - to->used, "%*s%.*s%*s", before, "",
               (int)length, text, after, "");
  to->used += strlen(to->text + to->used);
}

static void put_line(FILE *out, terminal_line *from) {
  while (from->used && from->text[from->used - 1] == ' ')
    from->used--;
  fprintf(out, "%.*s\n", (int)from->used, from->text);
}

static void put_heading_line(FILE *out, const char *indent, const column *columns, size_t count,
                             int number) {
  terminal_line to = {.used = 0};
  for (size_t i = 0; i < count; i++) {
    size_t length;
    const fg_member *member = columns[i].member;
    const char *text = heading_line(fg_member_heading(member, FG_ON_TERMINAL), number, &length);
    add_padded(&to, i ? "  " : indent, i ? 2 : strlen(indent), 0, true);
    add_padded(&to, text, length, columns[i].width, member->terminal.words);
    if (!columns[i].u_width) continue;
    add_padded(&to, " ", 1, 0, true);
    add_padded(&to, "±", number ? 0 : strlen("±"), columns[i].u_width, false);
  }
  put_line(out, &to);
}

static void put_element(FILE *out, const char *indent, const column *columns, size_t count,
                        const fg_subject *element) {
  char text[CELL_MAX];
  terminal_line to = {.used = 0};
  for (size_t i = 0; i < count; i++) {
    const fg_member *member = columns[i].member;
    fg_member_show(member, FG_ON_TERMINAL, element, text, sizeof text);
    add_padded(&to, i ? "  " : indent, i ? 2 : strlen(indent), 0, true);
    add_padded(&to, text, strlen(text), columns[i].width, member->terminal.words);
    if (!columns[i].u_width) continue;
    fg_member_show_u(member, FG_ON_TERMINAL, element, text, sizeof text);
    add_padded(&to, " ", 1, 0, true);
    add_padded(&to, text, strlen(text), columns[i].u_width, false);
  }
  put_line(out, &to);
}

void fg_members_terminal(FILE *out, const char *indent, const fg_members *members,
                         const fg_subject *list, fg_member_element *element) {
  fg_member_columns shown;
  column columns[FG_MEMBER_COLUMNS_MAX];
  fg_subject row = {.whole = list->whole};
  int lines = 1;
  fg_member_columns_of(members, FG_ON_TERMINAL, list, &shown);
  size_t count = shown.count;
  for (size_t i = 0; i < count; i++) {
    columns[i] = (column){.member = shown.rows[i]};
    int more = measure_heading(&columns[i]);
    if (more > lines) lines = more;
  }
  for (size_t k = 0; fg_list_next(list, element, k, &row); k++)
    for (size_t i = 0; row.object && i < count; i++)
      measure_cell(&columns[i], &row);
  for (int line = 0; line < lines; line++)
    put_heading_line(out, indent, columns, count, line);
  for (size_t k = 0; fg_list_next(list, element, k, &row); k++)
    if (row.object) put_element(out, indent, columns, count, &row);
}

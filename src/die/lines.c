/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "die/lines.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBER_CHARACTERS = 63 };

const char *fg_die_line_end(const char *at) {
  return at + strcspn(at, "\r\n");
}

const char *fg_die_line_next(const char *at) {
  const char *end = fg_die_line_end(at);
  if (end[0] == '\r' && end[1] == '\n') return end + 2;
  return *end ? end + 1 : end;
}

static bool is_blank(char c) {
  return c == ' ' || c == '\t';
}

static fg_die_field trimmed(const char *from, const char *to) {
  while (from < to && is_blank(*from))
    from++;
  while (to > from && is_blank(to[-1]))
    to--;
  if (to - from >= 2 && *from == '"' && to[-1] == '"') {
    from++;
    to--;
  }
  return (fg_die_field){from, (size_t)(to - from)};
}

static size_t split_blanks(const char *line, const char *end,
                           fg_die_field fields[FG_DIE_FIELDS_MAX]) {
  size_t count = 0;
  for (const char *at = line; at < end;) {
    while (at < end && is_blank(*at))
      at++;
    const char *from = at;
    while (at < end && !is_blank(*at))
      at++;
    if (at > from && count < FG_DIE_FIELDS_MAX) fields[count] = trimmed(from, at);
    count += at > from;
  }
  return count;
}

size_t fg_die_split(const char *line, const char *end, char separator,
                    fg_die_field fields[FG_DIE_FIELDS_MAX]) {
  size_t count = 0;
  if (separator == ' ') return split_blanks(line, end, fields);
  for (const char *from = line; from <= end; count++) {
    const char *to = memchr(from, separator, (size_t)(end - from));
    if (!to) to = end;
    if (count < FG_DIE_FIELDS_MAX) fields[count] = trimmed(from, to);
    from = to + 1;
  }
  /* Many programs end a line with a separator. */
  while (count > 1 && count <= FG_DIE_FIELDS_MAX && !fields[count - 1].length)
    count--;
  return count;
}

bool fg_die_number(const fg_die_field *field, bool comma_decimal, double *value) {
  char text[NUMBER_CHARACTERS + 1], *end;
  bool digit = false;
  if (!field->length || field->length > NUMBER_CHARACTERS) return false;
  for (size_t i = 0; i < field->length; i++) {
    char c = field->text[i];
    if (comma_decimal && c == '.') return false;
    text[i] = comma_decimal && c == ',' ? '.' : c;
    digit = digit || (c >= '0' && c <= '9');
    if (!strchr("0123456789+-.eE", text[i])) return false;
  }
  text[field->length] = '\0';
  *value = strtod(text, &end);
  return digit && !*end && isfinite(*value);
}

bool fg_die_looks_numeric(const char *line, const char *end) {
  bool digit = false;
  for (const char *at = line; at < end; at++) {
    if (!strchr("0123456789+-.,;eE \t\"", *at)) return false;
    digit = digit || (*at >= '0' && *at <= '9');
  }
  return digit && line < end;
}

/* Marks found in the lines of a file. */
typedef struct marks {
  size_t lines, commas, points, most_commas;
  bool semicolon, tab, blank, comma_blank;
} marks;

static void look_at(const char *line, const char *end, marks *seen) {
  size_t commas = 0;
  while (line < end && is_blank(*line))
    line++;
  while (end > line && is_blank(end[-1]))
    end--;
  for (const char *at = line; at < end; at++) {
    commas += *at == ',';
    seen->points += *at == '.';
    seen->semicolon |= *at == ';';
    seen->tab |= *at == '\t';
    seen->blank |= *at == ' ';
    seen->comma_blank |= *at == ',' && at + 1 < end && is_blank(at[1]);
  }
  seen->commas += commas;
  if (commas > seen->most_commas) seen->most_commas = commas;
  seen->lines++;
}

const char *fg_die_style_find(const char *text, fg_die_style *style) {
  marks seen = {0};
  for (const char *at = text; *at; at = fg_die_line_next(at))
    if (fg_die_looks_numeric(at, fg_die_line_end(at))) look_at(at, fg_die_line_end(at), &seen);
  char separator = seen.semicolon ? ';' : seen.tab ? '\t' : ' ';
  bool comma_separates = separator == ' ' && (seen.comma_blank || !seen.blank);
  *style = (fg_die_style){comma_separates ? ',' : separator, !comma_separates && seen.commas};
  if (comma_separates && !seen.points && seen.commas && !seen.comma_blank)
    return seen.most_commas > 2
               ? "commas stand for the decimal mark and between the columns; write semicolons or "
                 "tabs between them"
               : "a comma may be the decimal mark or stand between two whole numbers; write "
                 "semicolons or tabs between the columns";
  if (style->comma_decimal && seen.points)
    return "numbers have commas and points; one of them must be the decimal mark, and thousands "
           "are not separated";
  return NULL;
}

bool fg_die_is_data(const char *line, const char *end) {
  fg_die_field fields[FG_DIE_FIELDS_MAX];
  double value;
  if (!fg_die_looks_numeric(line, end)) return false;
  const char *separators = "; \t,";
  for (size_t s = 0; separators[s]; s++) {
    size_t count = fg_die_split(line, end, separators[s], fields), numbers = 0;
    for (size_t i = 0; i < count && i < FG_DIE_FIELDS_MAX; i++)
      numbers +=
          fg_die_number(&fields[i], false, &value) || fg_die_number(&fields[i], true, &value);
    if (count >= 2 && numbers == count) return true;
  }
  return false;
}

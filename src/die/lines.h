/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines of a profile's text, and their numbers. */
#ifndef FG_DIE_LINES_H
#define FG_DIE_LINES_H

#include <stdbool.h>
#include <stddef.h>

enum { FG_DIE_FIELDS_MAX = 16 };

/* Format of the file's columns. */
typedef struct fg_die_style {
  char separator;     /* ';' '\t' ',' or ' ' */
  bool comma_decimal; /* 1,5 */
} fg_die_style;

typedef struct fg_die_field {
  const char *text;
  size_t length;
} fg_die_field;

/* Returns the end of the line at `at` (line feed, carriage return or both follow), and the start of
 * the next line. */
const char *fg_die_line_end(const char *at);
const char *fg_die_line_next(const char *at);

/* Splits a line into fields without surrounding blanks; fields beyond FG_DIE_FIELDS_MAX are only
 * counted. */
size_t fg_die_split(const char *line, const char *end, char separator,
                    fg_die_field fields[FG_DIE_FIELDS_MAX]);

/* A number with a point or, where `comma_decimal`, a comma. */
bool fg_die_number(const fg_die_field *field, bool comma_decimal, double *value);

/* Returns true when the line has only digits, signs, marks and separators. */
bool fg_die_looks_numeric(const char *line, const char *end);

/* Returns true for two numbers or more, with any marks and separators. */
bool fg_die_is_data(const char *line, const char *end);

/* Finds the format of the lines from `text` on that look numeric. Returns NULL, or the reason why
 * it is ambiguous. */
const char *fg_die_style_find(const char *text, fg_die_style *style);

#endif

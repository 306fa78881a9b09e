/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines of a profile's text, and the numbers that stand in them. */
#ifndef FG_DIE_LINES_H
#define FG_DIE_LINES_H

#include <stdbool.h>
#include <stddef.h>

enum { FG_DIE_FIELDS_MAX = 16 };

/* How the file writes its columns. */
typedef struct fg_die_style {
  char separator;     /* ';' '\t' ',' or ' ' */
  bool comma_decimal; /* 1,5 */
} fg_die_style;

typedef struct fg_die_field {
  const char *text;
  size_t length;
} fg_die_field;

/* The line at `at`: its end (line feed, carriage return or both are behind it), and the next. */
const char *fg_die_line_end(const char *at);
const char *fg_die_line_next(const char *at);

/* Cuts a line into fields without the blanks around them; what is beyond FG_DIE_FIELDS_MAX is
 * counted only. */
size_t fg_die_split(const char *line, const char *end, char separator,
                    fg_die_field fields[FG_DIE_FIELDS_MAX]);

/* A number with a point or, where `comma_decimal`, a comma. */
bool fg_die_number(const fg_die_field *field, bool comma_decimal, double *value);

/* Whether nothing but digits, signs, marks and separators stand in it. */
bool fg_die_looks_numeric(const char *line, const char *end);

/* Whether it is two numbers or more, whatever marks and separators the file has. */
bool fg_die_is_data(const char *line, const char *end);

/* How the lines from `text` on are written that look numeric. NULL, or what makes it uncertain. */
const char *fg_die_style_find(const char *text, fg_die_style *style);

#endif

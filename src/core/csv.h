/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cells of comma-separated values: RFC 4180, as Europe writes it too (semicolons, decimal commas),
 * and no cell that a spreadsheet would take for a formula.
 *
 * A text that begins with = + - @, a tab or a carriage return gets an apostrophe before it, as
 * OWASP (CSV injection) says, unless it is a number, with a point or a comma. A text that begins
 * with apostrophes and one of these gets one as well, so that a reader who takes one away has the
 * text as it was written. */
#ifndef FG_CORE_CSV_H
#define FG_CORE_CSV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

bool fg_csv_needs_apostrophe(const char *text);
bool fg_csv_needs_quotes(const char *text);

/* Writes one character of a text and returns how many bytes it took. */
typedef size_t fg_csv_character(FILE *out, const char *text);

/* A whole cell; `put` NULL writes the bytes as they are. */
void fg_csv_put_text(FILE *out, const char *text, fg_csv_character *put);

/* A comma and the number, as JSON has it (core/json_writer.h); nothing behind the comma for what is
 * none. */
void fg_csv_put_number(FILE *out, double value);

/* How many bytes the line `sep=;` at the begin takes that spreadsheets write, and its separator; 0
 * without one. */
size_t fg_csv_hint(const char *text, size_t size, unsigned char *separator);

/* Comma, semicolon or tab: whichever the first rows hold equally often as the header (where several
 * do, tab before semicolon before comma: only commas stand in numbers and names), else the one that
 * the header holds most. What stands in quotes does not count. */
unsigned char fg_csv_separator(const char *text, size_t size);

/* How a cell writes a number. */
typedef enum fg_csv_number {
  FG_CSV_WORD,      /* it is none */
  FG_CSV_WHOLE,     /* 12, 1e-3 */
  FG_CSV_POINT,     /* 1.5 */
  FG_CSV_COMMA,     /* 1,5 */
  FG_CSV_THOUSANDS, /* 1,234,567  1.234,5  1 234,5  1'234 */
} fg_csv_number;

fg_csv_number fg_csv_number_kind(const char *text, size_t length);

/* Whether a number with a comma can as well be one of thousands: 1,234 but not 0,234 or 1,5. */
bool fg_csv_may_be_thousands(const char *text, size_t length);

/* The number in a cell of the kind FG_CSV_COMMA, with a point; `size` of the text at most, else
 * false. */
bool fg_csv_point(const char *cell, size_t length, char *text, size_t size);

/* Takes away the apostrophe of a cell that was read, where one was put. */
void fg_csv_take_apostrophe(const char **text, size_t *length);

#endif

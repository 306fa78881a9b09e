/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cells of comma-separated values: RFC 4180, also with semicolons and decimal commas, and no cell
 * that a spreadsheet would take for a formula.
 *
 * A text that begins with = + - @, a tab or a carriage return gets an apostrophe before it, as
 * OWASP (CSV injection) demands, unless it is a number, with a point or a comma. A text that begins
 * with apostrophes and one of these gets one as well: a reader that removes one apostrophe then has
 * the original text. */
#ifndef FG_CORE_CSV_H
#define FG_CORE_CSV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

bool fg_csv_needs_apostrophe(const char *text);
bool fg_csv_needs_quotes(const char *text);

/* Writes one character of a text and returns the number of its bytes. */
typedef size_t fg_csv_character(FILE *out, const char *text);

/* Writes a whole cell; `put` NULL writes the bytes unchanged. */
void fg_csv_put_text(FILE *out, const char *text, fg_csv_character *put);

/* Writes a comma and the number, as JSON has it (core/json_writer.h); nothing after the comma for
 * NaN and infinities. */
void fg_csv_put_number(FILE *out, double value);

/* Returns the length of the first line `sep=;`, which spreadsheets write, and its separator; 0
 * without one. */
size_t fg_csv_hint(const char *text, size_t size, unsigned char *separator);

/* Finds the separator: comma, semicolon or tab. It is the one that the first rows hold equally
 * often as the header. Of several, tab goes before semicolon before comma, since numbers and names
 * hold commas only. Without any, it is the header's most frequent one. Text in quotes does not
 * count. */
unsigned char fg_csv_separator(const char *text, size_t size);

/* Notation of a cell's number. */
typedef enum fg_csv_number {
  FG_CSV_WORD,      /* no number */
  FG_CSV_WHOLE,     /* 12, 1e-3 */
  FG_CSV_POINT,     /* 1.5 */
  FG_CSV_COMMA,     /* 1,5 */
  FG_CSV_THOUSANDS, /* 1,234,567  1.234,5  1 234,5  1'234 */
} fg_csv_number;

fg_csv_number fg_csv_number_kind(const char *text, size_t length);

/* Returns true when a number with a comma can as well be one of thousands: 1,234 but not 0,234 or
 * 1,5. */
bool fg_csv_may_be_thousands(const char *text, size_t length);

/* Copies a cell of the kind FG_CSV_COMMA with a decimal point; false when it does not fit into
 * `size`. */
bool fg_csv_point(const char *cell, size_t length, char *text, size_t size);

/* Removes the escaping apostrophe of a cell that was read. */
void fg_csv_drop_apostrophe(const char **text, size_t *length);

#endif

/* Cells of comma-separated values: RFC 4180, and no cell that a spreadsheet would take for a
 * formula.
 *
 * A text that begins with = + - @, a tab or a carriage return gets an apostrophe before it, as
 * OWASP (CSV injection) says, unless it is a number. A text that begins with apostrophes and one of
 * these gets one as well, so that a reader who takes one away has what was written. */
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

/* Takes away the apostrophe of a cell that was read, where one was put. */
void fg_csv_take_apostrophe(const char **text, size_t *length);

#endif

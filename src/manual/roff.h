/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Manual pages: reads text with light marks, writes roff (man macros). */
#ifndef FG_MANUAL_ROFF_H
#define FG_MANUAL_ROFF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Writes characters as they are; those that roff would take for a command are escaped. */
void fg_roff_escape(const char *text, size_t length, FILE *out);

/* Writes a line of running text: `code` in bold, **words** in bold, [words](address) as words. */
void fg_roff_inline(const char *text, size_t length, FILE *out);

/* Writes a text of paragraphs, `## Headings`, tables (| a | b |), lists (- a) and indented
 * examples; `#` headings and the text before the first heading are left out. In a cell `\\|` is
 * a bar. False: a row of a table has more or fewer cells than its head. */
bool fg_roff_text(const char *text, FILE *out);

#endif

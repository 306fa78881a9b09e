/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Manual pages: text with light marks in, roff (man macros) out. */
#ifndef FG_MANUAL_ROFF_H
#define FG_MANUAL_ROFF_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Characters as they are, with nothing that roff would take for a command. */
void fg_roff_escape(const char *text, size_t length, FILE *out);

/* A line of running text: `code` in bold, **words** in bold, [words](address) as words. */
void fg_roff_inline(const char *text, size_t length, FILE *out);

/* A text of paragraphs, `## Headings`, tables (| a | b |), lists (- a) and indented examples; `#`
 * headings and the text before the first heading are left out. In a cell `\\|` is a bar. False: a
 * row of a table has more or fewer cells than its head. */
bool fg_roff_text(const char *text, FILE *out);

#endif

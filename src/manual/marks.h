/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Facts that the code fills into a text, so that the two cannot disagree. The text in the
 * repository is complete without them: of <!--@name@-->value<!--@--> a reader of Markdown sees the
 * value. */
#ifndef FG_MANUAL_MARKS_H
#define FG_MANUAL_MARKS_H

#include <stdbool.h>
#include <stdio.h>

/* Writes the text with every fact filled in. False, with the reason in `wrong`, for an unknown
 * fact, a mark without an end, or a number or word in the text that differs from the code. A fact
 * of several lines (a table) replaces a sentence that says where it is. */
bool fg_manual_fill(const char *text, char wrong[200], FILE *out);

#endif

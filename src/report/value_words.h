/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words of sentences: a number with its uncertainty, a length, lines of a terminal. */
#ifndef FG_REPORT_VALUE_WORDS_H
#define FG_REPORT_VALUE_WORDS_H

#include <stddef.h>
#include <stdio.h>

/* Writes "0.0010003 ± 0.0000012": value and U = 2u, U with two digits. */
void fg_scan_loop_value_words(double value, double u, char *words, size_t size);

/* Writes "0.0302 µm"; nm only below a nanometre, so that numbers beside each other have one
 * unit. */
void fg_scan_loop_length_words(double um, char *words, size_t size);

/* Writes text in lines of a terminal that is not too narrow: the first line starts with `first`,
 * the others with `indent`. A word longer than a line gets a line of its own. */
void fg_write_wrapped(FILE *out, const char *first, const char *indent, const char *text);

#endif

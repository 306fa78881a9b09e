/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A number with its uncertainty, and a length, as sentences write them. */
#ifndef FG_REPORT_VALUE_WORDS_H
#define FG_REPORT_VALUE_WORDS_H

#include <stddef.h>

/* Writes "0.0010003 ± 0.0000012": value and U = 2u, U with two digits. */
void fg_scan_loop_value_words(double value, double u, char *words, size_t size);

/* Writes "0.0302 µm"; nm only below a nanometre, so that numbers beside each other have one
 * unit. */
void fg_scan_loop_length_words(double um, char *words, size_t size);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A number with its uncertainty, and a length, as sentences say them. */
#ifndef FG_REPORT_VALUE_WORDS_H
#define FG_REPORT_VALUE_WORDS_H

#include <stddef.h>

/* "0.0010003 ± 0.0000012": value and U = 2u, U with two digits. */
void fg_scan_loop_value_words(double value, double u, char *words, size_t size);

/* "0.0302 µm"; nm below a nanometre, so that figures beside each other have one unit. */
void fg_scan_loop_length_words(double um, char *words, size_t size);

#endif

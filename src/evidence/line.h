/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields over a line: sines of a Hilbert-space Gaussian process (Solin and Särkkä 2020) on a domain
 * wider than the rows, and polynomials for waves longer than the domain. */
#ifndef FG_EVIDENCE_LINE_H
#define FG_EVIDENCE_LINE_H

#include <stdbool.h>
#include <stddef.h>

enum { FG_LINE_SINES = 36, FG_LINE_LONG = 4, FG_LINE_COLUMNS = FG_LINE_SINES + FG_LINE_LONG };

typedef struct fg_line {
  double middle, half;
} fg_line;

fg_line fg_line_over(double low, double high);
void fg_line_fill(const fg_line *line, double at, double *values);
/* Fills the variances for length i, the first by a factor of two each; false beyond the last. */
bool fg_line_variances(const fg_line *line, double first, size_t i, double *variance);

#endif

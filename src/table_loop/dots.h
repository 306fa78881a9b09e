/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dot products over many rows, several vectors at a time. */
#ifndef FG_TABLE_LOOP_DOTS_H
#define FG_TABLE_LOOP_DOTS_H

#include <stddef.h>

/* sums[k] += a'v_k for `count` vectors of length n that are `stride` apart. */
void fg_engine_add_dots(size_t n, const double *a, const double *v, size_t stride, size_t count,
                        double *sums);

/* v -= the sum of along[k] times vector k of `basis`, each of length n. */
void fg_engine_subtract(size_t n, const double *basis, size_t count, const double *along,
                        double *v);

/* along[k] = v'basis_k. */
void fg_engine_dots(size_t n, const double *basis, size_t count, const double *v, double *along);

#endif

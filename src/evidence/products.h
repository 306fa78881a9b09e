/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Products of a problem's columns. They are kept where they are found, so threads may ask for them
 * at once only after one of the fg_evidence_find functions has found all that they ask for. */
#ifndef FG_EVIDENCE_PRODUCTS_H
#define FG_EVIDENCE_PRODUCTS_H

#include "evidence/problem.h"

/* Fills `into` with the products of a column with columns [first, first + count). */
void fg_evidence_products(fg_evidence_problem *problem, size_t column, size_t first, size_t count,
                          double *into);

/* Finds the products of every column with those of its set: `first[c]` is the first of column c's.
 * Threads: see fg_parallel_run. */
fg_status fg_evidence_find_own_products(fg_context *ctx, fg_evidence_problem *problem,
                                        const size_t *first, unsigned threads);

/* Finds the products of some columns with each other, and with those that are `wanted` (by column).
 */
fg_status fg_evidence_find_products(fg_context *ctx, fg_evidence_problem *problem,
                                    const size_t *column, size_t count, const bool *wanted,
                                    unsigned threads);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kinds of candidates of the loop, which share the error rate of a search: each has its share,
 * however many candidates it has. */
#ifndef FOILGAUGE_LOOP_KIND_H
#define FOILGAUGE_LOOP_KIND_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum fg_loop_kind {
  FG_LOOP_KIND_COLUMNS,      /* levels, slopes and bends over a recorded column, orders of a base
                                period that is known of it */
  FG_LOOP_KIND_INTERACTIONS, /* of two recorded columns */
  FG_LOOP_KIND_CURVES,       /* steps, cycles and free curves over a column */
  FG_LOOP_KIND_ORDER,        /* everything over an order, correlation of neighbours included */
  FG_LOOP_KIND_SCATTER,      /* a scatter that changes */
  FG_LOOP_KIND_ROWS,         /* single outlier rows */
  FG_LOOP_KIND_EXCHANGES,    /* two exchanged responses */
  FG_LOOP_KINDS
} fg_loop_kind;

/* Words by kind; NULL behind the last. */
extern const char *const fg_loop_kind_words[];

/* Computes the kinds' shares of the error rate, with sum 1: half of it goes to the expected kinds,
 * if there are any, the other half is shared as without them. */
void fg_loop_kind_shares(const bool expected[FG_LOOP_KINDS], double share[FG_LOOP_KINDS]);

struct fg_loop_problem;
struct fg_loop_candidate;
/* Returns the kind of a candidate. */
fg_loop_kind fg_loop_kind_of(const struct fg_loop_problem *problem,
                             const struct fg_loop_candidate *candidate);

#ifdef __cplusplus
}
#endif
#endif

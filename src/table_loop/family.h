/* SPDX-License-Identifier: GPL-3.0-or-later */
/* P-values over the whole family of candidates: of the maximum over each kind, and of the smallest
 * of these with each kind's share of the error rate. */
#ifndef FG_TABLE_LOOP_FAMILY_H
#define FG_TABLE_LOOP_FAMILY_H

#include "table_loop/engine.h"

typedef struct fg_engine_family {
  double share[FG_LOOP_KINDS];
  /* Tail of a kind's maximum: its p-value is 1 - (1 - q)^tests, q = Q(z)^power. */
  double tests[FG_LOOP_KINDS], power[FG_LOOP_KINDS];
  /* Smallest weighted p-values of the draws, ascending: they say how often kinds that depend on
   * each other come as near together. NULL: not drawn. */
  double *min_p;
  size_t draws;
  double min_p_tests, min_p_power; /* tail of these, as of a kind's maximum */
} fg_engine_family;

/* Fits the family to the maxima of the draws: draws × FG_LOOP_KINDS, -infinity where a kind has no
 * candidate. `family` has its shares. */
fg_status fg_engine_family_fit(fg_context *ctx, size_t draws, const double *maxima,
                               fg_engine_family *family);
/* The family of many rows: `tests` of each kind are counted, not drawn. */
void fg_engine_family_count(const double tests[FG_LOOP_KINDS], fg_engine_family *family);
void fg_engine_family_free(fg_engine_family *family);

/* Returns the p-value of a kind's normal deviate over that kind alone; 1 for NaN. */
double fg_engine_family_kind_p(const fg_engine_family *family, fg_loop_kind kind, double z);
/* Returns it over the whole family. */
double fg_engine_family_p(const fg_engine_family *family, fg_loop_kind kind, double z);
/* Returns the smallest deviate with that p-value over the whole family. */
double fg_engine_family_critical(const fg_engine_family *family, fg_loop_kind kind, double p);

#endif

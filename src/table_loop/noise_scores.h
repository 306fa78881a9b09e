/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scores of a residual's noise: serial correlation, unequal spread, random levels. */
#ifndef FG_TABLE_LOOP_NOISE_SCORES_H
#define FG_TABLE_LOOP_NOISE_SCORES_H

#include "table_loop/spread_likelihood.h"

typedef struct fg_engine_spread {
  bool serial;
  size_t columns;
  double *z;                  /* n: standardised coordinate of a slope */
  fg_engine_spread_grid grid; /* where rows are few */
  size_t *level;              /* n: index of a level, 0 .. columns */
  double *unit;               /* of random levels: rank × n, orthonormal beside the null */
  size_t rank;
  bool between; /* of levels that hold groups: tested between these */
  double
      *stratum; /* the groups' differences, or the levels that hold the candidate's: NULL: none */
  size_t stratum_rank;
} fg_engine_spread;

typedef struct fg_engine_noise_scores {
  const fg_engine_training *training;
  fg_engine_noise noise;
  const fg_engine_span *null;
  size_t count;
  fg_engine_spread *spread; /* count */
} fg_engine_noise_scores;

fg_status fg_engine_noise_scores_open(fg_context *ctx, const fg_engine_training *training,
                                      fg_engine_noise noise, const fg_engine_span *null,
                                      const fg_loop_candidate *candidate, size_t candidates,
                                      fg_engine_noise_scores *scores);
void fg_engine_noise_scores_close(fg_engine_noise_scores *scores);
/* Computes a normal deviate of each for one response (not whitened); `work` has room for 2 n. */
void fg_engine_noise_scores_of(const fg_engine_noise_scores *scores, const double *y, double *work,
                               double *z);

#endif

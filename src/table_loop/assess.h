/* SPDX-License-Identifier: GPL-3.0-or-later */
/* P-values of all candidates of a step over one null. */
#ifndef FG_TABLE_LOOP_ASSESS_H
#define FG_TABLE_LOOP_ASSESS_H

#include "table_loop/family.h"

/* Draws of the null, and the level at which an effect is accepted. */
typedef struct fg_engine_null {
  size_t draws;
  uint64_t seed;
  double accept_p;
  const double *share; /* FG_LOOP_KINDS */
} fg_engine_null;

/* Scores and p-values of a step. Candidates of the mean come first, then those of the noise; the
 * exchange of two rows is one more. */
typedef struct fg_engine_judgement {
  size_t means, candidates;
  fg_engine_score *score; /* means */
  fg_loop_kind *kind;     /* of each */
  double *z;              /* normal deviate of each, on one scale; NaN where it has no score */
  double *p;              /* p-value over the whole family */
  double *z_critical;     /* means: smallest raw deviate that is accepted; from draws */
  double *f_critical;     /* means: smallest F ratio that is accepted; infinity: none */
  fg_engine_family family;
  size_t noise;          /* best noise of the null, index into the workspace's */
  double exchange_ratio; /* residual sum after / before */
  size_t exchanged[2];   /* rows of the training set */
  bool has_exchange;
} fg_engine_judgement;

/* `noise` are candidates of the noise, assessed beside the workspace's. */
fg_status fg_engine_judge(fg_context *ctx, const fg_score_workspace *workspace,
                          const fg_loop_candidate *noise, size_t noises, const fg_engine_null *null,
                          fg_engine_judgement *judgement);
void fg_engine_judgement_free(fg_engine_judgement *judgement);

/* Finds, for few rows, the amplitude of every candidate of the mean (half range, in units of the
 * rows' own sd) that is accepted in four draws of five; NaN where none is. Curves included. */
fg_status fg_engine_smallest_amplitudes(fg_context *ctx, const fg_score_workspace *workspace,
                                        const fg_engine_judgement *judgement, uint64_t seed,
                                        double *amplitude);

/* Outlier rows: their likeliest number, and the row with the largest residual. */
typedef struct fg_engine_outlier {
  fg_loop_candidate candidate,
      first; /* number of outliers (one where none is significant); the first of them */
  bool known;
  double ratio;   /* residual sum after over before, of the first row */
  double p_value; /* over the family, against the tails of the other rows, and of the whole group */
  double apart_p; /* against the tails of the other rows alone */
  double size, normal_p; /* of the first: in sd of the others, and its p-value for normal noise */
  double f_critical;     /* of one row, with one dof */
  double length;         /* mean |M W e|² of a row */
} fg_engine_outlier;

/* Level of a test of outlier rows: over the family, of which they have a share. */
typedef struct fg_engine_level {
  double accept_p, share;
} fg_engine_level;

/* `null` is the training set's at that noise. */
fg_status fg_engine_assess_outlier(fg_context *ctx, const fg_engine_training *training,
                                   fg_engine_noise noise, const fg_engine_span *null,
                                   fg_engine_level level, fg_engine_outlier *outlier);

/* Exchange of two responses (exchange.c). */
typedef struct fg_engine_exchange {
  const fg_engine_training *training;
  fg_engine_noise noise;
  const fg_engine_span *null;
  size_t n;
  double *a;    /* n × n: the residual sum is y'Ay; NULL where rows are independent */
  double *mean; /* expectation of the response under the null */
} fg_engine_exchange;

fg_status fg_engine_exchange_open(fg_context *ctx, const fg_engine_training *training,
                                  fg_engine_noise noise, const fg_engine_span *null,
                                  fg_engine_exchange *exchange);
void fg_engine_exchange_close(fg_engine_exchange *exchange);
/* Finds the exchange with the smallest residual sum, after over before; infinity when none changes
 * anything. `y` is the response less the null's start; `work` has room for 3 n. */
double fg_engine_exchange_best(const fg_engine_exchange *exchange, const double *y,
                               const double *response, double *work, size_t row[2]);

#endif

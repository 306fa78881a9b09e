/* SPDX-License-Identifier: GPL-3.0-or-later */
/* P-values of everything that a step looks for, over one null. */
#ifndef FG_TABLE_LOOP_ASSESS_H
#define FG_TABLE_LOOP_ASSESS_H

#include "table_loop/engine.h"

/* Of what may be claimed by chance at all, the candidates have this part. Lone rows are judged
 * against tails that normal noise does not have: of normal noise they claim next to nothing
 * (reports/loop_power.md). */
#define FG_ENGINE_SHARE_OF_CANDIDATES 0.95
#define FG_ENGINE_SHARE_OF_ROWS       0.9

/* How the null is drawn, and the level at which an effect would be accepted. */
typedef struct fg_engine_null {
  size_t draws;
  uint64_t seed;
  double accept_p;
} fg_engine_null;

/* Candidates of the mean first, then those of the noise; the exchange of two rows is one more. */
typedef struct fg_engine_judgement {
  size_t means, candidates;
  fg_engine_score *score; /* means */
  double *z;              /* deviate of each, all on one scale; NaN where it cannot be scored */
  double *p;              /* over all that was looked for */
  double *z_critical;     /* means: raw deviate that would just pass; drawn */
  double *f_critical;     /* means: F ratio that would; infinity: none does */
  double tests;           /* so many independent looks are worth all of them */
  size_t noise;           /* best noise of the null, index into the bench's */
  double exchange_ratio;  /* residual sum after / before */
  size_t exchanged[2];    /* rows of the training */
  bool has_exchange;
} fg_engine_judgement;

/* `noise` are candidates of the noise, judged beside the bench's. */
fg_status fg_engine_judge(fg_context *ctx, const fg_score_workspace *workspace,
                          const fg_loop_candidate *noise, size_t noises, const fg_engine_null *null,
                          fg_engine_judgement *judgement);
void fg_engine_judgement_free(fg_engine_judgement *judgement);

/* Few rows: for every candidate of the mean the amplitude (half range; of unit variance of the
 * rows' own noise) that passes in four draws of five; NaN where none does. Curves included. */
fg_status fg_engine_smallest_amplitudes(fg_context *ctx, const fg_score_workspace *workspace,
                                        const fg_engine_judgement *judgement, uint64_t seed,
                                        double *amplitude);

/* Wrong rows, the likeliest number of them, and the row that stands out most by itself. */
typedef struct fg_engine_outlier {
  fg_loop_candidate candidate,
      first; /* all that are wrong (one where none is); the first of them */
  bool known;
  double ratio;          /* residual sum after / before, of the candidate */
  double p_value;        /* over all rows, against the tails that the other rows show, and of all */
  double apart_p;        /* against those of the other rows alone */
  double size, normal_p; /* of the first: in sd of the others, and its p-value were noise normal */
  double f_critical;     /* of one row; one freedom */
  double length;         /* mean |M W e|² of a row */
} fg_engine_outlier;

/* `null` is the training's at that noise. */
fg_status fg_engine_assess_outlier(fg_context *ctx, const fg_engine_training *training,
                                   fg_engine_noise noise, const fg_engine_span *null,
                                   double accept_p, fg_engine_outlier *outlier);

/* Two responses that changed places. exchange.c */
typedef struct fg_engine_exchange {
  const fg_engine_training *training;
  fg_engine_noise noise;
  const fg_engine_span *null;
  size_t n;
  double *a;    /* n × n: the residual sum is y'Ay; NULL where rows are independent */
  double *mean; /* what the null expects of the response */
} fg_engine_exchange;

fg_status fg_engine_exchange_open(fg_context *ctx, const fg_engine_training *training,
                                  fg_engine_noise noise, const fg_engine_span *null,
                                  fg_engine_exchange *exchange);
void fg_engine_exchange_close(fg_engine_exchange *exchange);
/* The exchange that leaves least: residual sum after over before, infinity where none changes
 * anything. `y` is the response less the null's start; work has room for 3 n. */
double fg_engine_exchange_best(const fg_engine_exchange *exchange, const double *y,
                               const double *response, double *work, size_t row[2]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The engine's inner parts. Columns are stored one after the other unless said otherwise.
 *
 * A training is the rows that a step learns from, with the columns of the null: the declared
 * model's Jacobian and the effects accepted so far. A bench is a training at every noise model that
 * is considered, with every candidate whitened, projected and orthonormal, so that scoring a vector
 * of responses is one product. */
#ifndef FG_TABLE_LOOP_ENGINE_H
#define FG_TABLE_LOOP_ENGINE_H

#include "foilgauge/loop.h"

enum {
  FG_ENGINE_SMALL_ROWS = 600, /* up to here: all noise models, a drawn null, exact lone rows */
  FG_ENGINE_NOISES = 32,
  FG_ENGINE_BATCH = 8, /* draws that are scored together */
};

/* Of residual sums, with a candidate over without: what an exact fit leaves is rounding. */
#define FG_ENGINE_RATIO_MIN 1e-12

typedef struct fg_engine_noise {
  double rho, lambda;
} fg_engine_noise;

/* Effects accepted so far, the curve among them. */
typedef struct fg_engine_set {
  fg_loop_candidate candidate[FG_LOOP_CLAIMS + 1];
  double shape[FG_LOOP_CLAIMS + 1][FG_LOOP_SHAPES];
  size_t count;
} fg_engine_set;

typedef struct fg_engine_training {
  const fg_loop_problem *problem;
  size_t n, *row;              /* rows of the problem */
  size_t *group, groups;       /* renumbered */
  size_t *start, blocks;       /* series: first row of each, and n at the end */
  size_t *level_start, levels; /* the same of groups that share a level */
  double *y;                   /* n, exchanged runs put back */
  double *scale;               /* n: a row's sd over the rms of all; NULL: one size everywhere */
  bool serial;                 /* neighbours may be correlated */
  size_t columns;
  double *x; /* columns × n */
} fg_engine_training;

/* problem rows where keep[row]; NULL: all. */
fg_status fg_engine_training_build(fg_context *ctx, const fg_loop_problem *problem,
                                   const bool *keep, const fg_engine_set *set,
                                   fg_engine_training *training);
void fg_engine_training_free(fg_engine_training *training);

size_t fg_engine_candidate_columns(const fg_loop_problem *problem,
                                   const fg_loop_candidate *candidate);
bool fg_engine_is_outlier(const fg_loop_candidate *candidate);
bool fg_engine_is_exchange(const fg_loop_candidate *candidate);
bool fg_engine_is_curve(const fg_loop_candidate *candidate);
/* Of the scatter, not of the mean. */
bool fg_engine_is_noise(const fg_loop_candidate *candidate);
bool fg_engine_is_serial(const fg_loop_candidate *candidate);
void fg_engine_candidate_name(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                              char name[FG_LOOP_NAME]);
bool fg_engine_same_candidate(const fg_loop_candidate *a, const fg_loop_candidate *b);
/* The candidate's columns at the rows of a training: columns × n. */
fg_status fg_engine_gather(fg_context *ctx, const fg_engine_training *training,
                           const fg_loop_candidate *candidate, const double *shape,
                           double *columns);

/* The scale of every row by the set's effects of the spread; none: NULL. scale.c */
fg_status fg_engine_estimate_scale(fg_context *ctx, fg_engine_training *training,
                                   const fg_engine_set *set);

/* y := W y. W'W is the inverse of the rows' covariance in units of their mean variance: the rows'
 * scale, series with correlation rho^|i - j|, and lambda more where rows share a group. */
void fg_engine_whiten(const fg_engine_training *training, fg_engine_noise noise, double *y);
/* y := W^-1 y: draws of that covariance from white numbers. */
void fg_engine_colour(const fg_engine_training *training, fg_engine_noise noise, double *y);
double fg_engine_log_det(const fg_engine_training *training,
                         fg_engine_noise noise); /* -2 log |W| */
size_t fg_engine_noise_grid(const fg_engine_training *training,
                            fg_engine_noise grid[FG_ENGINE_NOISES]);

/* Takes `rank` orthonormal columns out of v, twice; returns |v|² left. */
double fg_engine_project_out(size_t n, const double *basis, size_t rank, double *v);
/* Orthonormal columns of the span of `columns` beside `basis`; both stay in place, the new ones are
 * written to `out`. `lengths` (or NULL) receives |v|² left of each before normalising. */
size_t fg_engine_orthonormal(size_t n, const double *basis, size_t rank, const double *columns,
                             size_t count, double *out, double *lengths);

/* What the null's columns span at one noise model. */
typedef struct fg_engine_span {
  size_t n, rank;
  double *basis; /* orthonormal, whitened: rank × n, with room for all columns and `more`; the rest
                    is 0 */
  double *kept;  /* n: share of a whitened row's variance that its residual keeps, 1 - leverage */
} fg_engine_span;
fg_status fg_engine_span_open(fg_context *ctx, const fg_engine_training *training,
                              fg_engine_noise noise, size_t more, fg_engine_span *span);
void fg_engine_span_close(fg_engine_span *span);
/* The sd that a row's residual keeps of its own error, as a divisor. */
double fg_engine_span_kept_sd(const fg_engine_span *span, size_t i);
/* Squared length of y's part in the span of so many orthonormal columns of n values. */
double fg_engine_along(size_t n, const double *unit, size_t count, const double *y);

typedef struct fg_engine_fit {
  size_t columns, rank;
  double *beta;    /* columns; 0 where aliased */
  double *inverse; /* columns × columns: (X'W'WX)^-1, 0 where aliased */
  double rss;      /* whitened */
  double log_det;  /* log |X'W'WX| over the columns kept */
} fg_engine_fit;
fg_status fg_engine_least_squares(fg_context *ctx, const fg_engine_training *training,
                                  fg_engine_noise noise, fg_engine_fit *fit);
/* What a fit leaves of a training's y, not whitened: n numbers. */
void fg_engine_fit_residual(const fg_engine_training *training, const fg_engine_fit *fit,
                            double *residual);
void fg_engine_fit_free(fg_engine_fit *fit);
/* What was measured at row i of a training; exchanged responses are back in their places. */
double fg_engine_response(const fg_engine_training *training, size_t i);

typedef struct fg_engine_version {
  size_t candidate, start, first, rank; /* columns of the bench */
  bool between;                         /* constant in groups: judged between them */
  double share, length;                 /* |MWf|²/|Wf|² and mean |MWf|², at the null's noise */
} fg_engine_version;

/* Who wants to know how far a step is. */
typedef struct fg_engine_watch {
  fg_loop_progress *show; /* NULL: nobody */
  void *user;
  size_t found;
} fg_engine_watch;

typedef struct fg_score_workspace {
  const fg_engine_training *training;
  const fg_loop_candidate *candidate;
  size_t candidates;
  double (*shape)[FG_LOOP_SHAPES]; /* versions */
  fg_engine_version *version;
  size_t versions, columns, rank, dof, widest; /* columns of one version, at most */
  size_t between_rank;                         /* what groups may differ by */
  fg_engine_noise noise[FG_ENGINE_NOISES];
  double weight[FG_ENGINE_NOISES]; /* exp(log terms / freedom): noises compare by rss × weight */
  size_t noises;
  double rss[FG_ENGINE_NOISES];         /* of the training's y without any candidate, whitened */
  double between_rss[FG_ENGINE_NOISES]; /* of that, what groups differ by */
  double *gain;                         /* noises × versions: what each takes away from it */
  fg_engine_span null[FG_ENGINE_NOISES];
  /* n × (rank + columns + between_rank), row by row; only where rows are few */
  float *rows[FG_ENGINE_NOISES];
  fg_engine_watch watch;
} fg_score_workspace;

typedef struct fg_engine_score {
  double ratio; /* residual sum with the candidate / without, each at its best noise */
  double own;   /* the same of what its F ratio is made of: between groups, or all rows */
  double z;     /* a normal deviate of it, or NaN where it cannot be scored */
  size_t version, noise;
} fg_engine_score;

/* The bench's watch is the caller's; all else is made. */
fg_status fg_score_workspace_build(fg_context *ctx, const fg_engine_training *training,
                                   const fg_loop_candidate *candidate, size_t candidates,
                                   fg_score_workspace *workspace);
/* `done` of `all` in one step. */
void fg_score_workspace_tell(const fg_score_workspace *workspace, size_t done, size_t all);
void fg_score_workspace_free(fg_score_workspace *workspace);
/* Scores the training's own y; `null` is the best noise without any candidate. */
void fg_score_workspace_score_data(const fg_score_workspace *workspace, fg_engine_score *score,
                                   size_t *null);
/* Scores `count` vectors of responses (not whitened, one after the other; at most FG_ENGINE_BATCH)
 * where rows are few: candidates × count scores, those of one vector together. */
fg_status fg_score_workspace_score(fg_context *ctx, const fg_score_workspace *workspace,
                                   size_t count, const double *y, fg_engine_score *score);
double fg_engine_deviate(double ratio, double k, double dof);
double fg_engine_deviate_to_f(double z, double k, double nu);
/* Extra freedom of a candidate: rank and shapes. */
double fg_engine_version_dof(const fg_score_workspace *workspace, const fg_engine_version *version);
/* Freedom without the candidate: of the groups, or of the rows. */
double fg_engine_version_whole(const fg_score_workspace *workspace,
                               const fg_engine_version *version);

#endif

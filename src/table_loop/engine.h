/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Internal interface of the engine. Columns are stored one after the other unless stated otherwise.
 *
 * A training set is the rows that a step learns from, with the columns of the null: the declared
 * model's Jacobian and the effects accepted so far. A score workspace is a training set at every
 * noise model that is considered, with every candidate whitened, projected and orthonormal, so that
 * scoring a vector of responses is one product. */
#ifndef FG_TABLE_LOOP_ENGINE_H
#define FG_TABLE_LOOP_ENGINE_H

#include "foilgauge/loop.h"

enum {
  FG_ENGINE_SMALL_ROWS =
      600, /* limit of exact methods: all noise models, a drawn null, exact outliers */
  FG_ENGINE_NOISES = 32,
  FG_ENGINE_BATCH = 48, /* draws scored together */
};

/* Smallest ratio of residual sums, with over without a candidate: an exact fit leaves rounding. */
#define FG_ENGINE_RATIO_MIN 1e-12

/* Of neighbours the correlation; over the variance of a row's own error that of the level of its
 * group, and of the outer level that holds the group. */
typedef struct fg_engine_noise {
  double rho, lambda, outer;
} fg_engine_noise;

/* Returns true when rows do not share errors. */
static inline bool fg_engine_independent(fg_engine_noise noise) {
  return noise.rho == 0 && noise.lambda == 0 && noise.outer == 0;
}

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
  size_t *start, blocks;       /* per series: its first row, and n at the end */
  size_t *level_start, levels; /* per group that shares a level: its first row, and n at the end */
  size_t *level_row;           /* n: rows in the order of random levels; NULL: as they are */
  size_t outer_at;             /* coordinate of the outer levels */
  size_t *outer_block, *outer_start, outers; /* per outer level of the groups: its first place in
                                                outer_block, and `levels` at the end; NULL: none */
  double *y;                                 /* n, with exchanged runs put back */
  double *scale;                             /* n: sd of a row over the rms of all; NULL: equal */
  bool serial;                               /* neighbours in a series may be correlated */
  size_t columns;
  double *x; /* columns × n */
} fg_engine_training;

/* Returns the row at a place of the levels' order. */
static inline size_t fg_engine_level_row(const fg_engine_training *training, size_t place) {
  return training->level_row ? training->level_row[place] : place;
}

/* Groups the rows by the random levels of a set, the outer ones of two nested columns beside
 * (strata.c). */
fg_status fg_engine_group_by_levels(fg_context *ctx, const fg_engine_set *set,
                                    fg_engine_training *training);
/* Returns true when rows of one level of `inner` have one level of `outer`, and outer levels are
 * fewer; SIZE_MAX: the problem's groups. */
bool fg_engine_is_nested(const fg_loop_problem *problem, size_t inner, size_t outer);

/* Returns true for the levels that are the training set's outer ones. */
bool fg_engine_is_outer_levels(const fg_engine_training *training, const fg_loop_candidate *levels);

/* Builds a training set of the problem's rows where keep[row]; NULL: all. */
fg_status fg_engine_training_build(fg_context *ctx, const fg_loop_problem *problem,
                                   const bool *keep, const fg_engine_set *set,
                                   fg_engine_training *training);
void fg_engine_training_free(fg_engine_training *training);

/* Returns the number of a row in the caller's table, from 1. */
size_t fg_engine_row_number(const fg_loop_problem *problem, size_t row);

size_t fg_engine_candidate_columns(const fg_loop_problem *problem,
                                   const fg_loop_candidate *candidate);
bool fg_engine_is_outlier(const fg_loop_candidate *candidate);
bool fg_engine_is_exchange(const fg_loop_candidate *candidate);
bool fg_engine_is_curve(const fg_loop_candidate *candidate);
/* Returns true for a candidate of the scatter, false for one of the mean. */
bool fg_engine_is_noise(const fg_loop_candidate *candidate);
bool fg_engine_is_serial(const fg_loop_candidate *candidate);
bool fg_engine_is_levels(const fg_loop_candidate *candidate);
void fg_engine_candidate_name(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                              char name[FG_LOOP_NAME]);
bool fg_engine_same_candidate(const fg_loop_candidate *a, const fg_loop_candidate *b);
/* Returns true for cycles over one column, whether their base period is known or not. */
bool fg_engine_same_cycle(const fg_loop_candidate *a, const fg_loop_candidate *b);
/* Writes the candidate's columns at the training set's rows: columns × n. */
fg_status fg_engine_gather(fg_context *ctx, const fg_engine_training *training,
                           const fg_loop_candidate *candidate, const double *shape,
                           double *columns);

/* Estimates the scale of every row from the set's effects of the spread; NULL when it has none
 * (scale.c). */
fg_status fg_engine_estimate_scale(fg_context *ctx, fg_engine_training *training,
                                   const fg_engine_set *set);

/* y := W y. W'W is the inverse of the rows' covariance in units of their mean variance. That
 * covariance has the rows' scale, correlation rho^|i - j| in a series, lambda more between rows
 * of a group, and outer more between rows of an outer level. */
void fg_engine_whiten(const fg_engine_training *training, fg_engine_noise noise, double *y);
/* y := W^-1 y: gives white numbers that covariance. */
void fg_engine_colour(const fg_engine_training *training, fg_engine_noise noise, double *y);
/* The levels' part of whitening alone, of numbers that are white in series; and its transpose. */
void fg_engine_whiten_levels(const fg_engine_training *training, fg_engine_noise noise, double *y);
void fg_engine_whiten_levels_back(const fg_engine_training *training, fg_engine_noise noise,
                                  double *y);
/* Makes independent errors of rows, of any sd, a response of the noise: adds a normal level to
 * every group, then colours along series. A heavy tail stays with its row, where colouring spreads
 * it over the group. */
void fg_engine_colour_rows(const fg_engine_training *training, fg_engine_noise noise,
                           uint64_t *seed, double *y);
double fg_engine_log_det(const fg_engine_training *training,
                         fg_engine_noise noise); /* -2 log |W| */
size_t fg_engine_noise_grid(const fg_engine_training *training,
                            fg_engine_noise grid[FG_ENGINE_NOISES]);

/* Projects v, twice, beside `rank` orthonormal columns; returns the remaining |v|². */
double fg_engine_project_out(size_t n, const double *basis, size_t rank, double *v);
/* Finds orthonormal columns of the span of `columns` beside `basis`, written to `out`; both inputs
 * stay. `lengths` (or NULL) gets the remaining |v|² of each before normalising. */
size_t fg_engine_orthonormal(size_t n, const double *basis, size_t rank, const double *columns,
                             size_t count, double *out, double *lengths);

/* Span of the null's columns at one noise model. */
typedef struct fg_engine_span {
  size_t n, rank;
  double *basis; /* orthonormal, whitened: rank × n, with room for all columns and `more`; unused
                    ones are 0 */
  double *kept;  /* n: share of a whitened row's variance that its residual keeps, 1 - leverage */
} fg_engine_span;
fg_status fg_engine_span_open(fg_context *ctx, const fg_engine_training *training,
                              fg_engine_noise noise, size_t more, fg_engine_span *span);
void fg_engine_span_close(fg_engine_span *span);
/* Returns the share of a row's sd that its residual keeps, for use as a divisor; of a share of its
 * variance, or of a row of the span. */
double fg_engine_kept_sd(double share);
double fg_engine_span_kept_sd(const fg_engine_span *span, size_t i);
/* Returns the squared length of y's part in the span of `count` orthonormal columns of n values. */
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
/* Residual of a fit over the training set's y, not whitened: n numbers. */
void fg_engine_fit_residual(const fg_engine_training *training, const fg_engine_fit *fit,
                            double *residual);
void fg_engine_fit_free(fg_engine_fit *fit);
/* Returns the response as measured at row i of a training set; exchanged responses are back in
 * their places. */
double fg_engine_response(const fg_engine_training *training, size_t i);

typedef struct fg_engine_version {
  size_t candidate, start, first, rank; /* columns of the workspace */
  bool between;                         /* constant in groups: tested between them */
  double share, length;                 /* |MWf|²/|Wf|² and mean |MWf|² at the null's noise */
} fg_engine_version;

/* Observer of a step's progress. */
typedef struct fg_engine_watch {
  fg_loop_progress *show; /* NULL: no report */
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
  size_t between_rank;                         /* rank of the differences between groups */
  fg_engine_noise noise[FG_ENGINE_NOISES];
  double weight[FG_ENGINE_NOISES]; /* exp(log terms / dof): noises are compared by rss × weight */
  size_t noises;
  uint32_t near[FG_ENGINE_NOISES]; /* bit k: noise k is the same or next on the grid */
  double rss[FG_ENGINE_NOISES];    /* of the training set's y without any candidate, whitened */
  double between_rss[FG_ENGINE_NOISES]; /* part of `rss` from differences between groups */
  double *gain;                         /* noises × versions: reduction of `rss` by each */
  fg_engine_span null[FG_ENGINE_NOISES];
  /* n × (rank + columns + between_rank), row by row; only where rows are few */
  float *rows[FG_ENGINE_NOISES];
  fg_engine_watch watch;
} fg_score_workspace;

typedef struct fg_engine_score {
  double ratio; /* residual sum with the candidate / without, each at its best noise */
  double own;   /* as `ratio`, of the sum that its F ratio uses: between groups, or all rows */
  double z;     /* its normal deviate, or NaN where it has no score */
  size_t version, noise;
} fg_engine_score;

/* The caller sets the workspace's watch; all other members are built. */
fg_status fg_score_workspace_build(fg_context *ctx, const fg_engine_training *training,
                                   const fg_loop_candidate *candidate, size_t candidates,
                                   fg_score_workspace *workspace);
/* Reports `done` of `all` units of one step. */
void fg_score_workspace_tell(const fg_score_workspace *workspace, size_t done, size_t all);
void fg_score_workspace_free(fg_score_workspace *workspace);
/* Scores the training set's own y; `null` is the best noise without any candidate. */
void fg_score_workspace_score_data(const fg_score_workspace *workspace, fg_engine_score *score,
                                   size_t *null);
/* Scores `count` vectors of responses where rows are few: not whitened, one after the other, at
 * most FG_ENGINE_BATCH. Writes candidates × count scores, those of one vector together. */
fg_status fg_score_workspace_score(fg_context *ctx, const fg_score_workspace *workspace,
                                   size_t count, const double *y, fg_engine_score *score);
double fg_engine_deviate(double ratio, double k, double dof);
double fg_engine_deviate_to_f(double z, double k, double nu);
/* Returns the dof that a candidate adds: rank and shapes. */
double fg_engine_version_dof(const fg_score_workspace *workspace, const fg_engine_version *version);
/* Returns the dof without the candidate: of the groups, or of the rows. */
double fg_engine_version_whole(const fg_score_workspace *workspace,
                               const fg_engine_version *version);

#endif

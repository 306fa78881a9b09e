/* The engine's inner parts. Columns are stored one after the other unless said otherwise.
 *
 * A frame is the training rows of a problem with the columns of the null: the declared model's
 * Jacobian and the effects accepted so far. A bench is a frame at every noise model that is
 * considered, with every candidate whitened, projected and orthonormal, so that scoring a vector
 * of responses is one product. */
#ifndef FG_LOOP_ENGINE_H
#define FG_LOOP_ENGINE_H

#include "foilgauge/loop.h"

enum {
  LOOP_SMALL_ROWS = 600,  /* up to here: all noise models, simulation, all lone rows */
  LOOP_FLIP_GROUPS = 400, /* more groups are flipped together, in order */
  LOOP_NOISES = 32,
};

typedef struct loop_noise {
  double rho, lambda;
} loop_noise;

/* Effects accepted so far, the curve among them. */
typedef struct loop_set {
  fg_loop_candidate candidate[FG_LOOP_CLAIMS + 1];
  double shape[FG_LOOP_CLAIMS + 1][FG_LOOP_SHAPES];
  size_t count;
} loop_set;

typedef struct loop_frame {
  const fg_loop_problem *problem;
  size_t n, *row;              /* rows of the problem */
  size_t *group, groups;       /* renumbered */
  size_t *flip, flips;         /* units of sign flips */
  size_t *start, blocks;       /* series: first row of each, and n at the end */
  size_t *level_start, levels; /* the same of groups that share a level */
  double *y;                   /* n, exchanged runs put back */
  size_t columns;
  double *x; /* columns × n */
} loop_frame;

/* problem rows where keep[row]; NULL: all. */
fg_status loop_frame_build(fg_context *ctx, const fg_loop_problem *problem, const bool *keep,
                           const loop_set *set, loop_frame *frame);
void loop_frame_free(loop_frame *frame);

size_t loop_candidate_columns(const fg_loop_problem *problem, const fg_loop_candidate *candidate);
bool loop_is_lone(const fg_loop_candidate *candidate);
bool loop_is_exchange(const fg_loop_candidate *candidate);
bool loop_is_curve(const fg_loop_candidate *candidate);
void loop_candidate_name(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                         char name[FG_LOOP_NAME]);
bool loop_same_candidate(const fg_loop_candidate *a, const fg_loop_candidate *b);
/* The rows of the two lone effects, and the curves of the unattributed family. */
const fg_loop_effect *loop_lone_effects(void);
const fg_loop_effect *loop_curve_effects(void);
/* The candidate's columns at the rows of a frame: columns × n. */
fg_status loop_gather(fg_context *ctx, const loop_frame *frame, const fg_loop_candidate *candidate,
                      const double *shape, double *columns);

/* y := W y. W'W is the inverse of the rows' covariance in units of their variance: series with
 * correlation rho^|i - j|, and lambda more where rows share a group. */
void loop_whiten(const loop_frame *frame, loop_noise noise, double *y);
/* y := W^-1 y: draws of that covariance from white numbers. */
void loop_colour(const loop_frame *frame, loop_noise noise, double *y);
double loop_log_det(const loop_frame *frame, loop_noise noise); /* -2 log |W| */
size_t loop_noise_grid(const loop_frame *frame, loop_noise grid[LOOP_NOISES]);

/* Takes `rank` orthonormal columns out of v, twice; returns |v|² left. */
double loop_project_out(size_t n, const double *basis, size_t rank, double *v);
/* Orthonormal columns of the span of `columns` beside `basis`; both stay in place, the new ones are
 * written to `out`. `lengths` (or NULL) receives |v|² left of each before normalising. */
size_t loop_orthonormal(size_t n, const double *basis, size_t rank, const double *columns,
                        size_t count, double *out, double *lengths);

/* Orthonormal whitened columns of the null: room for frame->columns × n; returns their number. */
size_t loop_null_basis(const loop_frame *frame, loop_noise noise, double *basis);

typedef struct loop_fit {
  size_t columns, rank;
  double *beta;    /* columns; 0 where aliased */
  double *inverse; /* columns × columns: (X'W'WX)^-1, 0 where aliased */
  double rss;      /* whitened */
  double log_det;  /* log |X'W'WX| over the columns kept */
} loop_fit;
fg_status loop_least_squares(fg_context *ctx, const loop_frame *frame, loop_noise noise,
                             loop_fit *fit);
void loop_fit_free(loop_fit *fit);

typedef struct loop_version {
  size_t candidate, start, first, rank; /* columns of the bench */
  double share, length;                 /* |MWf|²/|Wf|² and mean |MWf|², at the null's noise */
} loop_version;

/* Who wants to know how far a step is. */
typedef struct loop_watch {
  fg_loop_progress *show; /* NULL: nobody */
  void *user;
  size_t found;
} loop_watch;

typedef struct loop_bench {
  const loop_frame *frame;
  const fg_loop_candidate *candidate;
  size_t candidates;
  double (*shape)[FG_LOOP_SHAPES]; /* versions */
  loop_version *version;
  size_t versions, columns, rank, freedom;
  loop_noise noise[LOOP_NOISES];
  double weight[LOOP_NOISES]; /* exp(log terms / freedom): noises compare by rss × weight */
  size_t noises;
  double *rows[LOOP_NOISES]; /* n × (rank + columns), row by row; only for small frames */
  double *flip_scores;       /* flips × (rank + columns), at the flips' noise */
  double flip_rss;           /* |r|² there */
  double *scratch;           /* for one scoring */
  loop_watch watch;
} loop_bench;

typedef struct loop_score {
  double ratio; /* residual sum with the candidate / without, each at its best noise */
  double z;     /* a normal deviate of it, or NaN where it cannot be scored */
  size_t version, noise;
} loop_score;

fg_status loop_bench_build(fg_context *ctx, const loop_frame *frame,
                           const fg_loop_candidate *candidate, size_t candidates,
                           loop_bench *bench);
/* `done` of `all` in one half of the step. */
void loop_bench_tell(const loop_bench *bench, size_t half, size_t done, size_t all);
void loop_bench_free(loop_bench *bench);
/* Scores `y` (not whitened). `null` is the best noise without any candidate. */
void loop_bench_score(const loop_bench *bench, const double *y, loop_score *score, size_t *null);
/* Makes flip_scores at a noise from the frame's y; in large frames also the observed scores. */
fg_status loop_bench_prepare_flips(fg_context *ctx, loop_bench *bench, size_t noise,
                                   loop_score *score);
/* The largest z of each family over the candidates for one draw of signs. */
void loop_bench_flip(const loop_bench *bench, const signed char *sign, double *z);
double loop_deviate(double ratio, double k, double freedom);
double loop_deviate_to_f(double z, double k, double nu);
/* Extra freedom of a candidate: rank and shapes. */
double loop_version_freedom(const loop_bench *bench, const loop_version *version);

#endif

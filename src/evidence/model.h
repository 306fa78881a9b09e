/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models: sets of named effects and of rivals, each a stretch of columns with prior variances, and
 * their marginal likelihood.
 *
 * The scatter of the bumps about their common size is part of every model: bumps of one foil are
 * alike, and a cause that would need bumps that are not is the less likely for it. */
#ifndef FG_EVIDENCE_MODEL_H
#define FG_EVIDENCE_MODEL_H

#include "effect/set.h"
#include "evidence/products.h"
#include "evidence/rivals.h"
#include "evidence/trial.h"

enum { FG_EVIDENCE_PARTS = 6, FG_EVIDENCE_MODEL_COLUMNS = 700 };

/* Numbers of a bump that scatter: its height above O at the crown, its radius at that height, its
 * place along the foil; in the same places, on discs, the harmonics of their forms. The error of
 * known radii comes after them. */
enum {
  FG_EVIDENCE_HEIGHT,
  FG_EVIDENCE_RADIUS,
  FG_EVIDENCE_PLACE,
  FG_EVIDENCE_SCATTERS,
  FG_EVIDENCE_GAUGE = FG_EVIDENCE_SCATTERS,
  FG_EVIDENCE_SPREADS
};

/* A named effect (`effect`) or a rival; none of both: the scatter of the bumps. */
typedef struct fg_evidence_part {
  const fg_effect *effect;
  const fg_rival *rival;
  size_t stretch;                /* of a rival of stretches: its index */
  double shape[FG_FIELD_SHAPES]; /* of the effect */
  size_t first, count;           /* columns */
  double variance[FG_RIVAL_COLUMNS];
  double log_prior;
} fg_evidence_part;

typedef struct fg_evidence_model {
  const fg_evidence_part *part[FG_EVIDENCE_PARTS]; /* of the search's store */
  size_t parts, named;
  double scatter_um[FG_EVIDENCE_SPREADS]; /* of the bumps, or of the discs */
  double evidence, score;                 /* ln; score: with the priors, less that of no effect */
} fg_evidence_model;

/* A model ready for candidates: Cholesky factor of I + A, A = q K q. */
typedef struct fg_evidence_factor {
  size_t count, column[FG_EVIDENCE_MODEL_COLUMNS];
  double root[FG_EVIDENCE_MODEL_COLUMNS]; /* of the prior variances */
  double *lower;                          /* owned; count × count */
  double *solved;                         /* owned; forward solution of the right side */
  double evidence;
} fg_evidence_factor;

/* Columns of the bumps' own numbers: FG_EVIDENCE_SCATTERS of each; then those of known radii, and
 * of the level of all edges, which moves light and dark discs in opposite directions. */
typedef struct fg_evidence_scatter {
  size_t first, count; /* columns; count 0: no bumps */
  size_t gauges;       /* known radii; 0: none, and no level */
  double level_um;     /* standard deviation of the level */
} fg_evidence_scatter;

/* Returns the number of columns that every model holds. */
static inline size_t fg_evidence_common_columns(const fg_evidence_scatter *scatter) {
  return scatter->count + scatter->gauges + (scatter->gauges > 0);
}

/* Factors on the expectations before the rows are seen: on the sizes of amplitudes, and on the
 * probability of each cause. 1 but where a study asks how much hangs on them. */
typedef struct fg_evidence_prior {
  double size, weight;
} fg_evidence_prior;

/* State of a search over models: its problem, the options that a model can hold, and the models. */
enum { FG_EVIDENCE_MODELS = 2400, FG_EVIDENCE_STORE = 2560 };

/* A named effect over its starting shapes, or a rival. */
typedef struct fg_evidence_option {
  const fg_effect *effect;
  const fg_rival *rival;
  size_t stretch, stretches; /* of a rival of stretches: which, of how many */
  bool seeded;               /* of an effect: its one shape is `shape` */
  double shape[FG_FIELD_SHAPES];
  size_t first, sets, each; /* columns */
} fg_evidence_option;

typedef struct fg_evidence_request {
  const fg_effect_set
      *seed; /* sets that are tried as they are: their shapes were fitted together */
  size_t seeds;
  fg_evidence_prior prior;
  unsigned threads; /* 0: one for each core */
} fg_evidence_request;

typedef struct fg_evidence_search {
  fg_evidence_problem problem;
  fg_evidence_request request;
  fg_evidence_scatter scatter;
  fg_evidence_part *store; /* owned; FG_EVIDENCE_STORE */
  size_t stored;
  fg_evidence_model *models; /* owned; FG_EVIDENCE_MODELS; [0]: no effect */
  size_t count;
  fg_evidence_option *options; /* owned */
  size_t option_count;
} fg_evidence_search;

fg_status fg_evidence_factor_open(fg_context *ctx, fg_evidence_problem *problem,
                                  const fg_evidence_scatter *scatter,
                                  const fg_evidence_model *model, fg_evidence_factor *factor);
void fg_evidence_factor_close(fg_evidence_factor *factor);

/* Candidates: `count` sets of `each` consecutive columns. */
typedef struct fg_evidence_sets {
  size_t first, count, each;
} fg_evidence_sets;

/* Sizes of an amplitude's prior: the row's, and from there down by a factor of two each. */
enum { FG_EVIDENCE_SIZES = 7 };

/* Scores candidates beside the factor's model, with prior variances alike for all of them: ln
 * evidence, count × FG_EVIDENCE_SIZES. */
fg_status fg_evidence_score_sets(fg_context *ctx, fg_evidence_problem *problem,
                                 const fg_evidence_factor *factor, const fg_evidence_sets *sets,
                                 const double *variance, double *evidence);

/* Scores shapes that are tried, as sets. */
fg_status fg_evidence_score_trial(fg_context *ctx, const fg_evidence_problem *problem,
                                  const fg_evidence_factor *factor, const fg_evidence_trial *trial,
                                  const double *variance, double *evidence);

/* Finds the products of consecutive columns, projected beside the factor's model: `gram` count ×
 * count, and `right`, those with the residual. */
fg_status fg_evidence_gram_beside(fg_context *ctx, fg_evidence_problem *problem,
                                  const fg_evidence_factor *factor, size_t first, size_t count,
                                  double *gram, double *right);

/* ln evidence of columns with such products under prior variances; `work` count² numbers. */
double fg_evidence_of(size_t count, const double *gram, const double *right, const double *variance,
                      double *work);

#endif

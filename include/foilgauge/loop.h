/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Analysis of the residual of a declared model: effects that it holds, with their significance.
 *
 * One engine serves every level (bumps, runs, points). It knows neither tables nor scans:
 *
 * - a problem is a residual with its Jacobian, the coordinates that effects may act on, the groups
 * drawn independently, and the order along which noise may be correlated;
 * - an effect is a row of a table: an id, its coordinates, basis, and non-linear parameters;
 * - a candidate is an effect on given coordinates of a problem.
 *
 * Method:
 * 1. Noise is independent until a finding shows otherwise: serial correlation (first order,
 * along a series), unequal spread and random levels (which group the rows) are candidates, and are
 * in force once claimed. Where groups share a level, the ratio lambda of its variance to the rows'
 * is estimated anew beside every candidate (residual likelihood: Patterson and Thompson 1971).
 * 2. The score of a candidate of the mean is its reduction of the residual sum, whitened and with
 * every parameter of the declared model projected out. A candidate that is constant in groups
 * sharing a level is scored by the differences between groups. Correlation is scored by the product
 * of neighbours, spread by the likelihood of the residuals' sizes.
 * 3. All candidates share one null: residuals in another order (Freedman and Lane 1983), scored in
 * the same way. Each score is put on the scale of its own draws; the maximum over a kind gives a
 * p-value (Westfall and Young 1993), and kinds share the error rate by fixed weights. No verdict
 * depends on a seed.
 * 4. Outlier rows are tested separately, against the tails of the other rows and against one heavy
 * tail of all rows.
 * 5. An effect that serial correlation may imitate is tested again beside correlation: the effect
 * is claimed, or correlation is, or they tie.
 * 6. Acceptance needs p < 0.01 and a gain above one standard error in grouped cross-validation.
 * 7. The alias class of a winner: every candidate, and every sum of two, beside which the winner
 * gains nothing that the data can show.
 * 8. Refit of all together, swaps, drops; at most six claims.
 * 9. A smooth curve over one coordinate for the part that no candidate explains (unattributed).
 * 10. Errors of held-out rows: the whole search is repeated without each fold of groups. */
#ifndef FOILGAUGE_LOOP_H
#define FOILGAUGE_LOOP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/loop_checked.h"
#include "foilgauge/loop_influence.h"
#include "foilgauge/loop_kind.h"
#include "foilgauge/loop_scale.h"
#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
  FG_LOOP_SHAPES = 2,                   /* maximum number of non-linear parameters of an effect */
  FG_LOOP_COLUMNS = 32,                 /* maximum number of linear columns of an effect */
  FG_LOOP_CLAIMS = 6,                   /* maximum number of effects in one report */
  FG_LOOP_STARTS = 1024,                /* maximum number of start values of an effect's shape */
  FG_LOOP_OUTLIER_ROWS = 8,             /* maximum number of outlier rows in one claim */
  FG_LOOP_ALIASES = 12,                 /* maximum number of reported members of an alias class */
  FG_LOOP_ORDERS = FG_LOOP_COLUMNS / 2, /* maximum number of orders of one cycle */
  FG_LOOP_ORDER_MAX = 64,               /* highest order of a base period */
  FG_LOOP_NAME = 96,
};

/* Roles of a coordinate; effects select coordinates by them. */
typedef enum fg_loop_role {
  FG_LOOP_ORDER = 1,        /* time or sequence in which runs or groups were made */
  FG_LOOP_BUMP = 2,         /* the bump's number from the lip */
  FG_LOOP_DECLARED = 4,     /* used by the declared model */
  FG_LOOP_TEMPERATURE = 8,  /* see kelvin_offset */
  FG_LOOP_DURATION = 16,    /* duration of a treatment */
  FG_LOOP_SENSITIVITY = 32, /* a basis by itself: the response's change by one unit of a part's
                               parameter */
  FG_LOOP_LEVEL = 64,       /* the declared model's prediction of the response */
  FG_LOOP_DIRECTION = 128,  /* two levels: the sense in which places were approached */
} fg_loop_role;

typedef struct fg_loop_coordinate {
  char name[FG_LOOP_NAME];
  double *value;     /* rows; of words the level's index */
  size_t levels;     /* of words: number of levels; of numbers: 0 */
  char **level_name; /* levels */
  size_t distinct;   /* number of different values */
  bool coded; /* of numbers: a column of words codes the same levels, so this one adds none */
  double few[FG_LOOP_COLUMNS + 1];      /* of numbers: the lowest different values, ascending */
  double quantile[FG_LOOP_COLUMNS + 1]; /* of the rows, 0 to 1 in equal steps: knots of curves */
  unsigned roles;
  double kelvin_offset; /* value + kelvin_offset = kelvin */
  double low, high;     /* range over all rows; bases are scaled by it */
  double spacing; /* of neighbouring places that tells a cycle: cycles shorter than twice of it are
                     not sought */
  bool even; /* all places lie on a grid of that spacing: shorter cycles look like longer ones */
  double period; /* base period that is known: declared, or a turn of an angle; 0: none */
  bool declared_period;
  size_t order_max; /* highest order of that base that these places tell */
} fg_loop_coordinate;

struct fg_loop_problem;

/* Computes the declared model's columns at the rows of a grid of settings: parameters × rows. */
typedef fg_status fg_loop_declared(fg_context *ctx, const void *model,
                                   const struct fg_loop_problem *grid, double *columns);

/* The rows of a series are consecutive and in order. The caller owns the problem; the engine only
 * reads it. */
typedef struct fg_loop_problem {
  const char *level; /* "runs", "bumps", "points" */
  size_t rows, parameters;
  double *residual;      /* rows: response minus the declared model at its start */
  double *jacobian;      /* parameters × rows: derivative of the residual by each parameter */
  char **parameter_name; /* parameters */
  size_t *group;         /* rows: 0 .. groups - 1; groups were drawn independently */
  size_t groups;
  bool group_level;  /* rows of a group share a random level */
  size_t *series;    /* rows: along equal values noise may be correlated */
  bool correlated;   /* estimate that correlation */
  bool *held_out;    /* held-out rows, whole groups; NULL: none */
  bool exchangeable; /* rows are single responses: one may be an outlier, two may be exchanged */
  bool few; /* too few groups for curves or tests of the scatter: listed effects of the mean only;
               the caller tests the claims by other means */
  double *response;        /* rows, for exchanged runs: the measured response */
  const size_t *table_row; /* rows: of the caller's table, from 0, for names; NULL: the same */
  double origin; /* subtracted from every residual; the constant of the declared model, of value 1,
                    is larger by it */
  size_t constant; /* parameter; only where the origin is not 0 */
  fg_loop_coordinate *coordinate;
  size_t coordinates;
  void *self;                 /* context of a level's own effects */
  fg_loop_declared *declared; /* NULL: the declared model is known at the rows only */
  const void *declared_model;
} fg_loop_problem;

struct fg_loop_effect;

typedef struct fg_loop_candidate {
  const struct fg_loop_effect *effect;
  size_t a, b; /* coordinates; b = a for an effect of one */
  size_t rows; /* of outlier or exchanged responses */
  size_t row[FG_LOOP_OUTLIER_ROWS];
  uint64_t orders; /* of a cycle: bit k - 1 for order k of the base period that is its shape; 0: the
                      first alone */
} fg_loop_candidate;

typedef bool fg_loop_accepts(const fg_loop_problem *problem, size_t a, size_t b);
typedef size_t fg_loop_columns(const fg_loop_problem *problem, const fg_loop_candidate *candidate);
/* Computes columns × rows, scaled so that one column's half range is about 1: its coefficient is
 * then the amplitude in the response's unit. */
typedef void fg_loop_basis(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                           const double *shape, double *columns);
/* Writes start values; returns their number (1 for effects without shape). */
typedef size_t fg_loop_starts(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                              double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]);

/* Effects of single rows. */
typedef enum fg_loop_outlier {
  FG_LOOP_NOT_OUTLIER,
  FG_LOOP_WRONG_ROW,      /* one response is an outlier */
  FG_LOOP_EXCHANGED_ROWS, /* two responses are exchanged */
} fg_loop_outlier;

/* Effects of the scatter about the mean. */
typedef enum fg_loop_scatter {
  FG_LOOP_OF_THE_MEAN,
  FG_LOOP_SERIAL, /* neighbours along the order are correlated */
  FG_LOOP_SPREAD, /* the sd varies; the basis is of its logarithm */
  FG_LOOP_LEVELS, /* rows of a level of the column share a random part */
} fg_loop_scatter;

/* Effects over the bumps of foils that the loop on scans searches, in this order. */
typedef enum fg_loop_over_bumps {
  FG_LOOP_NOT_OVER_BUMPS,
  FG_LOOP_BUMP_DECAY,   /* from the lip */
  FG_LOOP_BUMP_STRETCH, /* of the arc length: only the angles show it */
  FG_LOOP_BUMP_TREND,   /* over their number */
  FG_LOOP_BUMP_KINDS
} fg_loop_over_bumps;

/* Difference that a claim's sentence states, by the kind of its effect. */
typedef enum fg_loop_reads {
  FG_LOOP_READS_RANGE,    /* over the rows */
  FG_LOOP_READS_SLOPE,    /* between the ends of the range */
  FG_LOOP_READS_BEND,     /* between the turn and the farther end */
  FG_LOOP_READS_LEVELS,   /* between the highest level and the lowest */
  FG_LOOP_READS_STEP,     /* between both sides */
  FG_LOOP_READS_FADE,     /* between the first row and the last */
  FG_LOOP_READS_SWING,    /* between peak and valley */
  FG_LOOP_READS_SLOPES,   /* between slopes over one column, at both ends of the other */
  FG_LOOP_READS_LOOP,     /* between two directions, in the middle of the range and at its ends */
  FG_LOOP_READS_ROWS,     /* between a row and its prediction by the others */
  FG_LOOP_READS_EXCHANGE, /* between two rows */
  FG_LOOP_READINGS
} fg_loop_reads;

typedef struct fg_loop_effect {
  const char *id, *level, *frame;
  const char *words; /* "a trend with" */
  bool pair;         /* needs two coordinates */
  size_t shapes;
  const char *shape_name[FG_LOOP_SHAPES];
  fg_loop_accepts *accepts;
  fg_loop_columns *columns;
  fg_loop_basis *basis;
  fg_loop_starts *starts;
  /* the shape is a place between rows: small steps cannot refine it */
  bool stepwise;
  bool cycle;        /* the shape is a period, the columns are sine and cosine of its orders */
  bool held;         /* the shape is known: an order of the coordinate's base period */
  bool from_zero;    /* the amplitude is the largest size, not half the range */
  bool own_levels;   /* every measured value has a level of its own: values between are unknown */
  bool slope;        /* its coefficient is half the change over its coordinate's range */
  bool unattributed; /* a curve of the part that no listed effect explains */
  fg_loop_outlier outlier;
  fg_loop_scatter scatter;
  fg_loop_over_bumps over_bumps;
  const char *bump_words; /* "a decay from the lip" */
  fg_loop_reads reads;    /* difference stated in sentences */
  const char
      *sought;      /* "trends", in the list of effects sought without success; NULL: not listed */
  const char *term; /* term of a formula, {a} and {b} for its columns, beside their main terms;
                       NULL: no formula has it */
} fg_loop_effect;

/* P-values over everything that was tried, up to which an effect is accepted, or suspected. */
#define FG_LOOP_ACCEPT_P    0.01
#define FG_LOOP_SUSPECTED_P 0.1

/* Reports progress: share of the present step, 0 to 1, and number of effects found before it. */
typedef void fg_loop_progress(void *user, size_t found, double share);

typedef struct fg_loop_options {
  const fg_loop_effect *effects; /* a table that ends with id NULL */
  uint64_t seed;
  double accept_p;    /* 0: FG_LOOP_ACCEPT_P */
  size_t simulations; /* 0: 999 */
  double matters; /* smallest amplitude of practical interest, in the response's unit; 0: one noise
                     sd */
  double minutes,
      mebibytes; /* limits of the search by estimate, beyond which it is FG_ERR_DATA; 0: no limit */
  bool expected[FG_LOOP_KINDS]; /* kinds that get a larger share of the error rate */
  bool search_once;           /* cross-fitted errors are the cross-validated: no search per fold */
  fg_loop_progress *progress; /* NULL: no progress report */
  void *progress_user;
} fg_loop_options;

typedef enum fg_loop_verdict {
  FG_LOOP_FOUND,
  FG_LOOP_TIED,
  FG_LOOP_ABSENT,
  FG_LOOP_INCONCLUSIVE,
  FG_LOOP_ABSORBED,
  FG_LOOP_EXPLAINED_BY_OTHERS, /* significant, but a member of a claim's alias class */
} fg_loop_verdict;

typedef struct fg_loop_alias {
  char name[2 * FG_LOOP_NAME]; /* of the candidate, or of a sum of two */
  double correlation;          /* between its best fit and the winner's, both beside the model */
  double loss;                 /* share of the winner's explained sum that it does not explain */
  fg_loop_candidate candidate, second;
  bool sum;
} fg_loop_alias;

/* Order of a cycle: amplitude cos(2 pi order x / base - phase), x of the column. */
typedef struct fg_loop_order_fit {
  size_t order;
  double amplitude, amplitude_u;
  double phase_deg, phase_u_deg;
  double peak_at, peak_at_u; /* place of the peak nearest to the middle of the range */
} fg_loop_order_fit;

typedef struct fg_loop_claim {
  fg_loop_candidate candidate;
  char name[FG_LOOP_NAME]; /* "table.linear(humidity_pct)" */
  fg_loop_verdict verdict;
  size_t columns;
  double shape[FG_LOOP_SHAPES], shape_u[FG_LOOP_SHAPES];
  double coefficient[FG_LOOP_COLUMNS], coefficient_u[FG_LOOP_COLUMNS];
  double slopes_u; /* of the difference between the largest and the smallest slope of levels */
  fg_loop_order_fit order[FG_LOOP_ORDERS];
  size_t orders;      /* of a cycle */
  double amplitude;   /* half the range of the effect over the rows, response's unit */
  double amplitude_u; /* standard uncertainty */
  double interval[2]; /* 95 % */
  double p_value;     /* max-T */
  double noise_value, noise_value_u; /* of the scatter: correlation of neighbours; ratio of the
                                        largest to the smallest sd of a row */
  double retained_share;             /* |M W f|² / |W f|² */
  double cv_gain, cv_gain_se;        /* NaN for outlier rows */
  int held_out;                      /* +1 confirmed, 0 not contradicted, -1 no rows held out */
  fg_loop_alias alias[FG_LOOP_ALIASES];
  size_t aliases, aliases_unlisted;
} fg_loop_claim;

typedef struct fg_loop_rejected {
  fg_loop_candidate candidate;
  char name[FG_LOOP_NAME];
  fg_loop_verdict verdict;
  double would_explain; /* share of the residual sum that it explains alone */
  double p_value;       /* max-T, last step */
  double retained_share;
  double smallest_detectable; /* amplitude found with a power of 80 %; NaN where none is */
} fg_loop_rejected;

typedef struct fg_loop_curve {
  size_t coordinate; /* of the problem */
  char name[FG_LOOP_NAME];
  size_t count;
  double (*shape)[2]; /* coordinate, value: piecewise linear between them */
  double rms, p_value;
  size_t nearest[8]; /* rows with the largest values */
  size_t nearest_count;
  double dof; /* effective, of the penalised spline */
} fg_loop_curve;

/* Errors over a set of rows. */
typedef struct fg_loop_error {
  double rms, robust_sd, p95, maximum;
  double held_out_rms; /* held-out rows; without any, cross-fitted: every fold of groups in turn,
                          with the search repeated */
  double cross_validated_rms; /* whole groups left out in turn */
} fg_loop_error;

typedef struct fg_loop_noise {
  double sd;          /* of one row, group level included */
  double rho, lambda; /* correlation along a series; level's variance over the rows' */
} fg_loop_noise;

typedef struct fg_loop_advice {
  char text[1200];
  double runs; /* number at either setting that a power of 80 % needs; NaN: no number suffices */
} fg_loop_advice;

typedef enum fg_loop_outcome {
  FG_LOOP_CLEAN,
  FG_LOOP_EXPLAINED,
  FG_LOOP_PARTLY,
  FG_LOOP_UNATTRIBUTED,
  FG_LOOP_SUSPECTED, /* of tables: nothing is proven, and noise alone would hardly look so */
} fg_loop_outcome;

/* An effect that is suspected, not proven. */
typedef struct fg_loop_suspect {
  fg_loop_claim claim;       /* as a claim would state it; first: the whole of subjects */
  double own_p;              /* p-value had nothing else been tried */
  size_t more_rows;          /* to add, that decide with a power of 90 %; 0: no number would */
  bool repeats;              /* they repeat the suspect's own rows */
  char at[4 * FG_LOOP_NAME]; /* their settings in words; empty: as these rows */
} fg_loop_suspect;

enum { FG_LOOP_SUSPECTS = 5 };

typedef struct fg_loop_result {
  fg_loop_outcome verdict;
  fg_loop_noise noise;
  double noise_floor;
  double family_p; /* smallest p-value of the first step's whole family: uniform under the null */
  double share[FG_LOOP_KINDS]; /* of each kind in the error rate */
  fg_loop_error before, after;
  double ratio_rms, ratio_held_out, ratio_interval[2]; /* after / before; 95 % block bootstrap */
  fg_loop_claim claim[FG_LOOP_CLAIMS];
  size_t claims;
  bool has_curve;
  fg_loop_curve curve;
  fg_loop_candidate far_row; /* beyond normal noise, not claimed; `rows` 0: none */
  fg_loop_checked check[FG_LOOP_CHECKS];
  bool fails; /* one of the tests fails, beside all effects found */
  fg_loop_check failed;
  size_t *setting; /* rows: index of the settings, from 1, for the failed test of settings (0: held
                      out); or NULL */
  fg_loop_suspect suspect[FG_LOOP_SUSPECTS]; /* the clearest first */
  size_t suspects;
  double *suspect_fit; /* rows: residual beside the first suspect */
  fg_loop_rejected *rejected;
  size_t rejects;
  fg_loop_advice advice[FG_LOOP_CLAIMS];
  size_t advices;
  double *parameter, *parameter_u; /* of the declared model, refitted with everything */
  fg_loop_influence influence[FG_LOOP_INFLUENCES]; /* largest Cook's distance first */
  size_t influences;
  fg_loop_response_scale scale;
  double *before_fit, *after_fit; /* rows: residual before and after */
  double *effect_fit; /* rows: contribution of the effects found, in the response's unit */
  char **note;
  size_t notes, note_capacity;
} fg_loop_result;

/* Runs the engine. FG_ERR_DATA when there are fewer than three rows beyond the parameters. A
 * residual that is zero or constant within rounding is no error but a result (`clean` with a note).
 * Free with fg_loop_result_free. */
fg_status fg_loop_run(fg_context *ctx, const fg_loop_problem *problem,
                      const fg_loop_options *options, fg_loop_result *result);
void fg_loop_result_free(fg_loop_result *result);

/* Returns true for order k of a cycle's base period. */
static inline bool fg_loop_has_order(const fg_loop_candidate *cycle, size_t k) {
  return cycle->orders ? cycle->orders >> (k - 1) & 1 : k == 1;
}

/* Returns true for a spread with an sd of its own for every level, false for a slope. */
bool fg_loop_spread_by_levels(const fg_loop_problem *problem, const fg_loop_candidate *candidate);

/* Words by verdict and outcome; NULL behind the last. */
extern const char *const fg_loop_verdict_words[], *const fg_loop_outcome_words[];
const char *fg_loop_verdict_word(fg_loop_verdict verdict);
const char *fg_loop_outcome_word(fg_loop_outcome outcome);

/* Evaluates a claim's effect at the rows of a problem (rows numbers). */
fg_status fg_loop_claim_evaluate(fg_context *ctx, const fg_loop_problem *problem,
                                 const fg_loop_claim *claim, double *effect);
/* Evaluates a claim on one coordinate, at values of that coordinate. */
fg_status fg_loop_claim_curve(fg_context *ctx, const fg_loop_problem *problem,
                              const fg_loop_claim *claim, const double *value, size_t count,
                              double *effect);
/* "a drift over the runs"; for single rows without their numbers. */
void fg_loop_effect_words(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                          char *text, size_t size);
/* Returns the curve at a value of its coordinate; constant beyond its ends. */
double fg_loop_curve_at(const fg_loop_curve *curve, double value);

#ifdef __cplusplus
}
#endif
#endif

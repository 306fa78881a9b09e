/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Closing the loop: what the residual of a declared model holds, and what that is worth.
 *
 * One engine for every level (bumps, runs, points). It knows no tables and no scans:
 *
 *   a problem   is a residual with its Jacobian, the coordinates an effect may live on, the groups
 *               that were drawn independently, and the order along which noise may be correlated;
 *   an effect   is a row of a table: an id, the coordinates it needs, its basis, its non-linear
 *               parameters with their start values; a new effect is a new row;
 *   a candidate is an effect on given coordinates of a problem.
 *
 * Method:
 *
 *   1  Noise is independent until a finding says otherwise: serial correlation (first order, along
 * a series) and unequal spread are candidates like effects of the mean, and are in force from their
 * claim on. Where groups share a level, the ratio lambda of its variance to the rows' is estimated
 * anew beside every candidate (residual likelihood: Patterson and Thompson 1971). 2  A candidate of
 * the mean is scored by the residual sum that it takes away, whitened and with every parameter of
 * the declared model projected out, what is constant in groups that share a level by what groups
 * differ by; correlation by the product of neighbours, spread by the
 * likelihood of the residuals' sizes. 3  One null for all: residuals in another order (Freedman and
 * Lane 1983), scored in the same way; each score on the scale of its own draws, p-values from the
 * largest of all (Westfall and Young 1993). The draws are the same in every run: no verdict depends
 * on a seed. 4  Wrong rows are judged apart, against the tails that the other rows show, and
 * against one heavy tail of all. 5  An effect that a series could be mistaken for is searched again
 * beside correlation: it is claimed, or correlation is, or they tie. 6  Accepted at p < 0.01, with
 * a gain above one standard error in grouped cross-validation. 7  Its alias class: every candidate
 * beside which the winner explains nothing more that the data can show, and every sum of two such.
 * 8  Refit of all together, swaps, drops; at most six claims. 9  What no candidate explains: a
 * smooth curve over one coordinate (unattributed). 10  Errors of rows that took no part: the whole
 * search again without each fold of groups.
 */
#ifndef FOILGAUGE_LOOP_H
#define FOILGAUGE_LOOP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "foilgauge/design.h"
#include "foilgauge/status.h"
#include "foilgauge/table.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
  FG_LOOP_SHAPES = 2,       /* non-linear parameters of an effect, at most */
  FG_LOOP_COLUMNS = 32,     /* linear columns of an effect, at most */
  FG_LOOP_CLAIMS = 6,       /* effects in one report, at most */
  FG_LOOP_STARTS = 1024,    /* start values of an effect's shape, at most */
  FG_LOOP_OUTLIER_ROWS = 8, /* wrong rows in one claim, at most */
  FG_LOOP_ALIASES = 12,     /* members of an alias class that are reported, at most */
  FG_LOOP_NAME = 96,
};

/* What a coordinate is; effects ask for these. */
typedef enum fg_loop_role {
  FG_LOOP_ORDER = 1,        /* when a run or group was made */
  FG_LOOP_BUMP = 2,         /* the bump's number from the lip */
  FG_LOOP_DECLARED = 4,     /* the declared model uses it */
  FG_LOOP_TEMPERATURE = 8,  /* see kelvin_offset */
  FG_LOOP_DURATION = 16,    /* a time of treatment */
  FG_LOOP_SENSITIVITY = 32, /* a basis by itself: the response's change by one unit of a part's
                               parameter */
  FG_LOOP_LEVEL = 64,       /* what the declared model says of the response itself */
} fg_loop_role;

typedef struct fg_loop_coordinate {
  char name[FG_LOOP_NAME];
  double *value;     /* rows; the level's index for words */
  size_t levels;     /* words: how many; numbers: 0 */
  char **level_name; /* levels */
  size_t distinct;   /* different values */
  bool coded;        /* numbers: words of another column say the same; levels are left to it */
  double few[FG_LOOP_COLUMNS + 1];      /* numbers: the lowest of them, ascending */
  double quantile[FG_LOOP_COLUMNS + 1]; /* of the rows, 0 to 1 in equal steps: knots of curves */
  unsigned roles;
  double kelvin_offset; /* value + kelvin_offset = kelvin */
  double low, high;     /* of all rows; a basis is scaled by them */
} fg_loop_coordinate;

struct fg_loop_problem;

/* The declared model's columns at the rows of a grid of settings: parameters × rows. */
typedef fg_status fg_loop_declared(fg_context *ctx, const void *model,
                                   const struct fg_loop_problem *grid, double *columns);

/* The rows of a series are consecutive and in order. The problem belongs to whoever built it; the
 * engine reads it only. */
typedef struct fg_loop_problem {
  const char *level; /* "runs", "bumps", "points" */
  size_t rows, parameters;
  double *residual;      /* rows: response minus the declared model at its start */
  double *jacobian;      /* parameters × rows: its change by each parameter */
  char **parameter_name; /* parameters */
  size_t *group;         /* rows: 0 .. groups - 1, what was drawn independently */
  size_t groups;
  bool group_level;  /* rows of a group share a random level */
  size_t *series;    /* rows: along equal values noise may be correlated */
  bool correlated;   /* estimate that correlation */
  bool *held_out;    /* rows kept aside, whole groups; NULL: none */
  bool exchangeable; /* rows are single responses: one may be wrong, two may be exchanged */
  bool few; /* too few groups for curves or the scatter to tell: listed effects of the mean only;
               whoever built the problem tests the claims by other means */
  double *response; /* rows, for exchanged runs: the measured response */
  double origin;    /* taken from every residual; the constant of the declared model, of value 1, is
                       so much larger */
  size_t constant;  /* parameter; only where the origin is not 0 */
  fg_loop_coordinate *coordinate;
  size_t coordinates;
  void *self;                 /* for the effects of a level */
  fg_loop_declared *declared; /* NULL: the declared model is known at the rows only */
  const void *declared_model;
} fg_loop_problem;

struct fg_loop_effect;

typedef struct fg_loop_candidate {
  const struct fg_loop_effect *effect;
  size_t a, b; /* coordinates; b = a where there is one */
  size_t rows; /* of wrong or exchanged responses */
  size_t row[FG_LOOP_OUTLIER_ROWS];
} fg_loop_candidate;

typedef bool fg_loop_accepts(const fg_loop_problem *problem, size_t a, size_t b);
typedef size_t fg_loop_columns(const fg_loop_problem *problem, const fg_loop_candidate *candidate);
/* columns × rows, scaled so that one column's half range is about 1: its coefficient is then the
 * amplitude in the response's unit. */
typedef void fg_loop_basis(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                           const double *shape, double *columns);
/* Start values; returns how many (1 for effects without shape). */
typedef size_t fg_loop_starts(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                              double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]);

/* What concerns single rows. */
typedef enum fg_loop_outlier {
  FG_LOOP_NOT_OUTLIER,
  FG_LOOP_WRONG_ROW,      /* one response is wrong */
  FG_LOOP_EXCHANGED_ROWS, /* two changed places */
} fg_loop_outlier;

/* What concerns the scatter about the mean. */
typedef enum fg_loop_scatter {
  FG_LOOP_OF_THE_MEAN,
  FG_LOOP_SERIAL, /* neighbours along the order are alike */
  FG_LOOP_SPREAD, /* its size changes; the basis is of the logarithm of the standard deviation */
} fg_loop_scatter;

/* What the loop on scans looks for over the bumps of its foils, in this order. */
typedef enum fg_loop_over_bumps {
  FG_LOOP_NOT_OVER_BUMPS,
  FG_LOOP_BUMP_DECAY,   /* from the lip */
  FG_LOOP_BUMP_STRETCH, /* of the arc length: it shows in the angles alone */
  FG_LOOP_BUMP_TREND,   /* over their number */
  FG_LOOP_BUMP_KINDS
} fg_loop_over_bumps;

/* Difference that a claim states, by the kind of its effect. */
typedef enum fg_loop_reads {
  FG_LOOP_READS_RANGE,    /* over the rows */
  FG_LOOP_READS_SLOPE,    /* between the ends */
  FG_LOOP_READS_BEND,     /* between the turn and the farther end */
  FG_LOOP_READS_LEVELS,   /* between the highest level and the lowest */
  FG_LOOP_READS_STEP,     /* between both sides */
  FG_LOOP_READS_FADE,     /* between the first row and the last */
  FG_LOOP_READS_SWING,    /* between peak and valley */
  FG_LOOP_READS_SLOPES,   /* between slopes over one column, at both ends of the other */
  FG_LOOP_READS_ROWS,     /* between a row and its prediction by the others */
  FG_LOOP_READS_EXCHANGE, /* between two rows */
  FG_LOOP_READINGS
} fg_loop_reads;

typedef struct fg_loop_effect {
  const char *id, *level, *frame;
  const char *words; /* "a trend with" */
  bool pair;         /* of coordinates */
  size_t shapes;
  const char *shape_name[FG_LOOP_SHAPES];
  fg_loop_accepts *accepts;
  fg_loop_columns *columns;
  fg_loop_basis *basis;
  fg_loop_starts *starts;
  /* The shape is a place between rows: it cannot be refined by small steps. */
  bool stepwise;
  bool cycle;      /* its shape is a period, its columns are sine and cosine */
  bool from_zero;  /* the amplitude is the largest size, not half the range */
  bool own_levels; /* each value that was measured has a level of its own: nothing is known between
                    */
  bool slope;      /* its coefficient is half the change over its coordinate's range */
  bool unattributed; /* a curve of what no listed effect explains */
  fg_loop_outlier outlier;
  fg_loop_scatter scatter;
  fg_loop_over_bumps over_bumps;
  const char *bump_words; /* "a decay from the lip" */
  fg_loop_reads reads;    /* in words for people */
  const char *sought;     /* "trends", for what was looked for in vain; NULL: not told */
  const char *term; /* of a formula, {a} and {b} for its columns, beside them; NULL: none has it */
} fg_loop_effect;

/* An effect is accepted below this probability of noise alone, over everything that was tried. */
#define FG_LOOP_ACCEPT_P 0.01

/* How far a step of the search is, 0 to 1, and how many effects the steps before it found. */
typedef void fg_loop_progress(void *user, size_t found, double share);

typedef struct fg_loop_options {
  const fg_loop_effect *effects; /* a table that ends with id NULL */
  uint64_t seed;
  double accept_p;    /* 0: FG_LOOP_ACCEPT_P */
  size_t simulations; /* 0: 999 */
  double matters;     /* amplitude that matters, in the response's unit; 0: one noise sd */
  double minutes,
      mebibytes; /* what the search may take by estimate, else FG_ERR_DATA; 0: no limit */
  fg_loop_progress *progress; /* NULL: not told */
  void *progress_user;
} fg_loop_options;

typedef enum fg_loop_verdict {
  FG_LOOP_FOUND,
  FG_LOOP_TIED,
  FG_LOOP_ABSENT,
  FG_LOOP_INCONCLUSIVE,
  FG_LOOP_ABSORBED,
  FG_LOOP_EXPLAINED_BY_OTHERS, /* passed, but a member of a claim's alias class */
} fg_loop_verdict;

typedef struct fg_loop_alias {
  char name[2 * FG_LOOP_NAME]; /* of the candidate, or of a sum of two */
  double correlation;          /* of its best fit with the winner's, both beside the model */
  double loss;                 /* share of the winner's explained sum that it misses */
  fg_loop_candidate candidate, second;
  bool sum;
} fg_loop_alias;

typedef struct fg_loop_claim {
  fg_loop_candidate candidate;
  char name[FG_LOOP_NAME]; /* "table.linear(humidity_pct)" */
  fg_loop_verdict verdict;
  size_t columns;
  double shape[FG_LOOP_SHAPES], shape_u[FG_LOOP_SHAPES];
  double coefficient[FG_LOOP_COLUMNS], coefficient_u[FG_LOOP_COLUMNS];
  double amplitude;   /* half the range of the effect over the rows, response's unit */
  double amplitude_u; /* standard uncertainty */
  double interval[2]; /* 95 % */
  double p_value;     /* max-T */
  double noise_value, noise_value_u; /* of the scatter: correlation of neighbours; largest over
                                        smallest sd of a row */
  double retained_share;             /* |M W f|² / |W f|² */
  double cv_gain, cv_gain_se;        /* NaN for lone rows */
  int held_out;                      /* +1 confirmed, 0 not contradicted, -1 none kept aside */
  fg_loop_alias alias[FG_LOOP_ALIASES];
  size_t aliases, aliases_unlisted;
} fg_loop_claim;

typedef struct fg_loop_rejected {
  fg_loop_candidate candidate;
  char name[FG_LOOP_NAME];
  fg_loop_verdict verdict;
  double would_explain; /* share of the residual sum that it would take away */
  double p_value;       /* max-T, last step */
  double retained_share;
  double smallest_detectable; /* amplitude found with a power of 80 %; NaN where nothing would */
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
  double held_out_rms; /* rows kept aside; without, every fold of groups in turn, searched anew */
  double cross_validated_rms; /* whole groups left out in turn */
} fg_loop_error;

typedef struct fg_loop_noise {
  double sd;          /* of one row, group level included */
  double rho, lambda; /* correlation along a series; level's variance over the rows' */
} fg_loop_noise;

typedef struct fg_loop_advice {
  char text[1200];
  double runs; /* at either setting, needed for a power of 80 %; NaN: no number helps */
} fg_loop_advice;

/* Tests of the whole residual, beside everything that is looked for by name: `clean` needs that it
 * passes them. */
typedef enum fg_loop_check {
  FG_LOOP_CHECK_REPEATS,  /* rows of the same declared settings, more alike than the model fits
                             their means: lack of fit */
  FG_LOOP_CHECK_SETTINGS, /* the same of rows that agree in every recorded column */
  FG_LOOP_CHECK_LAGS,     /* rows 2 to `lag` apart, all together */
  FG_LOOP_CHECK_ONE_LAG,  /* rows `lag` apart, the most alike or unlike */
  FG_LOOP_CHECKS
} fg_loop_check;

typedef struct fg_loop_checked {
  bool done, failed; /* not done: nothing repeats, or rows have no order or are too few */
  double statistic;  /* F ratio; sum of squares of normal deviates; the largest of them */
  double dof[2];     /* of an F ratio; of a sum, the first */
  double p_value, level;
  size_t lag;
  double correlation; /* at one lag */
  double rms;         /* of what it shows, in the response's unit */
  size_t worst[3];    /* rows of the settings that are missed most, one of each */
  size_t worst_count;
} fg_loop_checked;

typedef enum fg_loop_outcome {
  FG_LOOP_CLEAN,
  FG_LOOP_EXPLAINED,
  FG_LOOP_PARTLY,
  FG_LOOP_UNATTRIBUTED,
} fg_loop_outcome;

typedef struct fg_loop_result {
  fg_loop_outcome verdict;
  fg_loop_noise noise;
  double noise_floor;
  double family_p; /* smallest p-value of all that was looked for first: uniform where nothing is */
  fg_loop_error before, after;
  double ratio_rms, ratio_held_out, ratio_interval[2]; /* after / before; 95 % block bootstrap */
  fg_loop_claim claim[FG_LOOP_CLAIMS];
  size_t claims;
  bool has_curve;
  fg_loop_curve curve;
  fg_loop_checked check[FG_LOOP_CHECKS];
  bool fails; /* one of them, beside all that was found; the clearest is */
  fg_loop_check failed;
  size_t *setting; /* rows: which settings, from 1, where those failed (0: kept aside); or NULL */
  fg_loop_rejected *rejected;
  size_t rejects;
  fg_loop_advice advice[FG_LOOP_CLAIMS];
  size_t advices;
  double *parameter, *parameter_u; /* of the declared model, refitted with everything */
  double *before_fit, *after_fit;  /* rows: residual before and after */
  double *effect_fit;              /* rows: what was found, in the response's unit */
  char **note;
  size_t notes, note_capacity;
} fg_loop_result;

/* Runs the engine. FG_ERR_DATA when nothing can be judged at all: fewer than three rows beyond the
 * parameters, a residual that is zero or constant within rounding is not an error but a result
 * (`clean` with a note). Free with fg_loop_result_free. */
fg_status fg_loop_run(fg_context *ctx, const fg_loop_problem *problem,
                      const fg_loop_options *options, fg_loop_result *result);
void fg_loop_result_free(fg_loop_result *result);

/* A spread with a size of its own for every level, rather than a slope. */
bool fg_loop_spread_by_levels(const fg_loop_problem *problem, const fg_loop_candidate *candidate);

const char *fg_loop_verdict_word(fg_loop_verdict verdict);
const char *fg_loop_outcome_word(fg_loop_outcome outcome);

/* The effect of a claim at the rows of a problem (rows numbers). */
fg_status fg_loop_claim_evaluate(fg_context *ctx, const fg_loop_problem *problem,
                                 const fg_loop_claim *claim, double *effect);
/* The same of a claim on one coordinate, at values of that. */
fg_status fg_loop_claim_curve(fg_context *ctx, const fg_loop_problem *problem,
                              const fg_loop_claim *claim, const double *value, size_t count,
                              double *effect);
/* "a drift over the runs"; of single rows without their numbers. */
void fg_loop_effect_words(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                          char *text, size_t size);
/* The curve at a value of its coordinate; constant beyond its ends. */
double fg_loop_curve_at(const fg_loop_curve *curve, double value);

/* ---- tables: levels `runs` and `bumps` ---- */

/* The effects of tables, parts over bumps, and heat treatment. */
const fg_loop_effect *fg_loop_table_effects(void);

typedef struct fg_loop_table_spec {
  const char *response; /* column */
  const char *model;    /* a formula, or "arc_length" */
  const char *group;    /* column, or NULL */
  const char *offset; /* column: what is predicted of the response besides the model, and taken from
                         it (a beam model of forming, say); or NULL */
  const char *order;  /* column, or NULL: `bump` in groups, `run` or the like, else the rows */
  const char *hold_out;    /* "0.2", "COLUMN=VALUE"; "0" or NULL: every row takes part */
  const fg_design *design; /* arc_length only */
  uint64_t seed;
} fg_loop_table_spec;

/* A declared model in a file: {"response", "model", "group", "order", "design": {...}}. Members
 * that `spec` has already stay; its other members point into `declaration`, which lives as long as
 * they are used. FG_ERR_DATA names the file and the member, or line and column where the JSON stops
 * being valid. */
typedef struct fg_loop_declaration fg_loop_declaration;
fg_status fg_loop_declaration_load(fg_context *ctx, const char *path, fg_loop_table_spec *spec,
                                   fg_design *design, fg_loop_declaration **declaration);
bool fg_loop_declaration_has_design(const fg_loop_declaration *declaration); /* NULL: no */
void fg_loop_declaration_free(fg_loop_declaration *declaration);

/* A problem built from a table; owns everything in it. `row` maps its rows to the table's. */
typedef struct fg_loop_table_problem {
  fg_loop_problem problem;
  size_t *row;
  char *excluded;                /* words: columns that were left out and why; NULL: none */
  struct fg_loop_formula *model; /* for problem.declared; NULL: arc_length, which has no columns */
} fg_loop_table_problem;

/* Cells that are missing, columns that are not there, a formula that cannot be built: FG_ERR_DATA
 * or FG_ERR_USAGE with words. Columns that are results of the same measurement (bump radius and
 * angle, height ...) are no causes and are left out. */
fg_status fg_loop_table_problem_build(fg_context *ctx, const fg_table *table,
                                      const fg_loop_table_spec *spec,
                                      fg_loop_table_problem *problem);
void fg_loop_table_problem_free(fg_loop_table_problem *problem);

/* ---- reports ---- */

/* A file that the table was made from: a scan of a run, a part of a lot. */
typedef struct fg_loop_input {
  const char *path, *sha256;
} fg_loop_input;

typedef struct fg_loop_report {
  const char *path, *sha256;
  const fg_loop_table_spec *spec;
  const fg_loop_table_problem *problem;
  const fg_loop_result *result;
  uint64_t seed;
  const fg_loop_input *input; /* beside `path` */
  size_t inputs;
  const char *const *row_name; /* of the table's rows: "foil 3, bump 5"; NULL: their numbers */
  const char *said;            /* how the table was made, a note; NULL: nothing */
} fg_loop_report;

/* "foilgauge/loop/1" (reports/schema/loop.schema.json). */
fg_status fg_loop_write_json(fg_context *ctx, const fg_loop_report *report, FILE *out);
fg_status fg_loop_write_html(fg_context *ctx, const fg_loop_report *report, FILE *out);
fg_status fg_loop_write_text(fg_context *ctx, const fg_loop_report *report, FILE *out);
/* One sentence for a process engineer; the caller frees it. */
fg_status fg_loop_sentence(fg_context *ctx, const fg_loop_report *report, char **text);
/* What is assumed of the rows' scatter, in words. */
const char *fg_loop_noise_model(const fg_loop_result *result);

/* ---- the model file: declared model plus what was found ---- */

typedef struct fg_loop_model fg_loop_model;

/* "foilgauge/loop-model/1". */
fg_status fg_loop_write_model(fg_context *ctx, const fg_loop_report *report, FILE *out);
/* FG_ERR_DATA for a file that is not one. Free with fg_loop_model_free. */
fg_status fg_loop_model_load(fg_context *ctx, const char *path, fg_loop_model **model);
/* Takes the effects that were found out of the response column of a table, so that an analysis
 * with the declared formula starts from the better model. Lone rows (outlier, exchanged runs) are
 * of the table they were found in and are not applied. A value outside the range the model was
 * found in, or a level it has not seen, is FG_ERR_DATA with its row. */
fg_status fg_loop_model_apply(fg_context *ctx, const fg_loop_model *model, fg_table *table);

/* What a model took out of a table. */
typedef struct fg_loop_taken {
  char id[FG_LOOP_NAME], words[4 * FG_LOOP_NAME]; /* "a trend with humidity" */
  char sentence[10 * FG_LOOP_NAME]; /* with its effect on the response, in the words of the file; or
                                       empty */
  double amplitude, u_amplitude;    /* as it was found, standard uncertainty; NaN: not known */
  size_t parameters;                /* that were estimated for it */
  double low, high;                 /* range of the effect taken out of the rows */
  bool applied;                     /* false: it concerns rows of the table it was found in */
} fg_loop_taken;

typedef struct fg_loop_takings {
  fg_loop_taken *one;
  size_t count;
  double *change; /* rows: the sum that was taken out */
} fg_loop_takings;

/* As fg_loop_model_apply, and says what it took. Free with fg_loop_takings_free. */
fg_status fg_loop_model_take(fg_context *ctx, const fg_loop_model *model, fg_table *table,
                             fg_loop_takings *takings);
void fg_loop_takings_free(fg_loop_takings *takings);
const char *fg_loop_model_response(const fg_loop_model *model);
const char *fg_loop_model_formula(const fg_loop_model *model);
void fg_loop_model_free(fg_loop_model *model);

#ifdef __cplusplus
}
#endif
#endif

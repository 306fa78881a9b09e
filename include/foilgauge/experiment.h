/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Analysis of a designed experiment: from a table of runs to effects, tests, the best setting, and
 * the report.
 *
 * It combines table.h, regression.h, doe.h and surface.h. Numeric factors are coded
 * to -1 and +1, by the levels given or else by the lowest and highest of the data; a factor that
 * the formula transforms (log(t)) or reads as names (factor(t)) is not coded. Blocks enter as a
 * factor of their own, and predictions are averaged over them. With whole plots every coefficient
 * is tested against the error of its own stratum, or where runs are missing by restricted
 * likelihood (doe.h), which then also gives coefficients, fitted values and residuals.
 *
 * Where the uncertainty of the responses differs much between runs (some u above twice the lower
 * quartile and above 0.3 of the scatter), runs are weighed by 1 / (s² + u²), with s, the scatter of
 * the process by restricted likelihood, and Satterthwaite's dof, by which the runs tell s; split
 * plots are not weighed.
 *
 * A value that cannot be computed is NaN; a note has the reason and the conclusions that remain
 * valid. */
#ifndef FOILGAUGE_EXPERIMENT_H
#define FOILGAUGE_EXPERIMENT_H

#include <stdio.h>

#include "foilgauge/calibration.h"
#include "foilgauge/doe.h"
#include "foilgauge/regression.h"
#include "foilgauge/surface.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Sign of the response. The thesis models the magnitude of a springback error, which is negative.
 * AUTO does so for a response whose name holds "springback_error" when all values have one sign,
 * and changes no other. */
typedef enum fg_experiment_sign {
  FG_SIGN_AUTO,
  FG_SIGN_AS_IS,
  FG_SIGN_MAGNITUDE,
} fg_experiment_sign;

/* Effect of a loop's model, which is subtracted from the response before the analysis. */
typedef struct fg_subtracted_effect {
  char id[64], words[400];       /* "table.linear", "a trend with humidity" */
  char sentence[1000];           /* with its effect on the response; empty: unknown */
  double amplitude, u_amplitude; /* half its range in its own data, and the standard uncertainty */
  size_t parameters;             /* number of parameters estimated for it */
  double low, high;              /* range of the part subtracted from these runs */
  bool applied;       /* false: it belongs to single rows of its own table and is not subtracted */
  char column[2][96]; /* of the table, that it is over; empty: none */
} fg_subtracted_effect;

#define FG_EXPERIMENT_CONFIDENCE 0.95 /* default level of intervals */

typedef struct fg_experiment_options {
  const char *response; /* NULL: the formula's left side */
  const char *formula;
  const fg_coding *coding; /* of some factors; the others by the data */
  size_t codings;
  bool uncoded; /* factors without a coding here stay in real units */
  fg_experiment_sign sign;
  const char *block;       /* column that names the blocks; NULL: none */
  const char *whole_plot;  /* column that names the whole plots; NULL: none */
  const char *uncertainty; /* column with the response's standard uncertainty; NULL: none */
  const char *reading;     /* how cells of the runs were read, as a note; NULL: as they stand */
  double confidence;       /* 0: FG_EXPERIMENT_CONFIDENCE */
  fg_goal goal;
  double target;                 /* FG_GOAL_TARGET: the response wanted */
  const char *const *constraint; /* "temperature_C <= 700", "2*a + b >= 3", in real units */
  size_t constraints;
  const char *const *at; /* "temperature_C=650, duration_h=4": settings to predict, in real units,
                            every factor once */
  size_t ats;
  const fg_rounding *round; /* steps that the best setting is rounded to */
  size_t rounds;
  const fg_subtracted_effect *subtracted; /* from the response, already */
  size_t subtracted_count;
  const double *subtracted_sum; /* rows: sum of those effects; NULL without any */
} fg_experiment_options;

/* A numeric factor of the model. */
typedef struct fg_factor {
  const char *name; /* the table's column */
  size_t variable;  /* index into model.formula.variable */
  bool coded;       /* by `coding`; false: -1 and +1 are real values */
  bool transformed; /* enters the model through a function */
  fg_coding coding;
  double lowest, highest; /* of the data, in the model's units */
} fg_factor;

/* Properties of a coefficient beyond regression.coefficient[i] (same index): the error is that of
 * its stratum. */
typedef struct fg_experiment_effect {
  bool block;      /* of a block: not an effect of interest */
  bool whole_plot; /* tested against the scatter of whole plots */
  double dof;      /* of its error */
  double standard_error, t, p_value, low, high;
  double relative_pct;  /* 100 estimate / constant (table 5.2); NaN for the constant */
  double u_measurement; /* contribution of the measurement's uncertainty to the standard error */
  double contrast;      /* estimate as in an orthogonal design of this size, for Lenth and plots */
  double lenth_p_value; /* NaN without Lenth */
} fg_experiment_effect;

/* Factor of the model that is not significant: neither are its coefficients one by one, nor all of
 * them together with those of the other such factors. Its setting does not matter. */
typedef struct fg_idle_factor {
  size_t variable; /* index into model.formula.variable */
  size_t columns;  /* number of the model's columns that contain it */
  double p_value;  /* of all its coefficients together; NaN: no error is known, Lenth's margin
                      decided */
} fg_idle_factor;

typedef struct fg_optimum {
  double x[FG_SURFACE_FACTORS]; /* model's units, in the order of surface.variable */
  fg_prediction prediction;     /* mean with its interval; interval of one confirmation run */
  bool on_border;               /* on the border of the region: the best setting may lie beyond */
  bool on_edge_of_runs;         /* the border is the end of the runs' range, not a constraint */
} fg_optimum;

/* Prediction at a requested setting, by the model as given. */
typedef struct fg_asked {
  char *text;                           /* the request's text */
  double setting[FG_FORMULA_VARIABLES]; /* as in fg_model_row */
  fg_prediction prediction;
  bool inside; /* within the range of the runs, in every factor */
  /* By variable of a numeric factor: best value within the runs, with the others as requested. */
  double best_at[FG_FORMULA_VARIABLES], best_mean[FG_FORMULA_VARIABLES];
} fg_asked;

enum { FG_RIDGE_POINTS = 11 };

typedef struct fg_ridge_point {
  double radius, x[FG_SURFACE_FACTORS];
  fg_prediction prediction;
  bool inside; /* within the region of the data and the constraints */
} fg_ridge_point;

/* Tests of the residuals over the order of the runs, beside the model. Each test has the level
 * FG_ORDER_LEVEL, 5 % over the three. NaN: not computable. */
#define FG_ORDER_LEVEL (0.05 / 3)
typedef struct fg_order_check {
  const char *column;    /* of the table that orders the runs: run, order ...; NULL: their rows */
  const double *value;   /* rows: position of a run in the order */
  double drift, u_drift; /* change of the response from the first run to the last */
  double drift_p;        /* Student's t of the slope, fitted beside the model */
  double neighbours;     /* correlation of successive residuals */
  double durbin_watson;
  double neighbours_p;           /* two-sided: independent normal errors through the same model */
  size_t farthest;               /* row of the largest externally studentised residual, from 0 */
  double farthest_t, farthest_p; /* p over all runs (Bonferroni) */
} fg_order_check;

/* Quantiles of the largest share that the random error of the coefficients, and of these and a new
 * run, reaches in any prediction in the region of the runs: by them intervals hold at every setting
 * there at once. `rank`: number of estimated coefficients; 0: not known. */
enum { FG_SIMULTANEOUS_NODES = 32 };
typedef struct fg_simultaneous {
  size_t rank;
  double share[FG_SIMULTANEOUS_NODES], run_share[FG_SIMULTANEOUS_NODES];
  double dof, run_dof, factor, run_factor; /* coverage factors in the middle of the region */
} fg_simultaneous;

/* Effects that were subtracted from the response. */
typedef struct fg_experiment_subtracted {
  fg_subtracted_effect *effects;
  size_t count, dof; /* dof: their parameters, by which the residual dof is lowered */
  double *sum;       /* rows; NULL: nothing was subtracted */
} fg_experiment_subtracted;

/* Uncertainty of the responses by their measurement, and the weights of the runs by it. */
typedef struct fg_experiment_measurement {
  double *u;         /* rows; NULL: not known */
  double u_rms;      /* NaN: not known */
  double process_sd; /* scatter besides the measurement's; NaN: not separated */
  double *weight;    /* rows: 1 / (process² + u²) over the median; NULL: all equal */
  /* Sums that the dof of the weighted runs come from: see src/process/experiment_weights.c. */
  double *weight_gram, weight_trace;
} fg_experiment_measurement;

/* Factors that are not significant. */
typedef struct fg_idle_factors {
  fg_idle_factor factor[FG_FORMULA_VARIABLES];
  size_t count;
  bool all; /* no factor of the model is significant */
} fg_idle_factors;

/* Best setting of the surface for a goal. */
typedef struct fg_best_setting {
  fg_goal goal;
  double target; /* FG_GOAL_TARGET: the response wanted */
  bool found;
  fg_optimum optimum;
  double levels[FG_FORMULA_VARIABLES]; /* of word factors */
  /* Best feasible setting near the optimum: every factor with a step at a multiple of it, all in
   * the region. */
  bool has_rounded;
  double step[FG_SURFACE_FACTORS]; /* of the surface's factors; 0: not rounded */
  fg_optimum rounded;
  fg_ridge_point ridge[FG_RIDGE_POINTS];
} fg_best_setting;

typedef struct fg_experiment fg_experiment;
struct fg_experiment {
  fg_table table;           /* as analysed: coded, sign applied */
  char *response, *formula; /* canonical, blocks included */
  char *block, *whole_plot; /* columns; NULL: none */
  size_t block_variable;    /* of the model; FG_FORMULA_VARIABLES: no blocks */
  double confidence;
  bool magnitude, sign_chosen; /* the response is |y|; by AUTO */
  fg_model model;
  fg_regression regression;
  fg_experiment_effect *effect; /* per column of the regression */
  fg_factor factor[FG_FORMULA_VARIABLES];
  size_t factors;
  double *setting; /* rows × model.formula.variables: every run for predictions */
  fg_experiment_measurement measurement;
  fg_experiment_subtracted subtracted;

  bool has_lenth, has_box_cox, has_curvature, has_split_plot, has_surface, has_order;
  fg_lenth lenth; /* of fg_experiment_effect.contrast */
  fg_box_cox box_cox;
  fg_curvature curvature;
  fg_split_plot split_plot;
  fg_surface surface;
  bool stationary_inside;   /* inside the region */
  fg_prediction stationary; /* at the stationary point */
  fg_order_check order;
  double *order_value;
  fg_region region;  /* box and ball of the runs, and the constraints */
  char **constraint; /* as given */
  size_t constraints;
  fg_simultaneous simultaneous;
  fg_best_setting best;

  fg_idle_factors idle;
  /* The experiment without the idle factors, which has the best setting then; NULL: all factors are
   * significant, or none is. */
  fg_experiment *reduced;

  fg_asked *asked;
  size_t askeds;

  char **note; /* results that could not be computed, with the reason */
  size_t notes, note_capacity;
};

/* FG_ERR_DATA, with row and column: a column is missing, a word among numbers, a cell without a
 * number, one run only, a response or a factor with one value. FG_ERR_USAGE: invalid formula,
 * coding or constraint. `options` is not kept. Free with fg_experiment_free. */
fg_status fg_experiment_analyse(fg_context *ctx, const fg_table *runs,
                                const fg_experiment_options *options, fg_experiment *experiment);
void fg_experiment_free(fg_experiment *experiment);

/* Predicts the response at a setting (as in fg_model_row; blocks are averaged over), with the
 * errors of the strata. */
fg_status fg_experiment_predict(fg_context *ctx, const fg_experiment *experiment,
                                const double *setting, fg_prediction *prediction);

/* Returns the experiment whose model gives the best setting: `reduced`, or the experiment itself.
 */
const fg_experiment *fg_experiment_best(const fg_experiment *experiment);

/* Returns the best setting: the one that can be made, where that was asked for. */
const fg_optimum *fg_experiment_best_point(const fg_experiment *experiment);

/* Returns true for a subtracted effect that is over factors of the model alone: the response at a
 * setting has it, and the model of the remainder predicts none. */
bool fg_experiment_is_of_factors(const fg_experiment *experiment,
                                 const fg_subtracted_effect *effect);

/* Returns the p value to judge a column by: its own, or Lenth's where no error is known; NaN:
 * neither. */
double fg_experiment_p_value(const fg_experiment *experiment, size_t column);

/* Returns true for a column of the model that is neither constant, nor block, nor aliased. */
bool fg_experiment_of_interest(const fg_experiment *experiment, size_t column);

/* Returns the numeric factor whose first power alone the column is, or NULL. */
const fg_factor *fg_experiment_main_factor(const fg_experiment *experiment, size_t column);

/* Returns the factor of the surface's axis k. */
const fg_factor *fg_surface_factor(const fg_experiment *experiment, size_t k);

/* Returns true where repeated runs show lack of fit. */
bool fg_experiment_lacks_fit(const fg_experiment *experiment);

/* Returns true where a test of the order is significant; where any of them is. */
bool fg_order_shows(double p_value);
bool fg_order_seen(const fg_order_check *order);

/* Converts a factor's value to real units. */
double fg_factor_real(const fg_factor *factor, double x);

/* Scan behind a response. */
typedef struct fg_experiment_scan {
  const char *path; /* as opened */
  size_t run;       /* row of the run sheet, from 1 */
  char sha256[65];  /* "" when it could not be read */
  double value, u;  /* NaN when it could not be measured; u: of the scan alone */
  /* Change of the value by one standard deviation of each error that a calibration leaves: the same
   * error in every scan. 0: none is stated. */
  double move[FG_CALIBRATION_SOURCES];
  const char *error;
} fg_experiment_scan;

struct fg_design;

typedef struct fg_experiment_report {
  const fg_experiment *experiment;
  const char *path;   /* of the run sheet */
  const char *sha256; /* of its content */
  const fg_experiment_scan *scan;
  size_t scans;
  const size_t *row;              /* of the run sheet (from 1), for every analysed run; NULL: all */
  const char *scans_column;       /* of the run sheet; NULL: the responses were typed in */
  const char *design_path;        /* NULL: the default */
  const struct fg_design *design; /* design that the scans were measured with; NULL: no scans */
  double u_calibration; /* uncertainty of the level of all runs by errors common to all scans; not
                           in any run's u. 0: no calibration is stated */
  const char *model_path, *model_sha256; /* of the loop's model; NULL: none */
  const char *plan_path;                 /* plan whose limits code the factors; NULL: none */
  const char *plan_note;                 /* oddity of the plan, as a sentence; NULL: none */
} fg_experiment_report;

/* JSON, "schema": "foilgauge/doe/1" (reports/schema/doe.schema.json); a table for the terminal; one
 * self-contained page. FG_ERR_IO when the stream fails. */
fg_status fg_experiment_write_json(fg_context *ctx, const fg_experiment_report *report, FILE *out);
fg_status fg_experiment_write_table(fg_context *ctx, const fg_experiment_report *report, FILE *out);
fg_status fg_experiment_write_html(fg_context *ctx, const fg_experiment_report *report, FILE *out);

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Designed experiments: coding of factors, effects, and tests of designs.
 *
 * A factor in real units is coded to x = (value - centre) / half, so that its low level is -1 and
 * its high level +1; a coefficient is then the change of the response over half the range. The
 * relative effect of the thesis (table 5.2) is 100 coefficient / constant.
 *
 * Signs: a springback error is negative (springback opens the foil), while the thesis models its
 * magnitude in tables 5.2, 5.3 and 5.5. fg_response_apply makes the choice explicit.
 */
#ifndef FOILGAUGE_DOE_H
#define FOILGAUGE_DOE_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/regression.h"
#include "foilgauge/status.h"
#include "foilgauge/table.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_coding {
  char name[256];
  fg_extended low, high; /* real values of -1 and +1; low < high */
} fg_coding;

/* "NAME=LOW:HIGH". FG_ERR_USAGE names the fault. */
fg_status fg_coding_parse(fg_context *ctx, const char *text, fg_coding *coding);
/* Codes by the lowest and the highest value in the table. FG_ERR_DATA when they are equal. */
fg_status fg_coding_from_data(fg_context *ctx, const fg_table *table, const char *name,
                              fg_coding *coding);
double fg_coding_to_real(const fg_coding *coding, double coded);

/* Settings that a machine offers: the multiples of a step. */
typedef struct fg_rounding {
  char name[256]; /* of the factor */
  double step;    /* above 0 */
} fg_rounding;
/* "NAME=STEP". FG_ERR_USAGE names the fault. */
fg_status fg_rounding_parse(fg_context *ctx, const char *text, fg_rounding *rounding);
/* Returns the nearest multiple of the step; the value itself when the step is 0. */
double fg_round_to(double value, double step);

/* Replaces the table's column by coded values, to all digits. */
fg_status fg_coding_apply(fg_context *ctx, const fg_coding *coding, fg_table *table);

typedef enum fg_response_sign {
  FG_RESPONSE_AS_IS,
  FG_RESPONSE_NEGATED,
  FG_RESPONSE_MAGNITUDE, /* the absolute value, as modelled in the thesis */
} fg_response_sign;
fg_status fg_response_apply(fg_context *ctx, fg_response_sign sign, const char *name,
                            fg_table *table);

/* Returns 100 coefficient / constant; NaN for the constant itself, and without one. */
double fg_doe_relative_effect_pct(const fg_regression *regression, size_t column);

/* Lenth's test of effects without residual dof (Lenth 1989): the median of the effects gives their
 * error. Estimates of one scale: coefficients of orthogonal columns of -1 and +1. */
typedef struct fg_lenth {
  double pseudo_standard_error;
  double margin;              /* margin of error of one effect, at the chosen confidence */
  double simultaneous_margin; /* all effects together */
  double dof;                 /* effects / 3 */
} fg_lenth;
fg_status fg_lenth_compute(fg_context *ctx, const double *estimates, size_t count,
                           double confidence, fg_lenth *lenth);
double fg_lenth_p_value(const fg_lenth *lenth, double estimate);

/* Points of the half-normal plot, ascending: |effect| against the quantile at (i - 1/2) / n. */
typedef struct fg_half_normal {
  size_t effect; /* index into the estimates */
  double magnitude, quantile;
} fg_half_normal;
fg_status fg_half_normal_points(fg_context *ctx, const double *estimates, size_t count,
                                fg_half_normal *points);

/* Box and Cox (1964): power of the response that fits the model best; 0 is the logarithm. */
typedef struct fg_box_cox {
  double lambda, low, high;  /* most likely, and the 95 % interval within -5 to 5 */
  double log_likelihood;     /* at lambda, up to a constant */
  double log_likelihood_one; /* at 1: no transformation */
} fg_box_cox;
/* FG_ERR_DATA for a response that is not positive; FG_ERR_NUMERIC without residual dof. */
fg_status fg_box_cox_compute(fg_context *ctx, const fg_model *model, const fg_extended *response,
                             fg_box_cox *box_cox);

/* Test of curvature: centre points against the plane of the corners. One dof: n_f n_c (mean_f -
 * mean_c)² / (n_f + n_c), against the error within repeated runs. */
typedef struct fg_curvature {
  size_t corners, centres, error_dof;
  size_t others; /* number of runs that are neither corner nor centre: axial ones */
  double corner_mean, centre_mean;
  double sum_of_squares, error_mean_square;
  double f, p_value; /* NaN when no run is repeated */
} fg_curvature;
/* `factors` are coded columns; runs that are neither corner nor centre are left out. FG_ERR_DATA
 * when there are no corners or no centre points. */
fg_status fg_curvature_compute(fg_context *ctx, const fg_table *table, const char *const *factors,
                               size_t factor_count, const char *response, fg_curvature *curvature);

/* Restricted randomisation: factors that are constant within a whole plot (one oven load) are
 * tested against the scatter of whole plots, the others against the scatter within them.
 *
 * Where whole plots have one size and the factors within them are orthogonal to them, by an
 * analysis of variance in two strata, which is exact. Where runs are missing, or settings differ
 * from plot to plot, an effect is estimated from both strata: by restricted likelihood, with the
 * dof of Kenward and Roger (1997). Then f and p_value of a term are of that method, beside all
 * other terms, and there are no sums of squares. */
typedef struct fg_split_plot_term {
  fg_anova_row row;  /* f and p against its own error; owned by the result */
  size_t whole_plot; /* 1: constant within every whole plot */
  double error_dof;  /* dof of the error below f */
} fg_split_plot_term;
struct fg_mixed_model;
typedef struct fg_split_plot {
  fg_split_plot_term *term; /* whole-plot terms first, then the others, each sequential */
  size_t terms;
  size_t plots, plot_dof, run_dof;
  double plot_ss, plot_ms, run_ss, run_ms; /* of the strata; NaN mean square without dof */
  double plot_variance, run_variance;      /* the first at least 0; NaN: unknown */
  size_t balanced;                         /* 1: equal plots */
  bool at_border;                          /* the estimate of the whole plots' variance is 0 */
  struct fg_mixed_model *mixed;            /* NULL: by strata; owned */
  /* By strata: projects errors of the coefficients, as coordinates of an orthonormal basis of the
   * model's columns, onto those that the whole plots make; columns × columns, owned. NULL: the
   * strata are not orthogonal and nothing tells the scatter. */
  double *of_plots;
  /* Dof that fg_split_plot_subtract_dof subtracted from each stratum. */
  size_t subtracted_from_plots, subtracted_from_runs;
} fg_split_plot;
/* `plot` is the column that names whole plots. FG_ERR_DATA when it holds one name only, or as many
 * as runs. Free with fg_split_plot_free. */
fg_status fg_split_plot_analyse(fg_context *ctx, const fg_table *table, const fg_formula *formula,
                                const char *response, const char *plot, fg_split_plot *result);
/* Lowers the error's dof by `dof` parameters that were estimated from these runs and subtracted
 * from the response (`subtracted`, by row): the dof of the whole plots where the subtracted part is
 * constant within each plot, else those of the runs. FG_ERR_DATA when none is left. */
fg_status fg_split_plot_subtract_dof(fg_context *ctx, const fg_table *table, const char *plot,
                                     size_t dof, const double *subtracted, fg_split_plot *result);
void fg_split_plot_free(fg_split_plot *result);

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Least squares of a response on a model, with tests, intervals and diagnostics.
 *
 * The matrix is orthogonalised (modified Gram-Schmidt with the response as its last column, Björck
 * 1967) in extended precision (106 bits), from the decimal text of the data on, so that 13 digits
 * are left at a condition number of 1e15. A column that is a combination of earlier ones is
 * aliased: it gets no coefficient, and the combination is reported.
 *
 * Where something cannot be computed (no residual dof, a leverage of one) the number is NaN and a
 * note has the reason and the remedy.
 */
#ifndef FOILGAUGE_REGRESSION_H
#define FOILGAUGE_REGRESSION_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/formula.h"
#include "foilgauge/status.h"
#include "foilgauge/table.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_regression_options {
  double confidence;      /* of the intervals; 0 means 0.95 */
  double alias_tolerance; /* a column is aliased when less than this share of its length is left
                             after projection on the earlier columns; 0 means 1e-13 */
  const double *weights;  /* one per row, positive, 1 / variance up to a factor; NULL: all 1 */
  /* Effects estimated from these rows and subtracted from the response beforehand: the number of
   * their parameters, which lowers the residual dof; FG_ERR_DATA when no dof is left. `subtracted`
   * is the part subtracted from each row: where it differs between repeated runs it lowers the dof
   * of pure error, else those of lack of fit. */
  size_t dof_subtracted;
  const double *subtracted;
} fg_regression_options;

typedef struct fg_coefficient {
  char *name;
  size_t term;  /* index into the model's terms, or FG_MODEL_CONSTANT */
  bool aliased; /* then the numbers below are NaN */
  double estimate, standard_error, t, p_value;
  double low, high; /* limits of the confidence interval */
  double vif; /* variance inflation: 1 / (1 - R²), R of its regression on the other columns; NaN for
                 the constant */
} fg_coefficient;

/* column = sum of factor[i] × column with[i]. */
typedef struct fg_alias {
  size_t column, count;
  size_t *with;
  double *factor;
} fg_alias;

typedef struct fg_anova_row {
  char *name;
  size_t dof;
  double sum_of_squares, mean_square, f, p_value;
} fg_anova_row;

typedef struct fg_regression {
  size_t rows, columns, rank, residual_dof;
  bool constant; /* sums of squares are about the mean */
  double confidence;

  fg_coefficient *coefficient; /* columns */
  fg_alias *alias;             /* aliases */
  size_t aliases;

  double total_ss, model_ss, residual_ss, residual_sd;
  double r2, adjusted_r2, predicted_r2, press;
  double model_f, model_p_value;
  double adequate_precision; /* range of the fitted values over their mean standard error */
  double condition_number;   /* of the matrix with columns of equal length */

  fg_anova_row *sequential; /* terms: each after the ones above it (type I) */
  fg_anova_row *partial; /* terms: each after all others (type III): numbers in this coding, words
                            with equal weights of their levels */
  size_t terms;

  size_t lack_dof, pure_dof; /* pure_dof 0: no repeated runs */
  double lack_ss, pure_ss, lack_f, lack_p_value;

  /* rows each; the first two in units of the response, the others scaled by their sd */
  double *fitted, *residual, *leverage;
  double *internal; /* internally studentised: residual / (s sqrt(1 - h)) */
  double *external; /* externally studentised: s without the run */
  double *cook;     /* Cook's distance */

  char **note; /* numbers that could not be computed, with the remedy */
  size_t notes, note_capacity;

  fg_extended *estimate_extended; /* columns; 0 where aliased */
  fg_extended *inverse_root;      /* columns × columns, upper: U with (X'X)^-1 = U U' */
} fg_regression;

/* `response` holds model->rows numbers; `options` may be NULL. FG_ERR_USAGE for weights that are
 * not positive, FG_ERR_DATA for a response that is not finite or no row at all. Free with
 * fg_regression_free. */
fg_status fg_regression_fit(fg_context *ctx, const fg_model *model, const fg_extended *response,
                            const fg_regression_options *options, fg_regression *regression);

/* Formula and fit in one: the response is `response` or, when NULL, the formula's left side.
 * Either result may be freed alone. */
fg_status fg_regression_analyse(fg_context *ctx, const fg_table *table, const char *formula,
                                const char *response, const fg_regression_options *options,
                                fg_model *model, fg_regression *regression);

/* Prediction at a row of the model matrix: the expected response, the standard error of that mean,
 * and of one new run (unit weight). */
typedef struct fg_prediction {
  double mean, standard_error, run_standard_error;
  double low, high;         /* confidence interval of the mean */
  double run_low, run_high; /* prediction interval of one run */
  double coverage_factor;   /* half of the mean's interval over the standard error */
  double dof, run_dof;      /* of the two standard errors */
} fg_prediction;
fg_status fg_regression_predict(fg_context *ctx, const fg_regression *regression, const double *row,
                                fg_prediction *prediction);

void fg_regression_free(fg_regression *regression);

#ifdef __cplusplus
}
#endif
#endif

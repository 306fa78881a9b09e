/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Constants of the material that predict runs with the smallest sum of squares. */
#ifndef FG_FORMING_SEARCH_H
#define FG_FORMING_SEARCH_H

#include <gsl/gsl_matrix.h>
#include <gsl/gsl_vector.h>

#include "foilgauge/forming.h"

#define FG_FORMING_NOWHERE 1e4 /* springback, in percentage points, far from any run */

/* Runs, and the constants that a search may move; the others stay at the material's values. */
typedef struct fg_forming_search {
  fg_context *ctx;
  const fg_forming_fit *fit;
  fg_design design; /* of the response's subject */
  fg_forming_material material;
  size_t free;
  fg_forming_constant constant[FG_FORMING_FREE_MAX];
  size_t left_out; /* run; SIZE_MAX: none */
  fg_status status;
} fg_forming_search;

/* Transforms a constant for the search: its logarithm, or its value in units of its default; and
 * back, within its limits. */
double fg_forming_to_step(fg_forming_constant c, double value);
double fg_forming_from_step(fg_forming_constant c, double step);

/* Predicts a run with the constants in `material`; an error is kept in `status`. */
double fg_forming_search_predict(fg_forming_search *s, const fg_forming_run_fit *run);
size_t fg_forming_search_rows(const fg_forming_search *s);

/* Runs Levenberg-Marquardt from x; x and `sum` get the result, `covariance` (may be NULL) (J'J)^-1,
 * NaN where it is singular. */
fg_status fg_forming_search_from(fg_forming_search *s, gsl_vector *x, double *sum,
                                 gsl_matrix *covariance);

/* Finds the smallest sum of squares over the free constants, starting from `warm` (may be NULL) and
 * from the best of a grid; `x` gets its place. */
fg_status fg_forming_search_all(fg_forming_search *s, const gsl_vector *warm, gsl_vector *x,
                                double *min, gsl_matrix *covariance);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The constants that predict runs with the least sum of squares. */
#ifndef FG_FORMING_SEARCH_H
#define FG_FORMING_SEARCH_H

#include <gsl/gsl_matrix.h>
#include <gsl/gsl_vector.h>

#include "foilgauge/forming.h"

#define FG_FORMING_NOWHERE 1e4 /* points of springback: no run is there */

/* Runs, and which constants a search may move; the rest stay as the material has them. */
typedef struct fg_forming_search {
  fg_context *ctx;
  const fg_forming_fit *fit;
  fg_design design; /* of what the response is of */
  fg_forming_material material;
  size_t free;
  fg_forming_constant constant[FG_FORMING_FREE_MAX];
  size_t left_out; /* run; SIZE_MAX: none */
  fg_status status;
} fg_forming_search;

/* A constant as the search moves it: its logarithm, or in units of its default; and back, within
 * what the constant may be. */
double fg_forming_to_step(fg_forming_constant c, double value);
double fg_forming_from_step(fg_forming_constant c, double step);

/* With the constants as `material` has them; an error stays in `status`. */
double fg_forming_search_predict(fg_forming_search *s, const fg_forming_run_fit *run);
size_t fg_forming_search_rows(const fg_forming_search *s);

/* Levenberg-Marquardt from x; x and `sum` become the end's, `covariance` (may be NULL) (J'J)^-1,
 * NaN where there is none. */
fg_status fg_forming_search_from(fg_forming_search *s, gsl_vector *x, double *sum,
                                 gsl_matrix *covariance);

/* The least sum of squares over the free constants, from `warm` (may be NULL) and from the best of
 * a grid; `x` becomes where it lies. */
fg_status fg_forming_search_all(fg_forming_search *s, const gsl_vector *warm, gsl_vector *x,
                                double *min, gsl_matrix *covariance);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "forming/search.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <math.h>
#include <string.h>

#include "forming/forming.h"

enum {
  ITERATIONS = 200,
  STARTS_KEPT = 3,
  STARTS_EACH = 3,
  STARTS_MAX = 81, /* 3^FG_FORMING_FREE_MAX */
};
static const double tolerance = 1e-10;
/* Value of an invalid prediction, in points: far beyond every run. */
static const double nowhere = FG_FORMING_NOWHERE;

/* A constant as the search moves it. */
double fg_forming_to_step(fg_forming_constant c, double value) {
  const fg_forming_constant_row *row = fg_forming_constant_of(c);
  return row->by_factors ? log(value) : value / row->value;
}

double fg_forming_from_step(fg_forming_constant c, double step) {
  const fg_forming_constant_row *row = fg_forming_constant_of(c);
  double value = row->by_factors ? exp(step) : step * row->value;
  return fmin(row->high, fmax(row->low, value));
}

double fg_forming_search_predict(fg_forming_search *s, const fg_forming_run_fit *run) {
  fg_forming_schedule hold = {.time_h = (double[]){0, run->duration_h},
                              .temperature_C = (double[]){run->temperature_C, run->temperature_C},
                              .count = 2};
  fg_forming forming;
  if (s->status != FG_OK) return nowhere;
  s->status = fg_forming_bend(s->ctx, &s->design, &s->material, &hold, &s->fit->options, &forming);
  double value = s->fit->response == FG_FORMING_OF_STRIP ? forming.strip_springback_error_pct
                                                         : forming.springback_error_pct;
  fg_forming_free(&forming);
  return s->status == FG_OK && isfinite(value) ? fmax(-nowhere, fmin(nowhere, value)) : nowhere;
}

static int residuals(const gsl_vector *x, void *user, gsl_vector *f) {
  fg_forming_search *s = user;
  size_t at = 0;
  for (size_t k = 0; k < s->free; k++)
    s->material.value[s->constant[k]] = fg_forming_from_step(s->constant[k], gsl_vector_get(x, k));
  for (size_t i = 0; i < s->fit->runs; i++)
    if (i != s->left_out)
      gsl_vector_set(f, at++,
                     fg_forming_search_predict(s, &s->fit->run[i]) - s->fit->run[i].measured);
  return s->status == FG_OK ? GSL_SUCCESS : GSL_EBADFUNC;
}

size_t fg_forming_search_rows(const fg_forming_search *s) {
  return s->fit->runs - (s->left_out < s->fit->runs);
}

/* Sum of squares at x. */
static double sum_at(fg_forming_search *s, const gsl_vector *x, gsl_vector *f) {
  double norm = INFINITY;
  if (residuals(x, s, f) == GSL_SUCCESS) norm = gsl_blas_dnrm2(f);
  return norm * norm;
}

/* Levenberg-Marquardt from x; x and `sum` become the end's, `covariance` (may be NULL) (J'J)^-1. */
fg_status fg_forming_search_from(fg_forming_search *s, gsl_vector *x, double *sum,
                                 gsl_matrix *covariance) {
  gsl_multifit_nlinear_parameters how = gsl_multifit_nlinear_default_parameters();
  gsl_multifit_nlinear_fdf fdf = {
      .f = residuals, .n = fg_forming_search_rows(s), .p = s->free, .params = s};
  gsl_multifit_nlinear_workspace *w =
      gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &how, fdf.n, fdf.p);
  int info = 0;
  if (!w) return fg_fail(s->ctx, FG_ERR_MEMORY, "out of memory: a fit of %zu runs", fdf.n);
  int code = gsl_multifit_nlinear_init(x, &fdf, w);
  if (code == GSL_SUCCESS)
    gsl_multifit_nlinear_driver(ITERATIONS, tolerance, tolerance, tolerance, NULL, NULL, &info, w);
  if (code == GSL_SUCCESS && s->status == FG_OK) {
    gsl_vector_memcpy(x, gsl_multifit_nlinear_position(w));
    double norm = gsl_blas_dnrm2(gsl_multifit_nlinear_residual(w));
    *sum = norm * norm;
    if (covariance &&
        gsl_multifit_nlinear_covar(gsl_multifit_nlinear_jac(w), 0, covariance) != GSL_SUCCESS)
      gsl_matrix_set_all(covariance, NAN);
  }
  gsl_multifit_nlinear_free(w);
  return s->status;
}

/* Returns a start of the search: the creep constants of such strips lie within these starts by
 * orders of magnitude; other constants start around the material's value. */
static double start_of(const fg_forming_search *s, fg_forming_constant c, size_t i) {
  static const double rate[] = {1e-8, 1e-5, 1e-2}, exponent[] = {1.5, 4, 7},
                      energy[] = {80, 160, 280}, around[] = {0.7, 1, 1.4};
  switch (c) {
  case FG_FORMING_CREEP_RATE:
    return rate[i];
  case FG_FORMING_CREEP_EXPONENT:
    return exponent[i];
  case FG_FORMING_CREEP_ENERGY:
    return energy[i];
  default:
    return around[i] * s->fit->material.value[c];
  }
}

/* The best few of a grid, in order. */
static void choose_starts(fg_forming_search *s, gsl_vector *x, gsl_vector *f,
                          double best[STARTS_KEPT][FG_FORMING_FREE_MAX]) {
  double sums[STARTS_KEPT] = {INFINITY, INFINITY, INFINITY};
  size_t count = 1;
  for (size_t k = 0; k < s->free; k++)
    count *= STARTS_EACH;
  for (size_t start = 0; start < count && start < STARTS_MAX; start++) {
    size_t digit = start;
    for (size_t k = 0; k < s->free; k++, digit /= STARTS_EACH)
      gsl_vector_set(
          x, k,
          fg_forming_to_step(s->constant[k], start_of(s, s->constant[k], digit % STARTS_EACH)));
    double sum = sum_at(s, x, f);
    size_t place = STARTS_KEPT;
    while (place && sum < sums[place - 1])
      place--;
    if (place == STARTS_KEPT) continue;
    size_t moved = STARTS_KEPT - 1 - place;
    memmove(&sums[place + 1], &sums[place], moved * sizeof *sums);
    memmove(best[place + 1], best[place], moved * sizeof *best);
    sums[place] = sum;
    for (size_t k = 0; k < s->free; k++)
      best[place][k] = gsl_vector_get(x, k);
  }
}

fg_status fg_forming_search_all(fg_forming_search *s, const gsl_vector *warm, gsl_vector *x,
                                double *min, gsl_matrix *covariance) {
  double best[STARTS_KEPT][FG_FORMING_FREE_MAX] = {{0}};
  gsl_vector *trial = gsl_vector_alloc(s->free), *f = gsl_vector_alloc(fg_forming_search_rows(s));
  gsl_matrix *inverse = gsl_matrix_alloc(s->free, s->free);
  fg_status status = FG_OK;
  *min = INFINITY;
  if (!trial || !f || !inverse) FG_TRY_EXIT(fg_fail(s->ctx, FG_ERR_MEMORY, "out of memory: a fit"));
  choose_starts(s, trial, f, best);
  for (size_t start = 0; start < STARTS_KEPT + (warm != NULL); start++) {
    double sum = INFINITY;
    for (size_t k = 0; k < s->free; k++)
      gsl_vector_set(trial, k, start < STARTS_KEPT ? best[start][k] : gsl_vector_get(warm, k));
    FG_TRY_EXIT(fg_forming_search_from(s, trial, &sum, inverse));
    if (!(sum < *min)) continue;
    *min = sum;
    gsl_vector_memcpy(x, trial);
    if (covariance) gsl_matrix_memcpy(covariance, inverse);
  }
exit:
  gsl_vector_free(trial);
  gsl_vector_free(f);
  gsl_matrix_free(inverse);
  return status;
}

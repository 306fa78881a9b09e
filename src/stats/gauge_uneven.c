/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Restricted likelihood of the cells' means and of the scatter within cells, profiled over mean and
 * repeatability: with r the variances over that of the repeatability,
 *
 *   V = r_p P P' + r_o O O' + r_i I + diag(1 / n)
 *
 *   q = m' (V^-1 - V^-1 1 1' V^-1 / 1' V^-1 1) m + SS
 *
 *   -2 log L = log |V| + log 1' V^-1 1 + (N - 1) log q
 */
#include "foilgauge/gauge_uneven.h"

#include <math.h>
#include <stdlib.h>

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit.h>
#include <gsl/gsl_multimin.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "foilgauge/distribution.h"

/* Trials that differ by no more than this share of their value are rounded alike, not measured. */
#define ROUNDING 1e-12
/* Criterion of ratios that no covariance has: GSL's simplex ends at an infinite one. */
#define IMPOSSIBLE 1e300

enum { PARTS, OPERATORS, INTERACTION, RATIOS };

typedef struct cell {
  size_t part, who;
  double count, mean;
} cell;

typedef struct cells {
  cell *at;
  size_t count, values;
  double within; /* sum of squares about the cells' means */
  gsl_matrix *v;
  gsl_vector *one, *mean;
  bool pooled;
} cells;

static cell *find_cell(cells *c, size_t part, size_t who) {
  for (size_t k = 0; k < c->count; k++)
    if (c->at[k].part == part && c->at[k].who == who) return &c->at[k];
  if (c->count == FG_GAUGE_CELLS_MAX) return NULL;
  c->at[c->count] = (cell){.part = part, .who = who};
  return &c->at[c->count++];
}

/* Welford's running mean, beside the first value, and sum of squares; false: too many cells. */
static bool gather(cells *c, const fg_gauge_trial *trial, size_t count) {
  for (size_t i = 0; i < count; i++) {
    cell *at = find_cell(c, trial[i].part, trial[i].who);
    if (!at) return false;
    double value = trial[i].value - trial[0].value, step = value - at->mean;
    at->mean += step / ++at->count;
    c->within += step * (value - at->mean);
  }
  c->values = count;
  return true;
}

static void fill_covariance(const cells *c, const double ratio[RATIOS]) {
  for (size_t i = 0; i < c->count; i++)
    for (size_t k = 0; k <= i; k++) {
      const cell *a = &c->at[i], *b = &c->at[k];
      double v =
          (a->part == b->part ? ratio[PARTS] : 0) + (a->who == b->who ? ratio[OPERATORS] : 0);
      if (i == k) v += ratio[INTERACTION] + 1 / a->count;
      gsl_matrix_set(c->v, i, k, v);
    }
}

/* -2 log L, without constants; `q` is as above. */
static double criterion(const cells *c, const double ratio[RATIOS], double *q) {
  double weight, mean, squares, log_det = 0;
  fill_covariance(c, ratio);
  if (gsl_linalg_cholesky_decomp1(c->v)) return IMPOSSIBLE;
  for (size_t i = 0; i < c->count; i++) {
    log_det += 2 * log(gsl_matrix_get(c->v, i, i));
    gsl_vector_set(c->one, i, 1);
    gsl_vector_set(c->mean, i, c->at[i].mean);
  }
  gsl_blas_dtrsv(CblasLower, CblasNoTrans, CblasNonUnit, c->v, c->one);
  gsl_blas_dtrsv(CblasLower, CblasNoTrans, CblasNonUnit, c->v, c->mean);
  gsl_blas_ddot(c->one, c->one, &weight);
  gsl_blas_ddot(c->one, c->mean, &mean);
  gsl_blas_ddot(c->mean, c->mean, &squares);
  *q = squares - mean * mean / weight + c->within;
  double value = log_det + log(weight) + ((double)c->values - 1) * log(*q);
  return isfinite(value) ? value : IMPOSSIBLE;
}

static bool do_trials_differ(const cells *c, double value) {
  return c->within > (double)c->values * pow(ROUNDING * value, 2);
}

/* The search is over standard deviations, which it may pass through 0. */
static void take_ratios(const cells *c, const gsl_vector *sd, double ratio[RATIOS]) {
  for (size_t k = 0; k < RATIOS; k++)
    ratio[k] = k == INTERACTION && c->pooled ? 0 : pow(gsl_vector_get(sd, k), 2);
}

static double criterion_of(const gsl_vector *sd, void *user) {
  double ratio[RATIOS], q;
  take_ratios(user, sd, ratio);
  return criterion(user, ratio, &q);
}

/* Twice from the best so far: a simplex may have collapsed. */
static fg_status maximise(fg_context *ctx, cells *c, double ratio[RATIOS]) {
  enum { STEPS = 400 };
  size_t size = c->pooled ? INTERACTION : RATIOS;
  double start[RATIOS] = {2, 0.5, 0.5}, steps[RATIOS] = {1, 0.4, 0.4};
  gsl_vector_view at = gsl_vector_view_array(start, size),
                  step = gsl_vector_view_array(steps, size);
  gsl_multimin_function f = {criterion_of, size, c};
  gsl_multimin_fminimizer *search =
      gsl_multimin_fminimizer_alloc(gsl_multimin_fminimizer_nmsimplex2, size);
  if (!search) return fg_fail(ctx, FG_ERR_MEMORY, "no memory for a gauge study");
  for (int round = 0; round < 2; round++) {
    gsl_multimin_fminimizer_set(search, &f, &at.vector, &step.vector);
    for (int k = 0; k < STEPS && gsl_multimin_fminimizer_size(search) > 1e-7; k++)
      if (gsl_multimin_fminimizer_iterate(search)) break;
    gsl_vector_memcpy(&at.vector, search->x);
  }
  take_ratios(c, &at.vector, ratio);
  gsl_multimin_fminimizer_free(search);
  return FG_OK;
}

/* The interaction's sum of squares and dof: the cells' means beside fixed parts and operators. */
static fg_status interaction(fg_context *ctx, const cells *c, fg_gauge_study *study, double *dof) {
  size_t columns = study->parts + study->operators, rank = 0;
  gsl_matrix *x = gsl_matrix_calloc(c->count, columns), *cov = gsl_matrix_alloc(columns, columns);
  gsl_vector *y = gsl_vector_alloc(c->count), *w = gsl_vector_alloc(c->count),
             *b = gsl_vector_alloc(columns);
  gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(c->count, columns);
  fg_status status = FG_OK;
  if (!x || !cov || !y || !w || !b || !work)
    status = fg_fail(ctx, FG_ERR_MEMORY, "no memory for a gauge study");
  for (size_t i = 0; status == FG_OK && i < c->count; i++) {
    gsl_matrix_set(x, i, c->at[i].part, 1);
    gsl_matrix_set(x, i, study->parts + c->at[i].who, 1);
    gsl_vector_set(y, i, c->at[i].mean);
    gsl_vector_set(w, i, c->at[i].count);
  }
  double ignored;
  if (status == FG_OK) gsl_multifit_wlinear_tsvd(x, w, y, 1e-9, b, cov, &ignored, &rank, work);
  for (size_t i = 0; status == FG_OK && i < c->count; i++) {
    double fit = gsl_vector_get(b, c->at[i].part) + gsl_vector_get(b, study->parts + c->at[i].who);
    study->ss_interaction += c->at[i].count * pow(c->at[i].mean - fit, 2);
  }
  *dof = (double)c->count - (double)rank;
  gsl_matrix_free(x);
  gsl_matrix_free(cov);
  gsl_vector_free(y);
  gsl_vector_free(w);
  gsl_vector_free(b);
  gsl_multifit_linear_free(work);
  return status;
}

/* Numbers parts or operators that have trials in order; returns how many there are. */
static size_t renumber(cells *c, bool who) {
  size_t next = 0, known[FG_GAUGE_CELLS_MAX];
  for (size_t i = 0; i < c->count; i++) {
    size_t *index = who ? &c->at[i].who : &c->at[i].part, k = 0;
    while (k < next && known[k] != *index)
      k++;
    if (k == next) known[next++] = *index;
    *index = k;
  }
  return next;
}

static fg_status estimate(fg_context *ctx, cells *c, fg_gauge_study *study) {
  double ratio[RATIOS], q, dof, within = (double)(c->values - c->count);
  FG_TRY(interaction(ctx, c, study, &dof));
  study->ss_repeat = c->within;
  study->f_interaction = dof > 0 ? study->ss_interaction / dof / (c->within / within) : NAN;
  study->p_interaction = dof > 0 ? fg_distribution_f_upper(study->f_interaction, dof, within) : NAN;
  study->pooled = c->pooled = !(study->p_interaction <= 0.25);
  FG_TRY(maximise(ctx, c, ratio));
  criterion(c, ratio, &q);
  double variance = q / ((double)c->values - 1);
  study->repeatability = sqrt(variance);
  study->interaction = sqrt(variance * ratio[INTERACTION]);
  study->reproducibility = hypot(sqrt(variance * ratio[OPERATORS]), study->interaction);
  study->part = sqrt(variance * ratio[PARTS]);
  study->grr = hypot(study->repeatability, study->reproducibility);
  study->total = hypot(study->grr, study->part);
  study->grr_pct = 100 * study->grr / study->total;
  study->distinct_categories = 1.41 * study->part / study->grr;
  return FG_OK;
}

fg_status fg_gauge_study_uneven(fg_context *ctx, const fg_gauge_trial *trial, size_t count,
                                fg_gauge_study *study) {
  cells c = {0};
  fg_status status = FG_OK;
  *study = (fg_gauge_study){.ss_operator = NAN,
                            .ss_part = NAN,
                            .range_repeatability = NAN,
                            .range_reproducibility = NAN,
                            .range_grr = NAN,
                            .range_part = NAN,
                            .range_total = NAN};
  fg_numerics_start();
  FG_TRY(fg_memory_allocate(ctx, FG_GAUGE_CELLS_MAX, sizeof *c.at, (void **)&c.at));
  bool few = gather(&c, trial, count);
  study->parts = renumber(&c, false);
  study->operators = renumber(&c, true);
  for (size_t i = 0; i < c.count; i++)
    study->trials = (size_t)fmax((double)study->trials, c.at[i].count);
  if (!few || study->parts < 2 || study->operators < 2 || count <= c.count ||
      !do_trials_differ(&c, trial[0].value)) {
    status =
        fg_fail(ctx, FG_ERR_DATA,
                "a gauge study needs two parts and operators, repeated trials that differ, and "
                "at most %d cells",
                FG_GAUGE_CELLS_MAX);
    goto exit;
  }
  c.v = gsl_matrix_alloc(c.count, c.count);
  c.one = gsl_vector_alloc(c.count);
  c.mean = gsl_vector_alloc(c.count);
  status = c.v && c.one && c.mean ? estimate(ctx, &c, study)
                                  : fg_fail(ctx, FG_ERR_MEMORY, "no memory for a gauge study");
exit:
  gsl_matrix_free(c.v);
  gsl_vector_free(c.one);
  gsl_vector_free(c.mean);
  free(c.at);
  return status;
}

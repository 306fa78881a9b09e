/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "compensation/springback_state.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/numerics.h"

/* A share of the diagonal that keeps a root real where a state is known. */
static const double root_floor = 1e-12;

static size_t set_state(const fg_state_space *space, size_t set) {
  return FG_STATE_BUMP + space->places + set;
}

static size_t foil_state(const fg_state_space *space, size_t set) {
  return set_state(space, space->sets) + set;
}

static void list_state_rows(const fg_formed_set *sets, fg_formed formed,
                            const fg_springback_fit *fit, fg_state_space *space) {
  for (size_t s = 0; s < space->sets; s++) {
    const fg_formed_data *data = &sets[s].of[formed];
    space->set_foils[s] = fmax(1, (double)sets[s].foils);
    for (size_t k = 0; k < data->places; k++)
      for (size_t place = 0; place < fit->places; place++)
        if (fit->number[place] == data->place[k].number && data->place[k].foils > 0)
          space->row[space->rows++] =
              (fg_state_row){.place = place,
                             .set = s,
                             .log_ratio = data->place[k].log_ratio,
                             .step = log(data->place[k].die) - fit->reference,
                             .foils = data->place[k].foils};
  }
}

fg_status fg_state_begin(fg_context *ctx, const fg_formed_set *sets, size_t count, fg_formed formed,
                         const fg_springback_fit *fit, fg_state_space *space) {
  fg_numerics_start();
  space->places = fit->places;
  space->sets = count;
  space->states = FG_STATE_BUMP + fit->places + 2 * count;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *space->set_foils, (void **)&space->set_foils));
  FG_TRY(fg_memory_allocate(ctx, count * FG_COMPENSATION_BUMPS, sizeof *space->row,
                            (void **)&space->row));
  space->precision = gsl_matrix_calloc(space->states, space->states);
  space->right = gsl_vector_calloc(space->states);
  space->mean = gsl_vector_calloc(space->states);
  if (!space->precision || !space->right || !space->mean)
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the law of springback");
  list_state_rows(sets, formed, fit, space);
  return FG_OK;
}

void fg_state_end(fg_state_space *space) {
  free(space->set_foils);
  free(space->row);
  gsl_matrix_free(space->precision);
  gsl_vector_free(space->right);
  gsl_vector_free(space->mean);
}

static void add_precision(fg_state_space *space, size_t i, size_t k, double value) {
  *gsl_matrix_ptr(space->precision, i, k) += value;
  if (i != k) *gsl_matrix_ptr(space->precision, k, i) += value;
}

/* Adds a state's own prior; returns the logarithm of its variance. */
static double add_prior(fg_state_space *space, size_t state, double mean, double sd) {
  add_precision(space, state, state, 1 / (sd * sd));
  *gsl_vector_ptr(space->right, state) += mean / (sd * sd);
  return 2 * log(sd);
}

/* Prior of all states; returns the logarithm of its covariance's determinant. A drift is a chain:
 * each set differs from the one before it. */
static double add_priors(fg_state_space *space, const fg_springback_sizes *sizes) {
  const fg_state_prior *prior = &space->prior;
  double sum = add_prior(space, FG_STATE_COMMON, 0, prior->mean_sd) +
               add_prior(space, FG_STATE_EXPONENT, prior->exponent, prior->exponent_sd);
  for (size_t i = 0; i < space->places; i++)
    sum += add_prior(space, FG_STATE_BUMP + i, 0, sizes->bump);
  for (size_t s = 0; s < space->sets; s++) {
    size_t at = set_state(space, s);
    sum += add_prior(space, foil_state(space, s), 0, sizes->foil / sqrt(space->set_foils[s])) +
           add_prior(space, at, 0, sizes->set);
    if (!sizes->drift || s == 0) continue;
    add_precision(space, at - 1, at - 1, 1 / (sizes->set * sizes->set));
    add_precision(space, at, at - 1, -1 / (sizes->set * sizes->set));
  }
  return sum;
}

/* Adds the places' means; returns -2 ln of their density at states of 0, without constants. */
static double add_state_rows(fg_state_space *space, const fg_springback_sizes *sizes) {
  double sum = 0;
  for (size_t i = 0; i < space->rows; i++) {
    const fg_state_row *row = &space->row[i];
    double weight = row->foils / (sizes->rest * sizes->rest);
    const size_t state[] = {FG_STATE_COMMON, FG_STATE_EXPONENT, FG_STATE_BUMP + row->place,
                            set_state(space, row->set), foil_state(space, row->set)};
    const double slope[] = {1, row->step, 1, 1, 1};
    enum { TERMS = sizeof state / sizeof *state };
    for (size_t a = 0; a < TERMS; a++) {
      *gsl_vector_ptr(space->right, state[a]) += weight * slope[a] * row->log_ratio;
      for (size_t b = 0; b <= a; b++)
        add_precision(space, state[a], state[b], weight * slope[a] * slope[b]);
    }
    sum += weight * row->log_ratio * row->log_ratio - log(weight);
  }
  return sum;
}

/* Leaves the Cholesky factor of the precision and the mean of the states; *evidence is the
 * logarithm of the marginal likelihood. */
static fg_status solve_states(fg_context *ctx, fg_state_space *space,
                              const fg_springback_sizes *sizes, double *evidence) {
  gsl_matrix_set_zero(space->precision);
  gsl_vector_set_zero(space->right);
  double prior = add_priors(space, sizes), determinant = 0, fitted;
  double constant = space->prior.exponent / space->prior.exponent_sd;
  double data = add_state_rows(space, sizes) + constant * constant;
  if (gsl_linalg_cholesky_decomp1(space->precision) != 0 ||
      gsl_linalg_cholesky_solve(space->precision, space->right, space->mean) != 0 ||
      gsl_blas_ddot(space->right, space->mean, &fitted) != 0)
    return fg_fail(ctx, FG_ERR_DATA, "the law of springback cannot be solved from these lots");
  for (size_t i = 0; i < space->states; i++)
    determinant += 2 * log(gsl_matrix_get(space->precision, i, i));
  *evidence = -0.5 * (data + prior + determinant - fitted);
  return FG_OK;
}

fg_status fg_state_evidence(fg_context *ctx, fg_state_space *space,
                            const fg_springback_sizes *sizes, double *evidence) {
  return solve_states(ctx, space, sizes, evidence);
}

/* Lower root of a covariance, in place; the upper triangle becomes 0. */
static fg_status find_root(fg_context *ctx, double *covariance, size_t states) {
  gsl_matrix_view view = gsl_matrix_view_array(covariance, states, states);
  for (size_t i = 0; i < states; i++)
    covariance[i * states + i] *= 1 + root_floor;
  if (gsl_linalg_cholesky_decomp1(&view.matrix) != 0)
    return fg_fail(ctx, FG_ERR_DATA, "the law of springback cannot be solved from these lots");
  for (size_t i = 0; i < states; i++)
    for (size_t k = i + 1; k < states; k++)
      covariance[i * states + k] = 0;
  return FG_OK;
}

/* The next set goes on from the last one where sets drift; else it is a set by itself. */
fg_status fg_state_posterior(fg_context *ctx, fg_state_space *space,
                             const fg_springback_sizes *sizes, double *mean, double *root) {
  double unused;
  size_t own = FG_STATE_BUMP + space->places, states = own + 1;
  size_t last = set_state(space, space->sets - 1);
  FG_TRY(solve_states(ctx, space, sizes, &unused));
  if (gsl_linalg_cholesky_invert(space->precision) != 0)
    return fg_fail(ctx, FG_ERR_DATA, "the law of springback cannot be solved from these lots");
  for (size_t i = 0; i < states; i++) {
    size_t from = i < own ? i : last;
    bool known = i < own || sizes->drift;
    mean[i] = known ? gsl_vector_get(space->mean, from) : 0;
    for (size_t k = 0; k < states; k++) {
      bool both = known && (k < own || sizes->drift);
      root[i * states + k] = both ? gsl_matrix_get(space->precision, from, k < own ? k : last) : 0;
    }
  }
  root[own * states + own] += sizes->set * sizes->set;
  return find_root(ctx, root, states);
}

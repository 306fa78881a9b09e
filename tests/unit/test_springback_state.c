/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The law of springback at given sizes against the dense covariance of the places' means, and the
 * next die of a law without scatter. */
#include "compensation/springback_state.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>

#include "support/test.h"

enum { PLACES = 3, SETS = 3, ROWS = PLACES * SETS };

static const double reference_mm = 3.32, mean_sd = 0.1, exponent = 0.05, exponent_sd = 0.06;

static fg_formed_set sets[SETS];

/* Sets whose die, foils and means differ by place and set; bump 2 is missing in the first. */
static size_t make_sets(void) {
  size_t rows = 0;
  for (size_t s = 0; s < SETS; s++) {
    fg_formed_data *data = &sets[s].of[FG_FORMED_RADIUS];
    *data = (fg_formed_data){.places = 0};
    sets[s].foils = 5 + 3 * s;
    for (size_t p = 0; p < PLACES; p++) {
      if (s == 0 && p == 1) continue;
      double die = reference_mm * (1 - 0.02 * (double)s + 0.003 * (double)p);
      data->place[data->places++] =
          (fg_formed_place){.number = (int)p + 1,
                            .foils = (double)(5 + 3 * s) - (double)p,
                            .die = die,
                            .log_ratio = 0.05 + 0.004 * (double)(p * p) - 0.003 * (double)(s * p)};
      rows++;
    }
  }
  return rows;
}

/* Covariance of two means, and of a mean with the next set's (set SETS, foils 0). */
static double covariance(const fg_springback_sizes *z, const fg_state_row *a,
                         const fg_state_row *b) {
  bool same_set = a->set == b->set, same = same_set && a->place == b->place;
  double sets_shared = z->drift ? (double)(a->set < b->set ? a->set : b->set) + 1 : same_set;
  double sum = mean_sd * mean_sd + a->step * b->step * exponent_sd * exponent_sd;
  if (a->place == b->place) sum += z->bump * z->bump;
  sum += sets_shared * z->set * z->set;
  if (same_set && a->set < SETS) sum += z->foil * z->foil / (double)sets[a->set].foils;
  if (same && a->set < SETS) sum += z->rest * z->rest / a->foils;
  return sum;
}

typedef struct dense {
  double matrix[ROWS * ROWS], solved[ROWS], log_density;
  size_t rows;
} dense;

static void solve_dense(const fg_state_space *space, const fg_springback_sizes *sizes, dense *d) {
  double right[ROWS];
  d->rows = space->rows;
  for (size_t i = 0; i < d->rows; i++) {
    right[i] = space->row[i].log_ratio - exponent * space->row[i].step;
    for (size_t k = 0; k < d->rows; k++)
      d->matrix[i * d->rows + k] = covariance(sizes, &space->row[i], &space->row[k]);
  }
  gsl_matrix_view matrix = gsl_matrix_view_array(d->matrix, d->rows, d->rows);
  gsl_vector_view y = gsl_vector_view_array(right, d->rows),
                  x = gsl_vector_view_array(d->solved, d->rows);
  assert_int_equal(gsl_linalg_cholesky_decomp1(&matrix.matrix), 0);
  assert_int_equal(gsl_linalg_cholesky_solve(&matrix.matrix, &y.vector, &x.vector), 0);
  d->log_density = 0;
  for (size_t i = 0; i < d->rows; i++)
    d->log_density -=
        0.5 * right[i] * d->solved[i] + log(d->matrix[i * d->rows + i]); /* ln of the root */
}

/* Mean and variance of the next set at a place, by conditioning. */
static void predict_dense(const fg_state_space *space, const fg_springback_sizes *sizes, dense *d,
                          const fg_state_row *next, double *mean, double *variance) {
  double cross[ROWS], solved[ROWS];
  *mean = exponent * next->step;
  *variance = covariance(sizes, next, next);
  for (size_t i = 0; i < d->rows; i++) {
    cross[i] = covariance(sizes, &space->row[i], next);
    *mean += cross[i] * d->solved[i];
  }
  gsl_matrix_view matrix = gsl_matrix_view_array(d->matrix, d->rows, d->rows);
  gsl_vector_view y = gsl_vector_view_array(cross, d->rows),
                  x = gsl_vector_view_array(solved, d->rows);
  assert_int_equal(gsl_linalg_cholesky_solve(&matrix.matrix, &y.vector, &x.vector), 0);
  for (size_t i = 0; i < d->rows; i++)
    *variance -= cross[i] * solved[i];
}

static void check_prediction(fg_state_space *space, const fg_springback_sizes *sizes, dense *d,
                             size_t place, double step) {
  enum { STATES = PLACES + 3 };
  fg_context ctx;
  double mean[STATES], root[STATES * STATES], expected, variance, got = 0, got_variance = 0;
  const fg_state_row next = {.place = place, .set = SETS, .step = step};
  double gradient[STATES] = {1, step};
  gradient[FG_STATE_BUMP + place] = gradient[STATES - 1] = 1;
  predict_dense(space, sizes, d, &next, &expected, &variance);
  assert_ok(&ctx, fg_state_posterior(&ctx, space, sizes, mean, root));
  for (size_t i = 0; i < STATES; i++)
    got += gradient[i] * mean[i];
  for (size_t column = 0; column < STATES; column++) {
    double part = 0;
    for (size_t row = column; row < STATES; row++)
      part += gradient[row] * root[row * STATES + column];
    got_variance += part * part;
  }
  assert_near(got, expected, 1e-9);
  assert_near(got_variance / variance, 1, 1e-6);
}

static void the_states_are_the_dense_model(void **state) {
  (void)state;
  static const fg_springback_sizes sizes[] = {
      {.rest = 0.01, .foil = 0.004, .bump = 0.006, .set = 0.003, .drift = false},
      {.rest = 0.01, .foil = 0.004, .bump = 0.006, .set = 0.003, .drift = true},
      {.rest = 0.002, .foil = 0.02, .bump = 0.0005, .set = 0.01, .drift = true},
  };
  const fg_springback_fit fit = {
      .places = PLACES, .number = {1, 2, 3}, .reference = log(reference_mm)};
  fg_state_space space = {.prior = {mean_sd, exponent, exponent_sd}};
  fg_context ctx;
  dense first, other;
  double evidence, base;
  size_t rows = make_sets();
  assert_ok(&ctx, fg_state_begin(&ctx, sets, SETS, FG_FORMED_RADIUS, &fit, &space));
  assert_int_equal(space.rows, rows);
  solve_dense(&space, &sizes[0], &first);
  assert_ok(&ctx, fg_state_evidence(&ctx, &space, &sizes[0], &base));
  assert_near(base, first.log_density, 1e-6);
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    solve_dense(&space, &sizes[i], &other);
    assert_ok(&ctx, fg_state_evidence(&ctx, &space, &sizes[i], &evidence));
    assert_near(evidence, other.log_density, 1e-6);
    for (size_t place = 0; place < PLACES; place++)
      check_prediction(&space, &sizes[i], &other, place, -0.05);
  }
  fg_state_end(&space);
}

/* Many foils that hardly scatter, of three dies: the law is theirs, and its die lands on the
 * target. */
static void a_law_without_scatter_is_turned_round(void **state) {
  (void)state;
  static const double springback = 0.06, slope = 0.08;
  fg_springback_fit fit;
  fg_context ctx;
  int numbers[] = {1, 2};
  for (size_t s = 0; s < SETS; s++) {
    fg_formed_data *data = &sets[s].of[FG_FORMED_RADIUS];
    sets[s].foils = 1000;
    *data = (fg_formed_data){.places = 2,
                             .level_squares = 1e-9,
                             .level_dof = 999,
                             .rest_squares = 1e-9,
                             .rest_dof = 999};
    for (size_t p = 0; p < 2; p++) {
      double step = -0.04 * (double)s;
      data->place[p] = (fg_formed_place){.number = (int)p + 1,
                                         .foils = 1000,
                                         .die = reference_mm * exp(step),
                                         .log_ratio = springback + slope * step + 0.01 * (double)p};
    }
  }
  const fg_springback_data found_from = {FG_FORMED_RADIUS, sets, SETS, numbers, 2, reference_mm};
  assert_ok(&ctx, fg_springback_find(&ctx, &found_from, &fit));
  for (size_t p = 0; p < 2; p++) {
    double exact = log(reference_mm) - (springback + 0.01 * (double)p) / (1 + slope);
    assert_near(fg_springback_invert(&fit, p), exact, 1e-4);
    assert_near(fg_springback_mean(&fit, p, exact) + exact, log(reference_mm), 1e-4);
    assert_true(fg_springback_u(&fit, p, exact, true) > fg_springback_u(&fit, p, exact, false));
  }
  fg_springback_fit_free(&fit);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_states_are_the_dense_model),
      cmocka_unit_test(a_law_without_scatter_is_turned_round),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The score of a set: its residual in a fit beside everything at once, against a dense least
 * squares of the same rows; and sets that are right or invalid. */
#include <gsl/gsl_multifit.h>
#include <math.h>
#include <stdlib.h>

#include "effect_search/policy.h"
#include "effect_search/search.h"
#include "support/foil_rows.h"
#include "support/test.h"

#define NOISE_UM 0.03

enum {
  SHEAR,
  RIPPLE,
  NEAR_RIPPLE,
  FAR_RIPPLE,
  OVAL,
  RADIAL_OVAL,
  STEP,
  START,
  LONG_START,
  CANDIDATES
};

/* Effects in the rows: a shear and a ripple. */
static const double shear_um = 6, ripple_um[2] = {0.8, -0.5};

typedef struct candidate {
  const char *id;
  bool second;
  double shape;
} candidate;

static const candidate candidates[CANDIDATES] = {
    [SHEAR] = {"scan.shear", false, 0},
    [RIPPLE] = {"scan.carriage_ripple", false, 3.1},
    [NEAR_RIPPLE] = {"scan.carriage_ripple", false, 3.2},
    [FAR_RIPPLE] = {"scan.carriage_ripple", false, 4.4},
    [OVAL] = {"part.ovality", false, 0},
    [RADIAL_OVAL] = {"part.ovality", true, 0},
    [STEP] = {"scan.row_step", false, 5},
    [START] = {"scan.carriage_start", false, 2},
    [LONG_START] = {"scan.carriage_start", false, 6},
};

static const fg_effect *kind_of(size_t e) {
  const fg_effect *kind = fg_effect_find(candidates[e].id);
  assert_non_null(kind);
  return candidates[e].second ? fg_effect_next(kind) : kind;
}

typedef struct fixture {
  foil_rows f;
  fg_explanations out;
  fg_search s;
  fg_search_baseline y;
} fixture;

static void open_search(fixture *t) {
  fg_context ctx = {0};
  foil_rows_open(&t->f);
  foil_rows_put_noise(&t->f, NOISE_UM);
  foil_rows_add_effect(&t->f, kind_of(SHEAR), &candidates[SHEAR].shape, &shear_um, 1);
  foil_rows_add_effect(&t->f, kind_of(RIPPLE), &candidates[RIPPLE].shape, ripple_um, 2);
  t->out = (fg_explanations){0};
  t->s = (fg_search){.policy = fg_search_policy_of(&t->f.edge_fit), .out = &t->out};
  assert_ok(&ctx, fg_search_columns_open(&ctx, &t->f.edge_fit, t->f.residual_um, t->f.jacobian,
                                         &t->s.columns));
  for (size_t e = 0; e < CANDIDATES; e++)
    fg_search_add(&t->s, &(fg_candidate){.kind = kind_of(e), .shape = {candidates[e].shape}});
  fg_search_noise(&t->s, false);
  t->y = fg_search_find_baseline(&t->s);
}

static void close_search(fixture *t) {
  fg_search_columns_close(&t->s.columns);
  foil_rows_close(&t->f);
}

typedef struct dense {
  double sum, last_u; /* residual sum; sd of the last coefficient for noise of 1 um */
  size_t unknowns;
} dense;

static size_t count_unknowns(const fixture *t, unsigned mask) {
  size_t n = t->f.edge_fit.parameters;
  for (size_t e = 0; e < CANDIDATES; e++)
    if (mask >> e & 1) n += kind_of(e)->columns ? kind_of(e)->columns : 2;
  return n;
}

/* Geometry and the effects of a mask at once; `last` stands behind the others, with its first
 * column alone (CANDIDATES: there is none). */
static dense solve_densely(fixture *t, unsigned mask, size_t last) {
  const fg_edge_fit *edge_fit = &t->f.edge_fit;
  size_t rows = edge_fit->row_count, geometry = edge_fit->parameters, at = geometry;
  dense d = {.unknowns = count_unknowns(t, mask) + (last < CANDIDATES)};
  gsl_matrix *design = gsl_matrix_alloc(rows, d.unknowns);
  gsl_matrix *covariance = gsl_matrix_alloc(d.unknowns, d.unknowns);
  gsl_vector *y = gsl_vector_alloc(rows), *weight = gsl_vector_alloc(rows);
  gsl_vector *x = gsl_vector_alloc(d.unknowns);
  for (size_t i = 0; i < rows; i++) {
    gsl_vector_set(y, i, t->f.residual_um[i]);
    gsl_vector_set(weight, i, edge_fit->rows[i].weight / FG_EDGE_FIT_BLOCK);
    for (size_t k = 0; k < geometry; k++)
      gsl_matrix_set(design, i, k, t->f.jacobian[k * rows + i]);
  }
  for (size_t k = 0; k <= CANDIDATES; k++) {
    size_t e = k < CANDIDATES ? k : last;
    if (e == CANDIDATES || (k < CANDIDATES && !(mask >> e & 1))) continue;
    size_t count = fg_effect_columns(edge_fit, kind_of(e), &candidates[e].shape, t->f.columns);
    for (size_t c = 0; c < (k < CANDIDATES ? count : 1); c++, at++)
      for (size_t i = 0; i < rows; i++)
        gsl_matrix_set(design, i, at, t->f.columns[c * rows + i]);
  }
  assert_int_equal(at, d.unknowns);
  gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(rows, d.unknowns);
  assert_int_equal(gsl_multifit_wlinear(design, weight, y, x, covariance, &d.sum, work), 0);
  d.last_u = sqrt(gsl_matrix_get(covariance, d.unknowns - 1, d.unknowns - 1));
  gsl_multifit_linear_free(work);
  gsl_matrix_free(design);
  gsl_matrix_free(covariance);
  gsl_vector_free(y);
  gsl_vector_free(weight);
  gsl_vector_free(x);
  return d;
}

static unsigned bit(size_t e) {
  return 1u << e;
}

static void residuals_of_a_set_agree_with_dense_least_squares(void **state) {
  (void)state;
  static const unsigned masks[] = {0, 1u << SHEAR, 1u << SHEAR | 1u << RIPPLE, 1u << OVAL,
                                   1u << STEP | 1u << FAR_RIPPLE | 1u << RADIAL_OVAL};
  fixture t;
  open_search(&t);
  dense all = solve_densely(&t, (1u << CANDIDATES) - 1, CANDIDATES);
  double rows = (double)t.f.edge_fit.row_count;
  double noise = sqrt(all.sum / (rows - (double)all.unknowns));
  assert_near(t.out.noise_um, noise, 1e-9);
  assert_near(noise, NOISE_UM, 0.1 * NOISE_UM);
  assert_true(t.out.integral >= 1 && t.out.integral < 1.5); /* of white noise */
  for (size_t k = 0; k < sizeof masks / sizeof *masks; k++) {
    in_row("masks[%zu]", k);
    dense own = solve_densely(&t, masks[k], CANDIDATES);
    fg_explanation got = fg_search_try(&t.s, &t.y, masks[k]);
    double excess = (own.sum - all.sum) / (noise * noise * t.out.integral);
    assert_near(got.excess, excess, 1e-8 * excess);
    assert_near(got.dof, (double)(all.unknowns - own.unknowns), 0);
  }
  close_search(&t);
}

static void amplitude_u_agrees_with_dense_least_squares(void **state) {
  (void)state;
  fixture t;
  open_search(&t);
  unsigned others = bit(RIPPLE) | bit(OVAL);
  assert_near(fg_search_amplitude_u(&t.s, others, SHEAR) / solve_densely(&t, others, SHEAR).last_u,
              1, 1e-7);
  assert_near(fg_search_amplitude_u(&t.s, bit(SHEAR), FAR_RIPPLE) /
                  solve_densely(&t, bit(SHEAR), FAR_RIPPLE).last_u,
              1, 1e-7);
  close_search(&t);
}

static void only_sets_that_hold_the_true_effects_are_right(void **state) {
  (void)state;
  static const struct {
    unsigned mask;
    bool right;
  } sets[] = {
      {0, false},
      {1u << SHEAR, false},
      {1u << RIPPLE, false},
      {1u << SHEAR | 1u << RIPPLE, true},
      {1u << SHEAR | 1u << NEAR_RIPPLE, false},
      {1u << RIPPLE | 1u << STEP, false},
      {1u << SHEAR | 1u << RIPPLE | 1u << STEP, true},
  };
  fixture t;
  open_search(&t);
  for (size_t k = 0; k < sizeof sets / sizeof *sets; k++) {
    in_row("sets[%zu]", k);
    fg_explanation got = fg_search_try(&t.s, &t.y, sets[k].mask);
    if (fg_search_is_right(&t.s, &t.y, &got) != sets[k].right)
      fail_msg("set %#x is %sright", sets[k].mask, sets[k].right ? "not " : "");
  }
  close_search(&t);
}

/* Chi² of 10 exceeds 29.588 by chance once in 1000 (Abramowitz and Stegun, table 26.8). */
static void sets_within_chance_are_right(void **state) {
  (void)state;
  fixture t;
  open_search(&t);
  const fg_search_baseline exact = {.dof = 10, .unit = 1};
  for (int side = -1; side <= 1; side += 2) {
    fg_explanation leaves = {.dof = 10, .excess = 29.588 + 0.001 * side};
    assert_int_equal(fg_search_is_right(&t.s, &exact, &leaves), side < 0);
  }
  close_search(&t);
}

static void two_directions_of_one_effect_are_collinear(void **state) {
  (void)state;
  fixture t;
  open_search(&t);
  assert_true(fg_search_has_collinear(&t.out, bit(OVAL) | bit(RADIAL_OVAL)));
  assert_true(fg_search_has_collinear(&t.out, bit(START) | bit(LONG_START)));
  assert_true(fg_search_has_collinear(&t.out, bit(RIPPLE) | bit(NEAR_RIPPLE) | bit(SHEAR)));
  assert_false(fg_search_has_collinear(&t.out, bit(RIPPLE) | bit(FAR_RIPPLE)));
  assert_false(fg_search_has_collinear(&t.out, bit(SHEAR) | bit(RIPPLE) | bit(OVAL) | bit(STEP)));
  close_search(&t);
}

/* The search finds the middle of a polynomial with its set, from powers that all of them share. */
static void the_middle_of_a_polynomial_is_found(void **state) {
  (void)state;
  static const char *const ids[] = {"scan.carriage_quadratic", "scan.optical_cubic"};
  for (size_t k = 0; k < 2; k++) {
    fg_context ctx = {0};
    foil_rows f;
    fg_explanations out;
    const fg_effect *kind = fg_effect_find(ids[k]);
    const double amplitude_um = 30;
    foil_rows_open(&f);
    const double middle_mm = f.edge_fit.frame.centre_mm[kind->axis] + 6.5;
    foil_rows_put_noise(&f, NOISE_UM / 10);
    foil_rows_add_effect(&f, kind, &middle_mm, &amplitude_um, 1);
    const fg_search_request request = {.policy = fg_search_policy_of(&f.edge_fit),
                                       .residual_um = f.residual_um,
                                       .jacobian = f.jacobian};
    assert_ok(&ctx, fg_search_find(&ctx, &f.edge_fit, &request, &out));
    assert_true(out.right);
    size_t e = 0;
    while (e < out.candidate_count && out.candidates[e].kind != kind)
      e++;
    assert_int_equal(out.each[0].mask, bit(e));
    assert_near(out.each[0].middle_mm[e], middle_mm, 0.05);
    foil_rows_close(&f);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(residuals_of_a_set_agree_with_dense_least_squares),
      cmocka_unit_test(amplitude_u_agrees_with_dense_least_squares),
      cmocka_unit_test(only_sets_that_hold_the_true_effects_are_right),
      cmocka_unit_test(sets_within_chance_are_right),
      cmocka_unit_test(two_directions_of_one_effect_are_collinear),
      cmocka_unit_test(the_middle_of_a_polynomial_is_found),
  };
  return cmocka_run_group_tests_name("score of a set", tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* P-values over kinds that share an error rate: uniform under the null, beyond the number of draws
 * too, whatever the number of candidates of a kind. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>
#include <gsl/gsl_cdf.h>

#include "core/splitmix.h"
#include "table_loop/family.h"

/* Candidates of each kind, and how much they share with a common pattern. */
static const size_t members[FG_LOOP_KINDS] = {4, 6, 40, 30, 3, 0, 200};

static void draw_maxima(uint64_t *seed, double shared, double max[FG_LOOP_KINDS]) {
  double common = fg_splitmix_normal(seed), own = sqrt(1 - shared * shared);
  for (size_t k = 0; k < FG_LOOP_KINDS; k++) {
    max[k] = -INFINITY;
    for (size_t c = 0; c < members[k]; c++)
      max[k] = fmax(max[k], shared * common + own * fg_splitmix_normal(seed));
  }
}

static void fit(fg_context *ctx, size_t draws, double shared, uint64_t seed,
                fg_engine_family *family) {
  double *maxima = malloc(draws * FG_LOOP_KINDS * sizeof *maxima);
  assert_non_null(maxima);
  fg_loop_kind_shares((const bool[FG_LOOP_KINDS]){false}, family->share);
  for (size_t b = 0; b < draws; b++)
    draw_maxima(&seed, shared, maxima + b * FG_LOOP_KINDS);
  assert_int_equal(fg_engine_family_fit(ctx, draws, maxima, family), FG_OK);
  free(maxima);
}

static double smallest_p(const fg_engine_family *family, const double max[FG_LOOP_KINDS]) {
  double p = 1;
  for (size_t k = 0; k < FG_LOOP_KINDS; k++)
    p = fmin(p, fg_engine_family_p(family, (fg_loop_kind)k, max[k]));
  return p;
}

/* Share of clean data whose smallest p-value is below a level; single rows keep their own share. */
static void p_values_are_uniform(void **state) {
  enum { FAMILIES = 40, TABLES = 500 };
  static const double level[] = {0.005, 0.01, 0.05, 0.1};
  fg_context ctx = {0};
  (void)state;
  for (int correlated = 0; correlated < 2; correlated++) {
    size_t below[4] = {0};
    uint64_t seed = 77;
    for (uint64_t f = 0; f < FAMILIES; f++) {
      fg_engine_family family = {0};
      fit(&ctx, 799, correlated ? 0.5 : 0, 1000 + f, &family);
      for (size_t t = 0; t < TABLES; t++) {
        double max[FG_LOOP_KINDS];
        draw_maxima(&seed, correlated ? 0.5 : 0, max);
        double p = smallest_p(&family, max);
        for (size_t l = 0; l < 4; l++)
          below[l] += p < level[l];
      }
      fg_engine_family_free(&family);
    }
    for (size_t l = 0; l < 4; l++) {
      double share = (double)below[l] / (FAMILIES * TABLES) / 0.8; /* 0.2 of it are single rows' */
      printf("%d %g %g\n", correlated, level[l], share / level[l]);
    }
  }
}

/* Far beyond the draws: four candidates with the share of recorded columns. */
static void p_values_hold_beyond_the_draws(void **state) {
  fg_context ctx = {0};
  fg_engine_family family = {0};
  (void)state;
  fit(&ctx, 1999, 0, 5, &family);
  double exact = 4 * gsl_cdf_ugaussian_Q(6.0);
  double p = fg_engine_family_kind_p(&family, FG_LOOP_KIND_COLUMNS, 6.0);
  assert_true(p > exact / 4 && p < exact * 4);
  double z = fg_engine_family_critical(&family, FG_LOOP_KIND_COLUMNS, 1e-4);
  assert_true(fabs(fg_engine_family_p(&family, FG_LOOP_KIND_COLUMNS, z) - 1e-4) < 1e-7);
  fg_engine_family_free(&family);
}

/* The exchanges' number costs the columns nothing; an expected kind gets half of the rate. */
static void shares_follow_the_kind(void **state) {
  bool expected[FG_LOOP_KINDS] = {false};
  double share[FG_LOOP_KINDS], moved[FG_LOOP_KINDS], sum = 0;
  (void)state;
  fg_loop_kind_shares(expected, share);
  for (size_t k = 0; k < FG_LOOP_KINDS; k++)
    sum += share[k];
  assert_true(fabs(sum - 1) < 1e-12);
  expected[FG_LOOP_KIND_SCATTER] = true;
  fg_loop_kind_shares(expected, moved);
  assert_true(fabs(moved[FG_LOOP_KIND_SCATTER] - 0.5 - share[FG_LOOP_KIND_SCATTER] / 2) < 1e-12);
  assert_true(fabs(moved[FG_LOOP_KIND_COLUMNS] - share[FG_LOOP_KIND_COLUMNS] / 2) < 1e-12);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(p_values_are_uniform),
      cmocka_unit_test(p_values_hold_beyond_the_draws),
      cmocka_unit_test(shares_follow_the_kind),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values over the bumps' numbers: some stand apart, some follow a cycle, and of scatter alone
 * neither is told; with and without noise that is known from elsewhere. On a foil, what the error
 * of the edge's model may do is no deviation. */
#include <math.h>

#include "core/splitmix.h"
#include "effect/midline.h"
#include "scan_loop/bump_pattern.h"
#include "scan_loop/state.h"
#include "support/foil_rows.h"
#include "support/test.h"

static fg_bump_values scatter(size_t n, double noise_dof, uint64_t *seed) {
  fg_bump_values at = {.n = n, .noise_dof = noise_dof};
  for (size_t k = 0; k < n; k++) {
    at.number[k] = (double)k + 1;
    at.value[k] = fg_splitmix_normal(seed);
  }
  for (double f = 0; f < noise_dof; f++)
    at.noise_square += pow(fg_splitmix_normal(seed), 2);
  return at;
}

/* Noise that is known tells a bump of seven standard deviations, and three of five. */
static void known_noise_tells_few(void **state) {
  (void)state;
  for (uint64_t seed = 1; seed <= 10; seed++) {
    uint64_t draw = 100 * seed;
    double p_value;
    fg_bump_values at = scatter(9, 32, &draw);
    at.value[seed % 9] -= 9;
    fg_bump_pattern found = fg_bump_pattern_find(&at, seed, &p_value);
    assert_true(p_value < FG_BUMP_PATTERN_P && found.by < 0 && found.apart[seed % 9]);
    at = scatter(9, 32, &draw);
    for (size_t k = 2; k < 9; k += 3)
      at.value[k] += 6;
    found = fg_bump_pattern_find(&at, seed, &p_value);
    assert_true(p_value < FG_BUMP_PATTERN_P);
    double apart = fg_bump_pattern_at(&found, &at, 5) - fg_bump_pattern_at(&found, &at, 4);
    assert_true(apart > 3);
  }
}

/* Two of six that lie far off are told, though draws alone cannot resolve so small a chance. */
static void two_of_six_are_told(void **state) {
  (void)state;
  uint64_t draw = 3;
  double p_value;
  fg_bump_values at = scatter(6, 0, &draw);
  at.value[1] -= 60;
  at.value[5] -= 60;
  fg_bump_pattern found = fg_bump_pattern_find(&at, 1, &p_value);
  assert_true(found.count == 2 && found.apart[1] && found.apart[5]);
  assert_true(p_value < FG_BUMP_PATTERN_P / 10);
}

/* P-values of scatter: as many below a tenth as there should be, or fewer (of two forms both). */
static void scatter_is_not_told(void **state) {
  (void)state;
  const double dof[] = {0, 32};
  enum { DRAWS = 60 };
  for (size_t f = 0; f < 2; f++) {
    size_t tenth = 0;
    double min = 1;
    for (uint64_t seed = 1; seed <= DRAWS; seed++) {
      uint64_t draw = 7777 * seed;
      double p_value;
      fg_bump_values at = scatter(6 + seed % 6, dof[f], &draw);
      fg_bump_pattern_find(&at, seed, &p_value);
      tenth += p_value < 0.1;
      min = fmin(min, p_value);
    }
    assert_true(tenth <= 14); /* of 6: 1 in 1000 by chance */
    assert_true(min > FG_BUMP_PATTERN_P);
  }
}

/* Returns true when bump 5, raised by so much at its middle on nearly perfect edges, is told beside
 * an error of the edge's model, and a margin, ln, over it. */
static bool is_raised_bump_told(double raised_um, double error_um, double margin) {
  fg_context ctx = {0};
  foil_rows f;
  foil_rows_open(&f);
  foil_rows_put_noise(&f, 0.003);
  for (size_t i = 0; i < f.edge_fit.row_count; i++) {
    double legendre[2];
    if (f.edge_fit.rows[i].bump != 5) continue;
    fg_midline_legendre(&f.edge_fit.rows[i], 3, 1, 2, legendre);
    f.residual_um[i] += raised_um * legendre[1];
  }
  struct fg_scan_loop loop = {.edge_fit = f.edge_fit,
                              .residual_after = f.residual_um,
                              .edge_error_um = error_um,
                              .margin = margin};
  const fg_effect *curve = fg_effect_find("free.bump.index");
  loop.explanations = (fg_explanations){.right = true, .count = 1, .candidate_count = 1};
  loop.explanations.candidates[0] = (fg_candidate){.kind = curve, .columns = FG_FIELD_COLUMNS};
  assert_ok(&ctx, fg_scan_loop_find_single_bumps(&ctx, &loop));
  f.edge_fit = loop.edge_fit;
  foil_rows_close(&f);
  return loop.set.count == 1 && loop.set.effects[0].kind == curve;
}

/* However plain it stands out of the noise; the margin grows with the whole evidence. */
static void error_of_the_edge_model_is_no_bump(void **state) {
  (void)state;
  assert_true(is_raised_bump_told(0.06, 0, 0)); /* evidence did not decide: no error is known */
  assert_false(is_raised_bump_told(0.06, 0.02, 5));
  assert_true(is_raised_bump_told(0.2, 0.02, 5));
  assert_false(is_raised_bump_told(0.2, 0.02, 300));
  assert_true(is_raised_bump_told(2, 0.02, 300));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(known_noise_tells_few),
      cmocka_unit_test(two_of_six_are_told),
      cmocka_unit_test(scatter_is_not_told),
      cmocka_unit_test(error_of_the_edge_model_is_no_bump),
  };
  return cmocka_run_group_tests_name("single bumps", tests, NULL, NULL);
}

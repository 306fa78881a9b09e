/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups against each other: their spread against closed forms and draws of known spread. */
#include "stats/between_groups.h"

#include <math.h>

#include "core/numerics.h"
#include "support/random.h"
#include "support/test.h"

enum { GROUPS = 8, LOTS = 6, DRAWS = 4000 };

/* With equal variances v Paule and Mandel's tau² is the variance of the means less v. */
static void equal_variances_have_a_closed_form(void **state) {
  (void)state;
  const fg_group_mean groups[] = {{1, 0.5}, {2, 0.5}, {4, 0.5}, {7, 0.5}};
  fg_between between = fg_between_groups(groups, 4, 0.95);
  const double variance = (6.25 + 2.25 + 0.25 + 12.25) / 3;
  assert_near(between.centre, 3.5, 1e-9);
  assert_near(between.sd * between.sd, variance - 0.5, 1e-9);
  assert_near(between.u_centre, sqrt(variance / 4), 1e-9);
  /* Its interval: 3 variance / (tau² + 0.5) at the quantiles of chi² with 3 degrees of freedom. */
  assert_near(between.sd_low * between.sd_low, 3 * variance / 9.348403604 - 0.5, 1e-6);
  assert_near(between.sd_high * between.sd_high, 3 * variance / 0.215795283 - 0.5, 1e-6);
}

static void means_that_agree_have_no_spread(void **state) {
  (void)state;
  const fg_group_mean groups[] = {{1.0, 4}, {1.1, 4}, {0.9, 1}};
  fg_between between = fg_between_groups(groups, 3, 0.95);
  assert_true(between.sd == 0);
  assert_near(between.centre, (1.0 / 4 + 1.1 / 4 + 0.9) / 1.5, 1e-12);
  assert_true(isnan(fg_between_groups(groups, 1, 0.95).sd));
  assert_true(isnan(fg_between_reach(&between, 1, 0, 0.95)));
}

static void without_scatter_within_groups_only_their_means_scatter(void **state) {
  (void)state;
  const fg_group_mean groups[] = {{3, 0}, {5, 0}, {7, 0}}, same[] = {{3, 0}, {3, 0}};
  assert_near(fg_between_groups(groups, 3, 0.95).sd, 2, 1e-9);
  assert_true(fg_between_groups(same, 2, 0.95).sd == 0);
  assert_near(fg_between_groups(same, 2, 0.95).centre, 3, 1e-12);
}

/* Coverage for groups of different sizes: the interval holds the true spread, and a further group
 * lies outside its limits, as often as promised. */
static void intervals_keep_their_promise(void **state) {
  (void)state;
  static const double truth[] = {0.5, 2};
  uint64_t seed = 11;
  for (int c = 0; c < 2; c++) {
    int held = 0, outside = 0;
    for (int draw = 0; draw < DRAWS; draw++) {
      fg_group_mean groups[GROUPS + 1];
      for (int i = 0; i <= GROUPS; i++) {
        groups[i].variance = 1.0 / (1 + i % 4);
        groups[i].mean = 10 + truth[c] * random_gaussian(&seed) +
                         sqrt(groups[i].variance) * random_gaussian(&seed);
      }
      fg_between between = fg_between_groups(groups, GROUPS, 0.95);
      held += between.sd_low <= truth[c] && truth[c] <= between.sd_high;
      double reach = fg_between_reach(&between, GROUPS, groups[GROUPS].variance, 0.99);
      outside += fabs(groups[GROUPS].mean - between.centre) > reach;
    }
    assert_in_range(held, DRAWS * 935 / 1000, DRAWS * 965 / 1000);
    /* Student's t makes the limits too wide, never too narrow, where little of the spread is
     * estimated. */
    assert_in_range(outside, c ? DRAWS * 4 / 1000 : 0, DRAWS * 15 / 1000);
  }
}

/* 4 × 0.01; 3 × 0.02 = 0.06; 2 × 0.03 stays at 0.06; 0.2. A NaN is in no family. */
static void holm_adjusts_step_by_step(void **state) {
  (void)state;
  const double p[] = {0.03, NAN, 0.01, 0.2, 0.02};
  double adjusted[5];
  assert_ok(&test_context, fg_holm_adjust(&test_context, p, 5, adjusted));
  assert_near(adjusted[2], 0.04, 1e-12);
  assert_near(adjusted[4], 0.06, 1e-12);
  assert_near(adjusted[0], 0.06, 1e-12);
  assert_near(adjusted[3], 0.2, 1e-12);
  assert_true(isnan(adjusted[1]));
  const double large[] = {0.6, 0.7};
  assert_ok(&test_context, fg_holm_adjust(&test_context, large, 2, adjusted));
  assert_true(adjusted[0] == 1 && adjusted[1] == 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(equal_variances_have_a_closed_form),
      cmocka_unit_test(means_that_agree_have_no_spread),
      cmocka_unit_test(without_scatter_within_groups_only_their_means_scatter),
      cmocka_unit_test(intervals_keep_their_promise),
      cmocka_unit_test(holm_adjusts_step_by_step),
  };
  fg_numerics_start();
  return cmocka_run_group_tests(tests, NULL, NULL);
}

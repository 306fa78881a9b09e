/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exchanged rows against one heavy tail of all rows, by likelihood. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "core/splitmix.h"
#include "table_loop/tails.h"

enum { ROWS = 126 };
static const double log_pairs = 8.97; /* ROWS (ROWS - 1) / 2 */
/* Log ratio from which an exchange is claimed: p = 0.01 with a quarter of the rate. */
static const double claimed_from = 5.99;

/* Student's t of that many dof; 0: normal. */
static double draw(int dof, uint64_t *seed) {
  double normal = fg_splitmix_normal(seed), squares = 0;
  for (int k = 0; k < dof; k++)
    squares += pow(fg_splitmix_normal(seed), 2);
  return dof ? normal / sqrt(squares / dof) : normal;
}

/* Moves two rows apart by `size`, as an exchange of two responses does; `size` 0 takes the two rows
 * of either sign that lie farthest out as if they fitted well in each other's places. */
static double ratio_of(int dof, double size, uint64_t seed) {
  double before[ROWS], after[ROWS];
  size_t low = 0, high = 0;
  for (size_t i = 0; i < ROWS; i++) {
    before[i] = after[i] = draw(dof, &seed);
    if (before[i] < before[low]) low = i;
    if (before[i] > before[high]) high = i;
  }
  if (size > 0) {
    before[3] += size;
    before[40] -= size;
  } else {
    after[low] = after[high] = 0;
  }
  return fg_engine_exchanged_over_tail(ROWS, before, after) - log_pairs;
}

static void an_exchange_is_likelier_than_a_tail(void **state) {
  enum { TABLES = 100 };
  size_t claimed = 0;
  (void)state;
  for (uint64_t seed = 0; seed < TABLES; seed++)
    claimed += ratio_of(0, 10, seed) > claimed_from;
  assert_true(claimed >= 80);
}

/* Heavy tails have such rows: even if the two farthest ones fitted each other's places in every
 * table, no more than 1 in 50 would be claimed. */
static void a_tail_is_no_exchange(void **state) {
  enum { TABLES = 400 };
  (void)state;
  for (int dof = 3; dof <= 6; dof++) {
    size_t claimed = 0;
    for (uint64_t seed = 0; seed < TABLES; seed++)
      claimed += ratio_of(dof, 0, 1000 + seed) > claimed_from;
    assert_true(claimed <= TABLES / 50);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_exchange_is_likelier_than_a_tail),
      cmocka_unit_test(a_tail_is_no_exchange),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

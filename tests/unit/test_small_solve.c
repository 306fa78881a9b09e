/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Normal equations that are added up in registers are those that are added up one by one. */
#include <string.h>

#include "core/small_solve.h"
#include "support/random.h"
#include "support/test.h"

enum { ROWS = 77 };

static void draw_rows(uint64_t seed, size_t unknowns, fg_normal_row rows[ROWS]) {
  memset(rows, 0, ROWS * sizeof *rows);
  for (size_t k = 0; k < ROWS; k++) {
    for (size_t i = 0; i < unknowns; i++)
      rows[k].values[i] = random_gaussian(&seed);
    rows[k].right = random_gaussian(&seed);
    rows[k].weight = random_uniform(&seed);
  }
}

static void rows_add_up_as_one_by_one(void **state) {
  (void)state;
  for (size_t unknowns = 1; unknowns <= FG_NORMAL_ROW_VALUES; unknowns++) {
    fg_normal_row rows[ROWS];
    fg_normal_equations each, all;
    draw_rows(unknowns, unknowns, rows);
    fg_normal_clear(&each, unknowns);
    fg_normal_clear(&all, unknowns);
    for (size_t k = 0; k < ROWS; k++)
      fg_normal_add(&each, rows[k].values, rows[k].right, rows[k].weight);
    fg_normal_add_rows(&all, rows, 5);
    fg_normal_add_rows(&all, rows + 5, 0);
    fg_normal_add_rows(&all, rows + 5, ROWS - 5);
    assert_memory_equal(&each.sum_squares, &all.sum_squares, sizeof each.sum_squares);
    assert_memory_equal(each.right, all.right, unknowns * sizeof *each.right);
    for (size_t i = 0; i < unknowns; i++)
      assert_memory_equal(each.matrix[i], all.matrix[i], (i + 1) * sizeof *each.matrix[i]);
  }
}

static void nine_unknowns_are_found(void **state) {
  (void)state;
  enum { UNKNOWNS = 9 };
  fg_normal_row rows[ROWS];
  fg_normal_equations system;
  double x[FG_SMALL_MAX];
  draw_rows(3, UNKNOWNS, rows);
  for (size_t k = 0; k < ROWS; k++) {
    rows[k].right = 0;
    for (size_t i = 0; i < UNKNOWNS; i++)
      rows[k].right += rows[k].values[i] * (double)(i + 1);
  }
  fg_normal_clear(&system, UNKNOWNS);
  fg_normal_add_rows(&system, rows, ROWS);
  assert_true(fg_normal_solve(&system, 0, x, NULL));
  for (size_t i = 0; i < UNKNOWNS; i++)
    assert_true(fabs(x[i] - (double)(i + 1)) < 1e-9);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(rows_add_up_as_one_by_one),
                                     cmocka_unit_test(nine_unknowns_are_found)};
  return cmocka_run_group_tests_name("small_solve", tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The carriage's random part, which strips of a scan share and other scans of the pose do not, from
 * residuals with a known one. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "grid_loop/solve.h"
#include "support/random.h"
#include "support/test.h"

enum { SIDE = 60, SCANS = 3, ROWS = 2 * SCANS * SIDE * SIDE };
#define PITCH_MM 2.0
#define MARK_MM  0.0005

/* A board of SIDE × SIDE marks in every scan, along x and along y; `carriage_mm` differs from strip
 * to strip and scan to scan, `common_mm` from strip to strip alone. */
static double find_carriage_of(const int turns[SCANS], double carriage_mm, double common_mm) {
  grid_problem problem = {.scan_count = SCANS, .board_count = 1, .model = {.mark_sd = MARK_MM}};
  grid_solution solution = {.residual = malloc(ROWS * sizeof(double))};
  uint64_t random = 7;
  double common[SIDE];
  problem.rows = calloc(ROWS, sizeof *problem.rows);
  problem.board[0].pitch_mm = PITCH_MM;
  memcpy(problem.turns, turns, SCANS * sizeof *turns);
  for (int j = 0; j < SIDE; j++)
    common[j] = common_mm * random_gaussian(&random);
  for (size_t scan = 0; scan < SCANS; scan++)
    for (int j = 0; j < SIDE; j++) {
      double moved = carriage_mm * random_gaussian(&random);
      for (int i = 0; i < SIDE; i++)
        for (int along = 0; along < 2; along++) {
          size_t at = problem.row_count++;
          problem.rows[at] = (grid_row){.scan = scan,
                                        .at = {i * PITCH_MM, (j + 0.5) * PITCH_MM},
                                        .direction = {along ? 0 : 1, along ? -1 : 0},
                                        .used = true};
          solution.residual[at] = MARK_MM * random_gaussian(&random);
          if (along) solution.residual[at] -= moved + common[j];
        }
    }
  double um = fg_grid_find_carriage(&problem, &solution);
  free(problem.rows);
  free(solution.residual);
  return um;
}

static void scatter_of_a_carriage_is_found_with_its_size(void **state) {
  static const int turns[SCANS] = {0, 0, 0};
  (void)state;
  /* 120 degrees of freedom: 3 sd of a standard deviation are 19 % */
  assert_near(find_carriage_of(turns, 0.004, 0), 4, 0.19 * 4);
}

static void two_scans_of_one_pose_tell_the_scatter(void **state) {
  static const int turns[SCANS] = {1, 0, 1};
  (void)state;
  assert_near(find_carriage_of(turns, 0.004, 0), 4, 0.27 * 4);
}

static void errors_that_every_scan_repeats_are_no_scatter(void **state) {
  static const int turns[SCANS] = {0, 0, 0};
  (void)state;
  assert_near(find_carriage_of(turns, 0.004, 0.05), 4, 0.19 * 4);
}

static void noise_of_marks_is_no_scatter_of_the_carriage(void **state) {
  static const int turns[SCANS] = {0, 0, 0};
  (void)state;
  assert_true(find_carriage_of(turns, 0, 0) < 0.04);
}

static void without_a_repeated_pose_the_scatter_is_unknown(void **state) {
  static const int turns[SCANS] = {0, 1, 2};
  (void)state;
  assert_true(isnan(find_carriage_of(turns, 0.004, 0)));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(scatter_of_a_carriage_is_found_with_its_size),
      cmocka_unit_test(two_scans_of_one_pose_tell_the_scatter),
      cmocka_unit_test(errors_that_every_scan_repeats_are_no_scatter),
      cmocka_unit_test(noise_of_marks_is_no_scatter_of_the_carriage),
      cmocka_unit_test(without_a_repeated_pose_the_scatter_is_unknown),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

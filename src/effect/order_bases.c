/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bases over an order: of runs in time, of bumps from the lip. */
#include <math.h>

#include "effect/bases.h"

bool fg_basis_accepts_drift(const fg_loop_problem *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  (void)b;
  return fg_basis_is_number(at) && fg_basis_is_sequence(at) && at->distinct >= 4;
}

bool fg_basis_accepts_transient(const fg_loop_problem *problem, size_t a, size_t b) {
  return fg_basis_accepts_drift(problem, a, b) && problem->coordinate[a].roles & FG_LOOP_ORDER;
}

bool fg_basis_accepts_lip(const fg_loop_problem *problem, size_t a, size_t b) {
  return fg_basis_accepts_drift(problem, a, b) && problem->coordinate[a].roles & FG_LOOP_BUMP;
}

/* From 1 at the first to nearly 0: half its range is half its height. */
void fg_basis_decay(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                    const double *shape, double *columns) {
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  for (size_t i = 0; i < problem->rows; i++)
    columns[i] = 2 * exp(-(at->value[i] - at->low) / shape[0]) - 1;
}

size_t fg_basis_transient_starts(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                                 double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  static const double share[] = {0.05, 0.1, 0.2, 0.4};
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  for (size_t i = 0; i < 4; i++)
    starts[i][0] = share[i] * (at->high - at->low);
  return 4;
}

size_t fg_basis_lip_starts(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                           double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  static const double bumps[] = {0.6, 1.2, 2.4, 4};
  (void)problem, (void)candidate;
  for (size_t i = 0; i < 4; i++)
    starts[i][0] = bumps[i];
  return 4;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect/bases.h"

bool fg_basis_is_number(const fg_loop_coordinate *at) {
  return at->levels == 0 && !(at->roles & (FG_LOOP_SENSITIVITY | FG_LOOP_LEVEL)) &&
         at->distinct >= 2;
}

bool fg_basis_is_sequence(const fg_loop_coordinate *at) {
  return (at->roles & (FG_LOOP_ORDER | FG_LOOP_BUMP)) != 0;
}

size_t fg_basis_level_count(const fg_loop_coordinate *at) {
  return at->levels ? at->levels : at->distinct;
}

const fg_loop_coordinate *fg_basis_first(const fg_loop_problem *problem,
                                         const fg_loop_candidate *candidate) {
  return &problem->coordinate[candidate->a];
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers that some values stand apart by, or that follow a cycle: of bumps, by their number. */
#ifndef FG_SCAN_LOOP_BUMP_PATTERN_H
#define FG_SCAN_LOOP_BUMP_PATTERN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/loop.h"

enum { FG_BUMP_PATTERN_MIN = 6, FG_BUMP_PATTERN_MAX = 64 };

/* Probability over everything that is tried below which a deviation of single bumps is told. A foil
 * without any must not be given one: a fifth of what the listed effects may take. */
#define FG_BUMP_PATTERN_P (0.2 * FG_LOOP_ACCEPT_P)

/* One value for every number, ascending. `noise_square`: of further values of `noise_dof`
 * degrees of freedom that scatter alike; 0: none are known. */
typedef struct fg_bump_values {
  size_t n;
  double number[FG_BUMP_PATTERN_MAX], value[FG_BUMP_PATTERN_MAX];
  double noise_square, noise_dof;
} fg_bump_values;

/* What explains the values: some that stand apart by `by`, or a cycle (period > 0). `gain`: its sum
 * of squares over what it leaves, each per degree of freedom. */
typedef struct fg_bump_pattern {
  double gain, by, period, cosine, sine;
  bool apart[FG_BUMP_PATTERN_MAX];
  size_t count;
} fg_bump_pattern;

/* The better form, and how often both together do as well in normal scatter: the same search over
 * drawn values, as often. */
fg_bump_pattern fg_bump_pattern_find(const fg_bump_values *at, uint64_t seed, double *p_value);

/* Its value at the k-th number, beside the others'. */
double fg_bump_pattern_at(const fg_bump_pattern *pattern, const fg_bump_values *at, size_t k);

#endif

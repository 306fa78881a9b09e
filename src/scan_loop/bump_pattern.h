/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Patterns over bump numbers: single values that deviate from the others, or a cycle. */
#ifndef FG_SCAN_LOOP_BUMP_PATTERN_H
#define FG_SCAN_LOOP_BUMP_PATTERN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/loop.h"

enum { FG_BUMP_PATTERN_MIN = 6, FG_BUMP_PATTERN_MAX = 64 };

/* Level, over everything that is tried, at which a deviation of single bumps is reported. It is a
 * fifth of the listed effects' level: a foil without such a deviation must not be given one. */
#define FG_BUMP_PATTERN_P (0.2 * FG_LOOP_ACCEPT_P)

/* Values, one per number, ascending. `noise_square`: sum of squares of further values of the same
 * scatter with `noise_dof` dof; 0: none. */
typedef struct fg_bump_values {
  size_t n;
  double number[FG_BUMP_PATTERN_MAX], value[FG_BUMP_PATTERN_MAX];
  double noise_square, noise_dof;
} fg_bump_values;

/* Pattern: values that deviate by `by`, or a cycle (period > 0). `gain`: its sum of squares over
 * the remainder, each per dof. */
typedef struct fg_bump_pattern {
  double gain, by, period, cosine, sine;
  bool apart[FG_BUMP_PATTERN_MAX];
  size_t count;
} fg_bump_pattern;

/* Finds the better pattern. `p_value` is over both patterns, from the same search over normal
 * draws. */
fg_bump_pattern fg_bump_pattern_find(const fg_bump_values *at, uint64_t seed, double *p_value);

/* Returns the pattern's value at the k-th number, beside the others'. */
double fg_bump_pattern_at(const fg_bump_pattern *pattern, const fg_bump_values *at, size_t k);

#endif

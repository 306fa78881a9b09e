/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Seeded noise for tests: the same numbers on every machine. */
#ifndef FG_TESTS_RANDOM_H
#define FG_TESTS_RANDOM_H

#include <math.h>
#include <stdint.h>

static inline double random_uniform(uint64_t *seed) {
  *seed += 0x9e3779b97f4a7c15u; /* splitmix64 */
  uint64_t z = *seed;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  return ((double)(z >> 11) + 0.5) * 0x1p-53;
}

static inline double random_gaussian(uint64_t *seed) {
  double radius = sqrt(-2 * log(random_uniform(seed)));
  return radius * cos(6.28318530717958647692 * random_uniform(seed));
}

#endif

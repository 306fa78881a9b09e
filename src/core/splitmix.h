/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Seeded random numbers, the same on every machine: splitmix64 (Steele, Lea and Flood 2014), whose
 * state is one number. */
#ifndef FG_CORE_SPLITMIX_H
#define FG_CORE_SPLITMIX_H

#include <math.h>
#include <stdint.h>

static inline uint64_t fg_splitmix_next(uint64_t *state) {
  *state += 0x9e3779b97f4a7c15u;
  uint64_t z = *state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/* Above 0 and below 1. */
static inline double fg_splitmix_uniform(uint64_t *state) {
  return ((double)(fg_splitmix_next(state) >> 11) + 0.5) * 0x1p-53;
}

/* Of mean 0 and variance 1 (Box and Muller 1958). */
static inline double fg_splitmix_normal(uint64_t *state) {
  double radius = sqrt(-2 * log(fg_splitmix_uniform(state)));
  return radius * cos(6.28318530717958647692 * fg_splitmix_uniform(state));
}

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/sincos.h"

#include <math.h>
#include <stdint.h>

/* Limit of an angle: the number of quarter turns times a part of pi / 2 of 33 bits is exact. */
#define ANGLE_MAX 1e5
/* pi / 2 in three parts. */
static const double half_pi[3] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2e037073p-69};
/* Beside this number a sum has no room for a fraction: its last bits are a whole number. */
static const double rounding = 6755399441055744.0;
static const double quarter_turns = 2 / M_PI;

/* Taylor's series of sin r / r (first = 1) and cos r (first = 0) in r², up to the last term that
 * counts at pi / 4. */
static inline double series(double square, int first) {
  enum { TERMS = 9 };
  double sum = 1;
#pragma GCC unroll 8
  for (int k = TERMS - 1; k > 0; k--)
    sum = 1 - sum * square * (1.0 / ((2 * k + first - 1) * (2 * k + first)));
  return sum;
}

typedef union number {
  double value;
  uint64_t bits;
} number;

static inline double choose_number(uint64_t where, double yes, double no, uint64_t sign) {
  number a = {yes}, b = {no};
  a.bits = ((a.bits & where) | (b.bits & ~where)) ^ (sign & 2) << 62;
  return a.value;
}

/* Of the angle beside the nearest quarter turn; the quarter says which of both it is, and its sign.
 * The loop has no branch, so that the compiler takes several angles at once. */
__attribute__((target_clones("avx2", "default"))) static void
sincos_in_lanes(size_t count, const double *restrict angle, double *restrict sine,
                double *restrict cosine) {
  for (size_t i = 0; i < count; i++) {
    number turns = {angle[i] * quarter_turns + rounding};
    uint64_t quarter = turns.bits, odd = -(quarter & 1);
    double whole = turns.value - rounding;
    double r = angle[i] - whole * half_pi[0] - whole * half_pi[1] - whole * half_pi[2];
    double s = r * series(r * r, 1), c = series(r * r, 0);
    sine[i] = choose_number(odd, c, s, quarter);
    cosine[i] = choose_number(odd, s, c, quarter + 1);
  }
}

void fg_sincos(size_t count, const double *angle, double *sine, double *cosine) {
  sincos_in_lanes(count, angle, sine, cosine);
  for (size_t i = 0; i < count; i++) {
    if (fabs(angle[i]) <= ANGLE_MAX) continue;
    sine[i] = sin(angle[i]);
    cosine[i] = cos(angle[i]);
  }
}

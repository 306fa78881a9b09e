/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Seeded random numbers: xoshiro256++ (Blackman and Vigna 2019), seeded by splitmix64. */
#ifndef FG_RENDER_RANDOM_H
#define FG_RENDER_RANDOM_H

#include <stddef.h>
#include <stdint.h>

typedef struct fg_random {
  uint64_t state[4];
} fg_random;

/* `stream` and `index` give independent sequences for one seed. */
void fg_random_seed(fg_random *random, uint64_t seed, uint64_t stream, uint64_t index);
double fg_random_uniform(fg_random *random); /* [0, 1) */
double fg_random_normal(fg_random *random);  /* exact, for the few numbers of the geometry */

/* Normal numbers in bulk: the sum of two quantiles, each drawn from 2048 of a normal law of
 * variance 1/2. Variance 1, tails to 4.9 sd, smooth at the resolution of a pixel's value. */
enum { FG_NOISE_QUANTILES = 2048 };
typedef struct fg_noise_table {
  float quantiles[FG_NOISE_QUANTILES];
} fg_noise_table;

void fg_noise_table_fill(fg_noise_table *table);
void fg_noise_draw(const fg_noise_table *table, fg_random *random, float *out, size_t count);

#endif

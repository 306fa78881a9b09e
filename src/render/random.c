/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/random.h"

#include <math.h>

#include <gsl/gsl_cdf.h>

#include "core/splitmix.h"

static uint64_t rotate_left(uint64_t value, int bits) {
  return (value << bits) | (value >> (64 - bits));
}

void fg_random_seed(fg_random *random, uint64_t seed, uint64_t stream, uint64_t index) {
  uint64_t state = seed;
  state = fg_splitmix_next(&state) ^ stream;
  state = fg_splitmix_next(&state) ^ index;
  for (int i = 0; i < 4; i++)
    random->state[i] = fg_splitmix_next(&state);
}

static uint64_t next_bits(fg_random *random) {
  uint64_t *s = random->state;
  uint64_t result = rotate_left(s[0] + s[3], 23) + s[0];
  uint64_t t = s[1] << 17;
  s[2] ^= s[0];
  s[3] ^= s[1];
  s[1] ^= s[2];
  s[0] ^= s[3];
  s[2] ^= t;
  s[3] = rotate_left(s[3], 45);
  return result;
}

double fg_random_uniform(fg_random *random) {
  return (double)(next_bits(random) >> 11) * 0x1p-53;
}

double fg_random_normal(fg_random *random) {
  return gsl_cdf_ugaussian_Pinv(((double)(next_bits(random) >> 12) + 0.5) * 0x1p-52);
}

void fg_noise_table_fill(fg_noise_table *table) {
  double quantiles[FG_NOISE_QUANTILES];
  double sum_of_squares = 0;
  for (int i = 0; i < FG_NOISE_QUANTILES; i++) {
    quantiles[i] = gsl_cdf_ugaussian_Pinv((i + 0.5) / FG_NOISE_QUANTILES);
    sum_of_squares += quantiles[i] * quantiles[i];
  }
  /* Cutting the normal law into quantiles lowers its variance a little; the sum of two is scaled
   * to 1. */
  double scale = sqrt(0.5 * FG_NOISE_QUANTILES / sum_of_squares);
  for (int i = 0; i < FG_NOISE_QUANTILES; i++)
    table->quantiles[i] = (float)(scale * quantiles[i]);
}

void fg_noise_draw(const fg_noise_table *table, fg_random *random, float *out, size_t count) {
  const float *q = table->quantiles;
  const uint64_t mask = FG_NOISE_QUANTILES - 1;
  fg_random local = *random;
  size_t i = 0;
  for (; i + 2 <= count; i += 2) {
    uint64_t bits = next_bits(&local);
    out[i] = q[bits & mask] + q[(bits >> 11) & mask];
    out[i + 1] = q[(bits >> 22) & mask] + q[(bits >> 33) & mask];
  }
  if (i < count) {
    uint64_t bits = next_bits(&local);
    out[i] = q[bits & mask] + q[(bits >> 11) & mask];
  }
  *random = local;
}

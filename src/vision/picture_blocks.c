/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Blocks of 8 × 8 px: a picture that once was a JPEG. */
#include <math.h>

#include "vision/picture.h"

enum { PHASES = 8 };
/* Max distance of a used pixel from its tile's background, as a share of the contrast. */
#define FLAT_SHARE  0.06
#define FLAT_NOISES 3.0
#define RATIO_MAX   9.99
#define RATIO_MIN   0.15
/* Min lead of one phase in sd, on each axis and on both together. The largest of eight chances
 * leads by 2.5 in one of 100 cases, both axes at once by 6 in one of 10 million. Few blocks step
 * where a picture is quite flat, so the limits are no higher. */
#define LEAD_SIGMAS 2.5
#define BOTH_SIGMAS 6.0

typedef struct steps {
  double sum[2][PHASES], squares[2][PHASES], count[2][PHASES];
} steps;

static void add_step(steps *s, int axis, size_t phase, double step) {
  s->sum[axis][phase] += step;
  s->squares[axis][phase] += step * step;
  s->count[axis][phase]++;
}

static void add_tile(const fg_tile *tile, int bytes_per_pixel, double level, double limit,
                     steps *s) {
  for (size_t y = 0; y + 1 < FG_TILE_PX; y++)
    for (size_t x = 0; x + 1 < FG_TILE_PX; x++) {
      size_t at = y * FG_TILE_PX + x;
      double value = fg_tile_count(tile, bytes_per_pixel, at);
      if (fabs(value - level) > limit) continue;
      double right = fg_tile_count(tile, bytes_per_pixel, at + 1);
      double down = fg_tile_count(tile, bytes_per_pixel, at + FG_TILE_PX);
      if (fabs(right - level) <= limit) add_step(s, 0, x % PHASES, fabs(right - value));
      if (fabs(down - level) <= limit) add_step(s, 1, y % PHASES, fabs(down - value));
    }
}

/* The phase of the largest step: its lead over the second in sd, and its mean step over the mean of
 * the others, less 1. */
typedef struct leader {
  double sigmas, ratio;
  size_t phase;
} leader;

static leader find_leader(const steps *s, int axis) {
  double means[PHASES], sum = 0, max = -1, second = -1, u = 0;
  size_t phase = 0;
  for (size_t k = 0; k < PHASES; k++) {
    if (s->count[axis][k] < 100) return (leader){NAN, NAN, 0};
    means[k] = s->sum[axis][k] / s->count[axis][k];
    sum += means[k];
    if (means[k] > max) {
      second = max;
      max = means[k];
      phase = k;
      u = sqrt(s->squares[axis][k]) / s->count[axis][k];
    } else {
      second = fmax(second, means[k]);
    }
  }
  double others = (sum - max) / (PHASES - 1);
  return (leader){.sigmas = u > 0 ? (max - second) / u : 0,
                  .ratio = others > 0 ? fmin(max / others - 1, RATIO_MAX) : RATIO_MAX,
                  .phase = phase};
}

void fg_picture_inspect_blocks(const fg_tile_choice *choice, int bytes_per_pixel, double contrast,
                               fg_picture_state *state) {
  steps s = {0};
  double noise = isnan(state->noise) ? 0 : state->noise;
  for (size_t i = 0; i < choice->count; i++) {
    double level = (double)choice->tiles[i]->blocks[0];
    add_tile(choice->tiles[i], bytes_per_pixel, level,
             fmax(FLAT_SHARE * contrast, FLAT_NOISES * noise), &s);
  }
  leader x = find_leader(&s, 0), y = find_leader(&s, 1);
  const size_t first[2] = {(x.phase + 1) % PHASES, (y.phase + 1) % PHASES};
  bool leads = fmin(x.sigmas, y.sigmas) > LEAD_SIGMAS && hypot(x.sigmas, y.sigmas) > BOTH_SIGMAS;
  state->block_noise = isnan(x.ratio) || isnan(y.ratio) ? NAN : leads ? fmin(x.ratio, y.ratio) : 0;
  if (!(state->block_noise > RATIO_MIN)) return;
  state->findings |= FG_PICTURE_BLOCK_NOISE;
  state->block_quality = fg_picture_jpeg_quality(choice, bytes_per_pixel, first);
}

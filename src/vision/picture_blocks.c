/* Blocks of 8 × 8 px: a picture that once was a JPEG. */
#include <math.h>

#include "vision/picture.h"

enum { PHASES = 8 };
/* Pixels within this share of the contrast of their tile's background are looked at. */
#define FLAT_SHARE   0.06
#define FLAT_NOISES  3.0
#define RATIO_MOST   9.99
#define RATIO_LEAST  0.15
#define RATIO_SIGMAS 6.0

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

/* The mean step of the phase that has the largest, over the mean of the others, less 1; 0 where it
 * is chance, or where other phases have as much. `first`: where blocks begin. */
static double ratio_of(const steps *s, int axis, size_t *first) {
  double means[PHASES], sum = 0, most = -1, second = -1, u = 0;
  for (int k = 0; k < PHASES; k++) {
    if (s->count[axis][k] < 100) return NAN;
    means[k] = s->sum[axis][k] / s->count[axis][k];
    sum += means[k];
    if (means[k] > most) {
      second = most;
      most = means[k];
      *first = (size_t)(k + 1) % PHASES;
      u = sqrt(s->squares[axis][k]) / s->count[axis][k];
    } else {
      second = fmax(second, means[k]);
    }
  }
  double others = (sum - most) / (PHASES - 1);
  if (!(most - second > RATIO_SIGMAS * u)) return 0;
  return others > 0 ? fmin(most / others - 1, RATIO_MOST) : RATIO_MOST;
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
  size_t first[2] = {0, 0};
  double x = ratio_of(&s, 0, &first[0]), y = ratio_of(&s, 1, &first[1]);
  state->block_noise = isnan(x) || isnan(y) ? NAN : fmin(x, y);
  if (!(state->block_noise > RATIO_LEAST)) return;
  state->findings |= FG_PICTURE_BLOCK_NOISE;
  state->block_quality = fg_picture_jpeg_quality(choice, bytes_per_pixel, first);
}

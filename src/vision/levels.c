/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/levels.h"

#include <stdlib.h>

enum {
  COUNTS = FG_LEVEL_COUNTS,
  PIXELS_MIN = 64,  /* min number of pixels of an object */
  LIMIT_MIN = 4,    /* counts: min difference of the foil from the background */
  SAMPLED_ROWS = 4, /* distance of the sampled rows of a tile */
};
/* Limits of a hot pixel's difference from the background: a share of the typical contrast, and
 * standard deviations. The share is that of the segmentation. */
#define HOT_SHARE    0.3
#define HOT_SIGMAS   6.0
#define MAD_TO_SIGMA 1.4826

void fg_levels_count(const fg_tile *tile, int bytes_per_pixel, uint64_t blocks,
                     size_t histogram[COUNTS]) {
  for (size_t y = 0; y < FG_TILE_PX; y += SAMPLED_ROWS)
    for (size_t b = 0; b < FG_BLOCKS_PER_TILE; b++) {
      if (!(blocks >> (y / FG_BLOCK_PX * FG_BLOCKS_PER_TILE + b) & 1)) continue;
      for (size_t x = b * FG_BLOCK_PX; x < (b + 1) * FG_BLOCK_PX; x++)
        histogram[fg_tile_count(tile, bytes_per_pixel, y * FG_TILE_PX + x)]++;
    }
}

static int count_quantile(const size_t *counts, double share) {
  size_t total = 0, below = 0;
  int bin = 0;
  for (int i = 0; i < COUNTS; i++)
    total += counts[i];
  while (bin + 1 < COUNTS && (double)(below + counts[bin]) <= share * (double)total)
    below += counts[bin++];
  return bin;
}

/* Background is the most frequent count. The contrast is the 80th percentile of the counts beyond
 * its noise, on the side with more of them. */
fg_levels fg_levels_find(const size_t histogram[COUNTS]) {
  size_t off[COUNTS] = {0}, beyond[2][COUNTS] = {{0}}, number[2] = {0};
  double sum[2] = {0};
  int background = count_quantile(histogram, 0.5);
  for (int i = 0; i < COUNTS; i++)
    off[abs(i - background)] += histogram[i];
  double sigma = MAD_TO_SIGMA * count_quantile(off, 0.5);
  int noise = (int)fmax(LIMIT_MIN, ceil(HOT_SIGMAS * sigma));
  for (int i = 0; i < COUNTS; i++) {
    int excess = abs(i - background), light = i > background;
    if (excess <= noise) continue;
    sum[light] += (double)excess * (double)histogram[i];
    number[light] += histogram[i];
    beyond[light][excess] = histogram[i];
  }
  bool light = sum[1] >= sum[0];
  int excess = (int)fmax(noise, round(HOT_SHARE * count_quantile(beyond[light], 0.8)));
  return (fg_levels){.light = light,
                     .limit = light ? background + excess : background - excess,
                     .found = number[light] >= PIXELS_MIN};
}

fg_levels fg_levels_of_island(const fg_tiles *tiles, const fg_island *island) {
  size_t histogram[COUNTS] = {0};
  for (size_t i = 0; i < island->count; i++) {
    int32_t at = island->tiles[i];
    const fg_tile *tile = tiles->tiles[at];
    uint64_t inside = fg_tiles_whole_blocks(tiles, at % tiles->columns, at / tiles->columns);
    if (tile) fg_levels_count(tile, tiles->bytes_per_pixel, inside, histogram);
  }
  return fg_levels_find(histogram);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The count that separates the foil's pixels from the background's, by the pixels alone. */
#ifndef FG_VISION_LEVELS_H
#define FG_VISION_LEVELS_H

#include "vision/islands.h"

enum {
  FG_LEVEL_COUNTS = 256, /* 8-bit counts */
  FG_PIECE_BLOCKS = 8,   /* connected blocks with hot pixels: fewer are dust, no piece of a strip */
};

/* A pixel is hot with a count of at least the limit where the foil is light, of at most the limit
 * where it is dark. The limit is a whole count, so that a few more pixels of background do not
 * change it. */
typedef struct fg_levels {
  int limit;
  bool light;
  bool found; /* enough pixels differ from the background */
} fg_levels;

/* A pixel of a tile in 8-bit counts, rounded down. */
static inline int fg_tile_count(const fg_tile *tile, int bytes_per_pixel, size_t at) {
  if (bytes_per_pixel == 1) return tile->pixels[at];
  return ((const uint16_t *)(const void *)tile->pixels)[at] >> 8;
}

static inline bool fg_levels_is_hot(const fg_levels *levels, int count) {
  return levels->light ? count >= levels->limit : count <= levels->limit;
}

/* Adds the pixels of those blocks of a tile whose bits are set; rows are sampled. */
void fg_levels_count(const fg_tile *tile, int bytes_per_pixel, uint64_t blocks,
                     size_t histogram[FG_LEVEL_COUNTS]);

fg_levels fg_levels_find(const size_t histogram[FG_LEVEL_COUNTS]);

/* Levels of an island's own tiles. */
fg_levels fg_levels_of_island(const fg_tiles *tiles, const fg_island *island);

#endif

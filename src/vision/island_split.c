/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/island_split.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "vision/grid.h"
#include "vision/levels.h"

/* Min blocks around a hot one that belong to its group. Two groups then lie so far apart that the
 * surroundings that fg_anchor_island keeps of one hold nothing of the other. */
enum { REACH_MIN_BLOCKS = 4 };

/* Blocks of an island's box, with the reach around it. */
typedef struct split {
  const fg_tiles *tiles;
  const fg_island *island;
  int32_t reach, width, height;
  uint8_t *hot;    /* holds a hot pixel of a piece, which is no dust */
  uint8_t *near;   /* lies within the reach of a hot block */
  int32_t *labels; /* of the hot blocks: 1 + piece; then of the near blocks: 1 + group */
  fg_blob *groups;
  int32_t group_count;
  fg_island *parts; /* one per group */
} split;

/* Pieces join within 2 reach + 1 blocks of each other: for certain when less than 8 (2 reach + 1)
 * pixels lie between them, never when 7 more do. */
static int32_t find_group_reach(double gap_px) {
  int32_t reach = (int32_t)((gap_px - FG_BLOCK_PX) / (2 * FG_BLOCK_PX));
  return reach > REACH_MIN_BLOCKS ? reach : REACH_MIN_BLOCKS;
}

static fg_status allocate_blocks(fg_context *ctx, split *s) {
  s->width = s->island->width * FG_BLOCKS_PER_TILE + 2 * s->reach;
  s->height = s->island->height * FG_BLOCKS_PER_TILE + 2 * s->reach;
  size_t count = (size_t)s->width * (size_t)s->height;
  FG_TRY(fg_memory_allocate(ctx, count, 1, (void **)&s->hot));
  FG_TRY(fg_memory_allocate(ctx, count, 1, (void **)&s->near));
  return fg_memory_allocate(ctx, count, sizeof *s->labels, (void **)&s->labels);
}

/* Place of a tile's first block. */
static size_t first_block(const split *s, int32_t tile) {
  int32_t column = tile % s->tiles->columns - s->island->x;
  int32_t row = tile / s->tiles->columns - s->island->y;
  return (size_t)(row * FG_BLOCKS_PER_TILE + s->reach) * (size_t)s->width +
         (size_t)(column * FG_BLOCKS_PER_TILE + s->reach);
}

/* Columns of a tile that hold a hot pixel in one row of blocks; `flip` makes dark pixels light.
 */
static inline __attribute__((always_inline)) void
find_hot_columns(const fg_tile *tile, int bytes_per_pixel, size_t first, uint8_t flip,
                 uint8_t limit, uint8_t hot[FG_TILE_PX]) {
  memset(hot, 0, FG_TILE_PX);
  for (size_t y = 0; y < FG_BLOCK_PX; y++)
    for (size_t x = 0; x < FG_TILE_PX; x++) {
      uint8_t count = (uint8_t)fg_tile_count(tile, bytes_per_pixel, first + y * FG_TILE_PX + x);
      hot[x] |= (uint8_t)(count ^ flip) >= limit;
    }
}

static void mark_row(split *s, const fg_levels *l, const fg_tile *tile, size_t row, uint64_t inside,
                     uint8_t *cells) {
  uint8_t hot[FG_TILE_PX], flip = l->light ? 0 : UINT8_MAX, limit = (uint8_t)(l->limit ^ flip);
  size_t first = row * FG_BLOCK_PX * FG_TILE_PX;
  if (s->tiles->bytes_per_pixel == 1)
    find_hot_columns(tile, 1, first, flip, limit, hot);
  else
    find_hot_columns(tile, 2, first, flip, limit, hot);
  for (size_t b = 0; b < FG_BLOCKS_PER_TILE; b++)
    cells[b] = inside >> (row * FG_BLOCKS_PER_TILE + b) & 1 &&
               memcmp(hot + b * FG_BLOCK_PX, (uint8_t[FG_BLOCK_PX]){0}, FG_BLOCK_PX) != 0;
}

static void mark_tile(split *s, const fg_levels *l, int32_t at) {
  const fg_tile *tile = s->tiles->tiles[at];
  uint64_t inside = fg_tiles_whole_blocks(s->tiles, at % s->tiles->columns, at / s->tiles->columns);
  uint8_t *cells = s->hot + first_block(s, at);
  for (size_t row = 0; tile && row < FG_BLOCKS_PER_TILE; row++)
    mark_row(s, l, tile, row, inside, cells + row * (size_t)s->width);
}

static void mark_near(split *s, size_t block) {
  uint8_t *cells = s->near + block - (size_t)s->reach * (size_t)s->width - (size_t)s->reach;
  for (int32_t y = 0; y <= 2 * s->reach; y++, cells += s->width)
    memset(cells, 1, (size_t)(2 * s->reach + 1));
}

/* Marks the surroundings of all pieces, and clears dust: between two foils it does not join them.
 */
static void mark_pieces(split *s, const fg_blob *pieces) {
  size_t count = (size_t)s->width * (size_t)s->height;
  for (size_t i = 0; i < count; i++)
    if (s->labels[i] && pieces[s->labels[i] - 1].area >= FG_PIECE_BLOCKS)
      mark_near(s, i);
    else
      s->hot[i] = 0;
}

static bool holds_two_pieces(const fg_blob *blobs, int32_t count) {
  int pieces = 0;
  for (int32_t i = 0; i < count; i++)
    pieces += blobs[i].area >= FG_PIECE_BLOCKS;
  return pieces > 1;
}

static fg_status find_groups(fg_context *ctx, split *s) {
  fg_levels l = fg_levels_of_island(s->tiles, s->island);
  for (size_t i = 0; l.found && i < s->island->count; i++)
    mark_tile(s, &l, s->island->tiles[i]);
  fg_blob *blobs;
  int32_t count;
  FG_TRY(fg_grid_label(ctx, s->hot, s->width, s->height, s->labels, &blobs, &count));
  bool several = holds_two_pieces(blobs, count);
  if (several) mark_pieces(s, blobs);
  free(blobs);
  if (!several) return FG_OK;
  return fg_grid_label(ctx, s->near, s->width, s->height, s->labels, &s->groups, &s->group_count);
}

/* Returns the group of a hot block on a tile, else of any near one; 0: none. No tile holds hot
 * blocks of two groups, because these lie further apart than a tile is wide. */
static int32_t find_group_on(const split *s, int32_t tile) {
  int32_t found = 0;
  for (size_t y = 0; y < FG_BLOCKS_PER_TILE; y++)
    for (size_t x = 0; x < FG_BLOCKS_PER_TILE; x++) {
      size_t block = first_block(s, tile) + y * (size_t)s->width + x;
      if (s->hot[block]) return s->labels[block];
      if (!found) found = s->labels[block];
    }
  return found;
}

static int32_t distance(int32_t from, int32_t length, int32_t x) {
  return x < from ? from - x : x >= from + length ? x - from - length + 1 : 0;
}

/* Returns the group whose box lies nearest to a tile, which holds dust alone. */
static int32_t find_group_beside(const split *s, int32_t tile) {
  int32_t best = 0, best_distance = INT32_MAX;
  int32_t x = (int32_t)(first_block(s, tile) % (size_t)s->width);
  int32_t y = (int32_t)(first_block(s, tile) / (size_t)s->width);
  for (int32_t i = 0; i < s->group_count; i++) {
    const fg_blob *g = &s->groups[i];
    int32_t away = distance(g->x, g->width, x) + distance(g->y, g->height, y);
    if (away >= best_distance) continue;
    best = i + 1;
    best_distance = away;
  }
  return best;
}

static fg_status share_tiles(fg_context *ctx, split *s) {
  int32_t columns = s->tiles->columns;
  FG_TRY(fg_memory_allocate(ctx, (size_t)s->group_count, sizeof *s->parts, (void **)&s->parts));
  for (size_t i = 0; i < s->island->count; i++) {
    int32_t tile = s->island->tiles[i], group = find_group_on(s, tile);
    if (!group) group = find_group_beside(s, tile);
    FG_TRY(fg_island_append(ctx, &s->parts[group - 1], columns, tile % columns, tile / columns));
  }
  return FG_OK;
}

static bool is_dust(const split *s, const fg_blob *group, double min_px) {
  return hypot(group->width - 2 * s->reach, group->height - 2 * s->reach) * FG_BLOCK_PX < min_px;
}

/* Makes the list of the parts that are no dust. */
static fg_status list_parts(fg_context *ctx, split *s, double min_px, fg_island_list *out) {
  FG_TRY(share_tiles(ctx, s));
  FG_TRY(fg_memory_allocate(ctx, (size_t)s->group_count, sizeof *out->list, (void **)&out->list));
  for (int32_t i = 0; i < s->group_count; i++) {
    if (is_dust(s, &s->groups[i], min_px)) continue;
    out->list[out->count++] = s->parts[i];
    s->parts[i] = (fg_island){0};
  }
  out->specks = out->count ? (size_t)s->group_count - out->count : 0;
  return FG_OK;
}

static void free_split(split *s) {
  for (int32_t i = 0; s->parts && i < s->group_count; i++)
    fg_island_free(&s->parts[i]);
  free(s->parts);
  free(s->groups);
  free(s->labels);
  free(s->near);
  free(s->hot);
}

fg_status fg_island_split(fg_context *ctx, const fg_tiles *tiles, const fg_island *island,
                          const fg_island_split_options *options, fg_island_list *parts) {
  split s = {.tiles = tiles, .island = island, .reach = find_group_reach(options->gap_px)};
  fg_status status = FG_OK;
  *parts = (fg_island_list){0};
  FG_TRY_EXIT(allocate_blocks(ctx, &s));
  FG_TRY_EXIT(find_groups(ctx, &s));
  if (s.group_count > 1) FG_TRY_EXIT(list_parts(ctx, &s, options->min_px, parts));
exit:
  free_split(&s);
  return status;
}

void fg_island_list_free(fg_island_list *parts) {
  for (size_t i = 0; i < parts->count; i++)
    fg_island_free(&parts->list[i]);
  free(parts->list);
  *parts = (fg_island_list){0};
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/anchor.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "vision/grid.h"
#include "vision/levels.h"
#include "vision/sheet.h"

enum {
  BLOCKS = FG_BLOCKS_PER_TILE * FG_BLOCKS_PER_TILE,
  MARGIN_TILES = 4, /* tiles around the kept parts: the view's border is not the scan's */
  /* Blocks around a hot one that are kept. The scan keeps a tile around each that it wants, so that
     64 pixels around every one of a wanted tile are available; a strip's corner may reach some
     pixels into a tile that is not wanted. */
  REACH_BLOCKS = 6,
  ROUNDS_MAX = 6,
};
typedef struct hot_block {
  int32_t x, y;
} hot_block;

typedef struct work {
  const fg_tiles *tiles;
  const fg_island *island;
  const fg_anchor_options *options;
  uint8_t *own; /* of each of `tiles`: it belongs to the island */
  int64_t corner_px[2];
  fg_sheet sheet;
  int32_t width, height; /* of the sheet, in blocks */
  uint8_t *hot, *near;   /* of each block: holds a hot pixel; lies around one of a kept part */
  hot_block *blocks;     /* the hot ones, tile by tile */
  size_t block_count, block_capacity;
  int32_t *labels; /* of the hot blocks */
  fg_blob *parts;
  bool *kept; /* of each part */
  int32_t part_count;
} work;

/* The leftmost and the uppermost hot pixel of one tile, where they are beyond those known. */
static void reach_out(const fg_tile *tile, int bytes_per_pixel, const fg_levels *l,
                      const int64_t first_px[2], int64_t low_px[2]) {
  if (first_px[0] >= low_px[0] && first_px[1] >= low_px[1]) return;
  for (int64_t y = 0; y < FG_TILE_PX; y++)
    for (int64_t x = 0; x < FG_TILE_PX; x++) {
      if (first_px[0] + x >= low_px[0] && first_px[1] + y >= low_px[1]) continue;
      if (!fg_levels_is_hot(l, fg_tile_count(tile, bytes_per_pixel, (size_t)(y * FG_TILE_PX + x))))
        continue;
      low_px[0] = first_px[0] + x < low_px[0] ? first_px[0] + x : low_px[0];
      low_px[1] = first_px[1] + y < low_px[1] ? first_px[1] + y : low_px[1];
    }
}

/* First guess of the corner: the island's outermost hot pixels, dust included. */
static void guess_corner(const work *w, const fg_levels *l, int64_t low_px[2]) {
  low_px[0] = w->tiles->width_px - 1;
  low_px[1] = w->tiles->height_px - 1;
  for (size_t i = 0; i < w->island->count; i++) {
    const fg_tile *tile = w->tiles->tiles[w->island->tiles[i]];
    const int64_t first_px[2] = {(int64_t)(w->island->tiles[i] % w->tiles->columns) * FG_TILE_PX,
                                 (int64_t)(w->island->tiles[i] / w->tiles->columns) * FG_TILE_PX};
    if (tile) reach_out(tile, w->tiles->bytes_per_pixel, l, first_px, low_px);
  }
}

static void free_sheet(work *w) {
  fg_sheet_free(&w->sheet);
  free(w->hot);
  free(w->near);
  free(w->labels);
  w->hot = w->near = NULL;
  w->labels = NULL;
}

/* Cuts the sheet up to the island's end, with the margin that hot pixels need. */
static fg_status cut_sheet(fg_context *ctx, work *w, const int64_t low_px[2]) {
  fg_sheet_place place;
  int32_t size[2];
  const int32_t end[2] = {w->island->x + w->island->width, w->island->y + w->island->height};
  free_sheet(w);
  for (int k = 0; k < 2; k++) {
    w->corner_px[k] = low_px[k] - MARGIN_TILES * FG_TILE_PX;
    int64_t length_px = (int64_t)end[k] * FG_TILE_PX - low_px[k];
    size[k] = (int32_t)(length_px / FG_TILE_PX) + 2 + 2 * MARGIN_TILES;
  }
  place = (fg_sheet_place){{w->corner_px[0], w->corner_px[1]}, size[0], size[1]};
  FG_TRY(fg_sheet_cut(ctx, w->tiles, &place, w->options->threads, &w->sheet));
  w->width = size[0] * FG_BLOCKS_PER_TILE;
  w->height = size[1] * FG_BLOCKS_PER_TILE;
  size_t count = (size_t)w->width * (size_t)w->height;
  FG_TRY(fg_memory_allocate(ctx, count, 1, (void **)&w->hot));
  FG_TRY(fg_memory_allocate(ctx, count, 1, (void **)&w->near));
  return fg_memory_allocate(ctx, count, sizeof *w->labels, (void **)&w->labels);
}

static size_t block_at(const work *w, int32_t x, int32_t y) {
  return (size_t)y * (size_t)w->width + (size_t)x;
}

/* Returns the tile that a block of the sheet lies on, and the block's first pixel in it. */
static const fg_tile *tile_of(const work *w, int32_t x, int32_t y, size_t *first) {
  *first = (size_t)(y % FG_BLOCKS_PER_TILE * FG_BLOCK_PX * FG_TILE_PX +
                    x % FG_BLOCKS_PER_TILE * FG_BLOCK_PX);
  return fg_tiles_at(&w->sheet.tiles, x / FG_BLOCKS_PER_TILE, y / FG_BLOCKS_PER_TILE);
}

static bool is_hot_block(const fg_levels *l, fg_range range) {
  return fg_levels_is_hot(l, l->light ? range.high : range.low);
}

static fg_status mark_tile(fg_context *ctx, work *w, const fg_levels *l, int32_t column,
                           int32_t row) {
  size_t at = (size_t)row * (size_t)w->sheet.tiles.columns + (size_t)column;
  for (int b = 0; b < BLOCKS; b++) {
    if (!(w->sheet.whole[at] >> b & 1)) continue;
    if (!is_hot_block(l, w->sheet.ranges[at * BLOCKS + (size_t)b])) continue;
    hot_block block = {column * FG_BLOCKS_PER_TILE + b % FG_BLOCKS_PER_TILE,
                       row * FG_BLOCKS_PER_TILE + b / FG_BLOCKS_PER_TILE};
    FG_TRY(fg_memory_reserve(ctx, w->block_count + 1, sizeof block, &w->block_capacity,
                             (void **)&w->blocks));
    w->blocks[w->block_count++] = block;
    w->hot[block_at(w, block.x, block.y)] = 1;
  }
  return FG_OK;
}

static fg_status mark_hot(fg_context *ctx, work *w, const fg_levels *l) {
  memset(w->hot, 0, (size_t)w->width * (size_t)w->height);
  w->block_count = 0;
  for (int32_t row = 0; row < w->sheet.tiles.rows; row++)
    for (int32_t column = 0; column < w->sheet.tiles.columns; column++)
      if (fg_tiles_at(&w->sheet.tiles, column, row)) FG_TRY(mark_tile(ctx, w, l, column, row));
  return FG_OK;
}

/* Returns true when a block's middle lies on a tile of the island; any other block is another
 * island's. */
static bool is_own(const work *w, int32_t x, int32_t y) {
  int64_t px = w->corner_px[0] + (int64_t)x * FG_BLOCK_PX + FG_BLOCK_PX / 2;
  int64_t py = w->corner_px[1] + (int64_t)y * FG_BLOCK_PX + FG_BLOCK_PX / 2;
  if (px < 0 || py < 0 || px >= w->tiles->width_px || py >= w->tiles->height_px) return false;
  return w->own[(size_t)(py / FG_TILE_PX) * (size_t)w->tiles->columns + (size_t)(px / FG_TILE_PX)];
}

static fg_status find_parts(fg_context *ctx, work *w, size_t *specks, bool *large) {
  free(w->parts);
  free(w->kept);
  w->parts = NULL;
  w->kept = NULL;
  FG_TRY(fg_grid_label(ctx, w->hot, w->width, w->height, w->labels, &w->parts, &w->part_count));
  FG_TRY(fg_memory_allocate(ctx, (size_t)w->part_count, sizeof *w->kept, (void **)&w->kept));
  for (size_t i = 0; i < w->block_count; i++) {
    const hot_block *b = &w->blocks[i];
    bool *kept = &w->kept[w->labels[block_at(w, b->x, b->y)] - 1];
    if (!*kept) *kept = is_own(w, b->x, b->y);
  }
  *specks = 0;
  *large = false;
  for (int32_t i = 0; i < w->part_count; i++) {
    const fg_blob *part = &w->parts[i];
    bool piece = part->area >= FG_PIECE_BLOCKS;
    *specks += w->kept[i] && !piece;
    w->kept[i] = w->kept[i] && piece;
    *large |= w->kept[i] &&
              hypot((double)part->width, (double)part->height) * FG_BLOCK_PX >= w->options->min_px;
  }
  return FG_OK;
}

static bool is_kept(const work *w, int32_t x, int32_t y) {
  int32_t label = w->labels[block_at(w, x, y)];
  return label && w->kept[label - 1];
}

/* Marks the surroundings of the kept parts. False: they reach beyond the sheet. */
static bool mark_near(work *w) {
  memset(w->near, 0, (size_t)w->width * (size_t)w->height);
  for (size_t i = 0; i < w->block_count; i++) {
    int32_t x = w->blocks[i].x, y = w->blocks[i].y;
    if (!is_kept(w, x, y)) continue;
    if (x < REACH_BLOCKS || y < REACH_BLOCKS || x + REACH_BLOCKS >= w->width ||
        y + REACH_BLOCKS >= w->height)
      return false;
    for (int32_t v = y - REACH_BLOCKS; v <= y + REACH_BLOCKS; v++)
      memset(w->near + block_at(w, x - REACH_BLOCKS, v), 1, 2 * REACH_BLOCKS + 1);
  }
  return true;
}

/* The leftmost and the uppermost hot pixel of the kept parts. */
static void find_low(const work *w, const fg_levels *l, int64_t low_px[2]) {
  size_t first;
  low_px[0] = w->sheet.tiles.width_px;
  low_px[1] = w->sheet.tiles.height_px;
  for (size_t i = 0; i < w->block_count; i++) {
    int32_t x = w->blocks[i].x, y = w->blocks[i].y;
    const int64_t first_px[2] = {(int64_t)x * FG_BLOCK_PX, (int64_t)y * FG_BLOCK_PX};
    if ((first_px[0] >= low_px[0] && first_px[1] >= low_px[1]) || !is_kept(w, x, y)) continue;
    const fg_tile *tile = tile_of(w, x, y, &first);
    for (int64_t k = 0; k < FG_BLOCK_PX * FG_BLOCK_PX; k++) {
      int64_t px = k % FG_BLOCK_PX, py = k / FG_BLOCK_PX;
      size_t at = first + (size_t)(py * FG_TILE_PX + px);
      if (!fg_levels_is_hot(l, fg_tile_count(tile, w->tiles->bytes_per_pixel, at))) continue;
      low_px[0] = first_px[0] + px < low_px[0] ? first_px[0] + px : low_px[0];
      low_px[1] = first_px[1] + py < low_px[1] ? first_px[1] + py : low_px[1];
    }
  }
  for (int k = 0; k < 2; k++)
    low_px[k] += w->corner_px[k];
}

/* Bits of a tile's blocks in a mask of blocks, which is 0 or 1 everywhere. */
static uint64_t bits_of(const work *w, const uint8_t *mask, int32_t column, int32_t row) {
  static const uint8_t none[FG_BLOCKS_PER_TILE];
  uint64_t bits = 0;
  for (int y = 0; y < FG_BLOCKS_PER_TILE; y++) {
    const uint8_t *cells =
        mask + block_at(w, column * FG_BLOCKS_PER_TILE, row * FG_BLOCKS_PER_TILE + y);
    if (!memcmp(cells, none, sizeof none)) continue;
    for (int x = 0; x < FG_BLOCKS_PER_TILE; x++)
      bits |= (uint64_t)cells[x] << (y * FG_BLOCKS_PER_TILE + x);
  }
  return bits;
}

/* Finds the levels of the near blocks; false when some of them are not available. */
static bool find_near_levels(const work *w, fg_levels *l) {
  size_t histogram[FG_LEVEL_COUNTS] = {0};
  for (int32_t row = 0; row < w->sheet.tiles.rows; row++)
    for (int32_t column = 0; column < w->sheet.tiles.columns; column++) {
      size_t at = (size_t)row * (size_t)w->sheet.tiles.columns + (size_t)column;
      uint64_t near = bits_of(w, w->near, column, row);
      if (near & ~w->sheet.whole[at]) return false;
      if (near)
        fg_levels_count(w->sheet.tiles.tiles[at], w->tiles->bytes_per_pixel, near, histogram);
    }
  *l = fg_levels_find(histogram);
  return true;
}

/* Returns true when the kept parts lie clear of the scan's border. */
static bool is_inside(const work *w) {
  double margin = w->options->border_px;
  for (int32_t i = 0; i < w->part_count; i++) {
    const fg_blob *p = &w->parts[i];
    double x = (double)(w->corner_px[0] + (int64_t)p->x * FG_BLOCK_PX);
    double y = (double)(w->corner_px[1] + (int64_t)p->y * FG_BLOCK_PX);
    if (w->kept[i] && (x < margin || y < margin ||
                       x + p->width * FG_BLOCK_PX > (double)w->tiles->width_px - margin ||
                       y + p->height * FG_BLOCK_PX > (double)w->tiles->height_px - margin))
      return false;
  }
  return true;
}

/* Repeats until corner and levels converge. False: they do not, or the island cannot be cut anew.
 */
static fg_status iterate_corner(fg_context *ctx, work *w, size_t *specks, bool *converged) {
  int64_t low_px[2], found_px[2];
  bool large, moved = true;
  fg_levels l = fg_levels_of_island(w->tiles, w->island);
  *converged = false;
  if (!l.found) return FG_OK;
  guess_corner(w, &l, low_px);
  for (int round = 0; round < ROUNDS_MAX && !*converged; round++) {
    if (moved) FG_TRY(cut_sheet(ctx, w, low_px));
    FG_TRY(mark_hot(ctx, w, &l));
    FG_TRY(find_parts(ctx, w, specks, &large));
    fg_levels next;
    if (!large || !is_inside(w) || !mark_near(w) || !find_near_levels(w, &next)) return FG_OK;
    find_low(w, &l, found_px);
    moved = found_px[0] != low_px[0] || found_px[1] != low_px[1];
    *converged = !moved && next.limit == l.limit && next.light == l.light;
    memcpy(low_px, found_px, sizeof low_px);
    l = next;
  }
  return FG_OK;
}

/* The median of a tile's blocks that are near, those without a hot pixel if there are any. */
static float tile_median(const fg_tile *tile, uint64_t near, uint64_t hot) {
  float values[BLOCKS];
  size_t count = 0;
  uint64_t taken = near & ~hot ? near & ~hot : near;
  for (int b = 0; b < BLOCKS; b++)
    if (taken >> b & 1) values[count++] = tile->blocks[b];
  return fg_select_float(values, count, count / 2);
}

/* Marks blocks that are not near as unknown; their pixels become background, for cuts that cross
 * them. */
static void clear_far(fg_tile *tile, int bytes_per_pixel, uint64_t near, float median) {
  for (size_t b = 0; b < BLOCKS; b++) {
    if (near >> b & 1) continue;
    size_t first =
        b / FG_BLOCKS_PER_TILE * FG_BLOCK_PX * FG_TILE_PX + b % FG_BLOCKS_PER_TILE * FG_BLOCK_PX;
    tile->blocks[b] = NAN;
    for (size_t y = 0; y < FG_BLOCK_PX; y++)
      for (size_t x = 0; x < FG_BLOCK_PX; x++) {
        size_t at = first + y * FG_TILE_PX + x;
        if (bytes_per_pixel == 1)
          tile->pixels[at] = (uint8_t)lroundf(median);
        else
          ((uint16_t *)(void *)tile->pixels)[at] = (uint16_t)lroundf(median * 257.0f);
      }
  }
}

static bool holds_kept(const work *w, int32_t column, int32_t row) {
  for (int b = 0; b < BLOCKS; b++)
    if (is_kept(w, column * FG_BLOCKS_PER_TILE + b % FG_BLOCKS_PER_TILE,
                row * FG_BLOCKS_PER_TILE + b / FG_BLOCKS_PER_TILE))
      return true;
  return false;
}

static fg_status finish_tile(fg_context *ctx, work *w, int32_t column, int32_t row,
                             fg_island *island) {
  fg_tiles *view = &w->sheet.tiles;
  size_t at = (size_t)row * (size_t)view->columns + (size_t)column;
  uint64_t near = bits_of(w, w->near, column, row);
  view->medians[at] = NAN;
  if (!near) {
    fg_tiles_drop(view, column, row);
    return FG_OK;
  }
  view->medians[at] = tile_median(view->tiles[at], near, bits_of(w, w->hot, column, row));
  clear_far(view->tiles[at], view->bytes_per_pixel, near, view->medians[at]);
  view->wanted[at] = holds_kept(w, column, row);
  return view->wanted[at] ? fg_island_append(ctx, island, view->columns, column, row) : FG_OK;
}

static fg_status finish_anchor(fg_context *ctx, work *w, fg_anchored *out) {
  fg_island island = {0};
  fg_status status = FG_OK;
  for (int32_t row = 0; row < w->sheet.tiles.rows && status == FG_OK; row++)
    for (int32_t column = 0; column < w->sheet.tiles.columns && status == FG_OK; column++)
      status = finish_tile(ctx, w, column, row, &island);
  if (status != FG_OK) {
    fg_island_free(&island);
    return status;
  }
  out->anchored = true;
  out->view = w->sheet.tiles;
  out->island = island;
  memcpy(out->corner_px, w->corner_px, sizeof w->corner_px);
  memset(&w->sheet.tiles, 0, sizeof w->sheet.tiles);
  return FG_OK;
}

static void free_work(work *w) {
  free_sheet(w);
  free(w->own);
  free(w->blocks);
  free(w->parts);
  free(w->kept);
}

fg_status fg_anchor_island(fg_context *ctx, const fg_tiles *tiles, const fg_island *island,
                           const fg_anchor_options *options, fg_anchored *out) {
  work w = {.tiles = tiles, .island = island, .options = options};
  fg_context inner = {.message = ""};
  bool converged = false;
  memset(out, 0, sizeof *out);
  FG_TRY(fg_memory_allocate(ctx, (size_t)tiles->columns * (size_t)tiles->rows, 1, (void **)&w.own));
  for (size_t i = 0; i < island->count; i++)
    w.own[island->tiles[i]] = 1;
  fg_status status = iterate_corner(&inner, &w, &out->specks, &converged);
  if (status == FG_OK && converged) status = finish_anchor(&inner, &w, out);
  free_work(&w);
  if (status == FG_ERR_DATA) return FG_OK; /* the budget does not hold both */
  return status == FG_OK ? FG_OK : fg_fail(ctx, status, "%s", inner.message);
}

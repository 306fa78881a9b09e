/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/islands.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

enum {
  ROWS_AFTER = 3
}; /* rows of tiles needed beyond an island: its neighbours, and the background over two tiles */

/* A growing group. A merged group points to the one that absorbed it. */
typedef struct group {
  fg_island island;
  int32_t last_row;
  size_t into; /* itself, or the group that absorbed it */
  bool closed;
} group;

struct fg_islands {
  const fg_tiles *tiles;
  group *groups;
  size_t count, capacity;
  size_t *above, *here; /* 1 + group of each column in the row before and in this one; 0: none */
  int32_t row;          /* number of rows processed */
  size_t *ready;        /* closed groups in order; owned */
  size_t ready_count, ready_capacity, handed_out;
  size_t first_open; /* groups before it are closed or merged */
};

fg_status fg_islands_create(fg_context *ctx, const fg_tiles *tiles, fg_islands **islands) {
  fg_status status = FG_OK;
  fg_islands *made = NULL;
  *islands = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *made, (void **)&made));
  made->tiles = tiles;
  size_t columns = (size_t)tiles->columns;
  FG_TRY_EXIT(fg_memory_allocate(ctx, columns, sizeof *made->above, (void **)&made->above));
  FG_TRY_EXIT(fg_memory_allocate(ctx, columns, sizeof *made->here, (void **)&made->here));
  *islands = made;
exit:
  if (status != FG_OK) fg_islands_free(made);
  return status;
}

static size_t find_group(const fg_islands *islands, size_t i) {
  while (islands->groups[i].into != i)
    i = islands->groups[i].into;
  return i;
}

static fg_status append_tile(fg_context *ctx, fg_island *island, int32_t tile) {
  FG_TRY(fg_memory_reserve(ctx, island->count + 1, sizeof *island->tiles, &island->capacity,
                           (void **)&island->tiles));
  island->tiles[island->count++] = tile;
  return FG_OK;
}

static void widen_box(fg_island *island, int32_t x, int32_t y, int32_t width, int32_t height) {
  int32_t right = island->x + island->width, low = island->y + island->height;
  if (x + width > right) right = x + width;
  if (y + height > low) low = y + height;
  if (x < island->x) island->x = x;
  if (y < island->y) island->y = y;
  island->width = right - island->x;
  island->height = low - island->y;
}

fg_status fg_island_append(fg_context *ctx, fg_island *island, int32_t columns, int32_t column,
                           int32_t row) {
  FG_TRY(append_tile(ctx, island, row * columns + column));
  if (island->count == 1) {
    island->x = column;
    island->y = row;
  }
  widen_box(island, column, row, 1, 1);
  return FG_OK;
}

/* Merges two groups into the larger one. */
static fg_status merge_groups(fg_context *ctx, fg_islands *islands, size_t a, size_t b,
                              size_t *into) {
  a = find_group(islands, a);
  b = find_group(islands, b);
  *into = a;
  if (a == b) return FG_OK;
  if (islands->groups[b].island.count > islands->groups[a].island.count) {
    size_t swap = a;
    a = b;
    b = swap;
  }
  group *to = &islands->groups[a], *from = &islands->groups[b];
  for (size_t i = 0; i < from->island.count; i++)
    FG_TRY(append_tile(ctx, &to->island, from->island.tiles[i]));
  widen_box(&to->island, from->island.x, from->island.y, from->island.width, from->island.height);
  if (from->last_row > to->last_row) to->last_row = from->last_row;
  from->into = a;
  fg_island_free(&from->island);
  *into = a;
  return FG_OK;
}

static fg_status start_group(fg_context *ctx, fg_islands *islands, int32_t x, size_t *made) {
  FG_TRY(fg_memory_reserve(ctx, islands->count + 1, sizeof *islands->groups, &islands->capacity,
                           (void **)&islands->groups));
  *made = islands->count++;
  islands->groups[*made] =
      (group){.island = {.x = x, .y = islands->row, .width = 1, .height = 1}, .into = *made};
  return FG_OK;
}

/* Adds a wanted tile to the group of its neighbours to the left and above, joining them. */
static fg_status process_tile(fg_context *ctx, fg_islands *islands, int32_t x) {
  size_t found = 0;
  for (int32_t d = -1; d <= 2; d++) {
    int32_t c = d == 2 ? x - 1 : x + d;
    if (c < 0 || c >= islands->tiles->columns) continue;
    size_t other = d == 2 ? islands->here[c] : islands->above[c];
    if (!other) continue;
    size_t into = find_group(islands, other - 1);
    if (found) FG_TRY(merge_groups(ctx, islands, found - 1, into, &into));
    found = into + 1;
  }
  size_t at = found - 1;
  if (!found) FG_TRY(start_group(ctx, islands, x, &at));
  group *g = &islands->groups[at];
  FG_TRY(append_tile(ctx, &g->island, islands->row * islands->tiles->columns + x));
  widen_box(&g->island, x, islands->row, 1, 1);
  g->last_row = islands->row;
  islands->here[x] = at + 1;
  return FG_OK;
}

/* Closes the groups that the last row did not touch: they are complete. */
static fg_status close_groups(fg_context *ctx, fg_islands *islands, int32_t before_row) {
  bool all_before = true;
  for (size_t i = islands->first_open; i < islands->count; i++) {
    group *g = &islands->groups[i];
    if (g->into == i && !g->closed && g->last_row < before_row) {
      g->closed = true;
      FG_TRY(fg_memory_reserve(ctx, islands->ready_count + 1, sizeof *islands->ready,
                               &islands->ready_capacity, (void **)&islands->ready));
      islands->ready[islands->ready_count++] = i;
    }
    all_before = all_before && (g->into != i || g->closed);
    if (all_before) islands->first_open = i + 1;
  }
  return FG_OK;
}

static fg_status process_row(fg_context *ctx, fg_islands *islands) {
  const uint8_t *wanted =
      islands->tiles->wanted + (size_t)islands->row * (size_t)islands->tiles->columns;
  memset(islands->here, 0, (size_t)islands->tiles->columns * sizeof *islands->here);
  for (int32_t x = 0; x < islands->tiles->columns; x++)
    if (wanted[x]) FG_TRY(process_tile(ctx, islands, x));
  size_t *swap = islands->above;
  islands->above = islands->here;
  islands->here = swap;
  FG_TRY(close_groups(ctx, islands, islands->row));
  islands->row++;
  return islands->row == islands->tiles->rows ? close_groups(ctx, islands, islands->row) : FG_OK;
}

fg_status fg_islands_advance(fg_context *ctx, fg_islands *islands) {
  while (islands->row < islands->tiles->received)
    FG_TRY(process_row(ctx, islands));
  return FG_OK;
}

bool fg_islands_next(fg_islands *islands, fg_island *island) {
  if (islands->handed_out >= islands->ready_count) return false;
  group *g = &islands->groups[islands->ready[islands->handed_out]];
  /* The last row's tiles are kept only when the scan has ended. */
  bool ended = islands->row == islands->tiles->rows && !islands->tiles->strips[0];
  if (!ended && islands->row <= g->last_row + ROWS_AFTER) return false;
  *island = g->island;
  memset(&g->island, 0, sizeof g->island);
  islands->handed_out++;
  return true;
}

void fg_islands_free(fg_islands *islands) {
  if (!islands) return;
  for (size_t i = 0; i < islands->count; i++)
    fg_island_free(&islands->groups[i].island);
  free(islands->groups);
  free(islands->above);
  free(islands->here);
  free(islands->ready);
  free(islands);
}

void fg_island_free(fg_island *island) {
  if (!island) return;
  free(island->tiles);
  memset(island, 0, sizeof *island);
}

enum {
  REACH = 2,       /* tiles around an island that contribute pixels */
  VIEW_MARGIN = 4, /* tiles by which a view is wider than its island: its edge is not the scan's */
};

/* Returns true when any tile within reach is wanted and not yet processed. */
static bool is_needed(const fg_tiles *tiles, int32_t column, int32_t row) {
  for (int32_t y = row - REACH; y <= row + REACH; y++)
    for (int32_t x = column - REACH; x <= column + REACH; x++)
      if (x >= 0 && y >= 0 && x < tiles->columns && y < tiles->rows &&
          tiles->wanted[(size_t)y * (size_t)tiles->columns + (size_t)x] == 1)
        return true;
  return false;
}

void fg_island_release(fg_tiles *tiles, const fg_island *island) {
  for (size_t i = 0; i < island->count; i++)
    tiles->wanted[island->tiles[i]] = 2;
  for (size_t i = 0; i < island->count; i++) {
    int32_t column = island->tiles[i] % tiles->columns, row = island->tiles[i] / tiles->columns;
    for (int32_t y = row - REACH; y <= row + REACH; y++)
      for (int32_t x = column - REACH; x <= column + REACH; x++)
        if (x >= 0 && y >= 0 && x < tiles->columns && y < tiles->rows && fg_tiles_at(tiles, x, y) &&
            !is_needed(tiles, x, y))
          fg_tiles_drop(tiles, x, y);
  }
}

static int32_t min(int32_t a, int32_t b) {
  return a < b ? a : b;
}

static int32_t max(int32_t a, int32_t b) {
  return a > b ? a : b;
}

/* Fills the view with the area's medians and wants, and the tiles within reach of the island. */
static void fill_view(const fg_tiles *tiles, const fg_island *island, int32_t x0, int32_t y0,
                      fg_tiles *view) {
  size_t width = (size_t)view->columns;
  for (int32_t y = 0; y < view->rows; y++) {
    size_t from = (size_t)(y + y0) * (size_t)tiles->columns + (size_t)x0, to = (size_t)y * width;
    memcpy(view->medians + to, tiles->medians + from, width * sizeof *view->medians);
    for (size_t x = 0; x < width; x++)
      view->wanted[to + x] = tiles->wanted[from + x] != 0;
  }
  for (size_t i = 0; i < island->count; i++) {
    int32_t column = island->tiles[i] % tiles->columns, row = island->tiles[i] / tiles->columns;
    for (int32_t y = row - REACH; y <= row + REACH; y++)
      for (int32_t x = column - REACH; x <= column + REACH; x++)
        fg_tiles_share(tiles, x, y, view, x - x0, y - y0);
  }
}

static void move_island(fg_island *island, int32_t columns, int32_t x0, int32_t y0,
                        int32_t view_columns) {
  for (size_t i = 0; i < island->count; i++) {
    int32_t column = island->tiles[i] % columns - x0, row = island->tiles[i] / columns - y0;
    island->tiles[i] = row * view_columns + column;
  }
  island->x -= x0;
  island->y -= y0;
}

fg_status fg_island_cut(fg_context *ctx, fg_tiles *tiles, fg_island *island, fg_tiles *view,
                        int64_t origin_px[2]) {
  int32_t x0 = max(island->x - VIEW_MARGIN, 0), y0 = max(island->y - VIEW_MARGIN, 0);
  int32_t x1 = min(island->x + island->width + VIEW_MARGIN, tiles->columns);
  int32_t y1 = min(island->y + island->height + VIEW_MARGIN, tiles->rows);
  origin_px[0] = (int64_t)x0 * FG_TILE_PX;
  origin_px[1] = (int64_t)y0 * FG_TILE_PX;
  int64_t right = (int64_t)x1 * FG_TILE_PX, low = (int64_t)y1 * FG_TILE_PX;
  if (right > tiles->width_px) right = tiles->width_px;
  if (low > tiles->height_px) low = tiles->height_px;
  *view = (fg_tiles){.budget = tiles->budget,
                     .width_px = right - origin_px[0],
                     .height_px = low - origin_px[1],
                     .bytes_per_pixel = tiles->bytes_per_pixel};
  fg_status status = fg_tiles_allocate(ctx, view);
  if (status != FG_OK) {
    fg_tiles_free(view);
    return status;
  }
  fill_view(tiles, island, x0, y0, view);
  fg_island_release(tiles, island);
  move_island(island, tiles->columns, x0, y0, view->columns);
  return FG_OK;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Islands: connected groups of wanted tiles, known as soon as the scan has passed them.
 *
 * An island is handed out when every tile that can matter to it is there: three rows of tiles after
 * its last one. It is then cut out and measured while the scan is still read.
 */
#ifndef FG_VISION_ISLANDS_H
#define FG_VISION_ISLANDS_H

#include <stdbool.h>

#include "vision/tiles.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_island {
  int32_t *tiles; /* row × columns + column of every wanted tile; owned */
  size_t count, capacity;
  int32_t x, y, width, height; /* bounding box in tiles */
} fg_island;

typedef struct fg_islands fg_islands;

fg_status fg_islands_create(fg_context *ctx, const fg_tiles *tiles, fg_islands **islands);

/* Adds the rows of tiles that were received since the last call. */
fg_status fg_islands_advance(fg_context *ctx, fg_islands *islands);

/* Hands out the next complete island: true, and the caller frees it with fg_island_free. Islands
 * come in the order of their last rows, then columns. */
bool fg_islands_next(fg_islands *islands, fg_island *island);

void fg_islands_free(fg_islands *islands);

/* Adds a tile to an island in an area of `columns` tiles across. FG_ERR_MEMORY. */
fg_status fg_island_append(fg_context *ctx, fg_island *island, int32_t columns, int32_t column,
                           int32_t row);
void fg_island_free(fg_island *island);

/* Cuts an island out of the scan. `view` shows its tiles and those around them, in coordinates of
 * its own; origin_px is the place of its pixel (0, 0) in the scan. The island is converted to these
 * coordinates. So an island's measurement can depend on its surroundings alone. The scan releases
 * the tiles that no other island needs. The caller frees `view` with fg_tiles_free; that and
 * measuring it are safe in another thread. */
fg_status fg_island_cut(fg_context *ctx, fg_tiles *tiles, fg_island *island, fg_tiles *view,
                        int64_t origin_px[2]);

/* Releases the tiles of an island that is not worth measuring, as far as no other needs them. */
void fg_island_release(fg_tiles *tiles, const fg_island *island);

#ifdef __cplusplus
}
#endif
#endif

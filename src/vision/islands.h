/* Islands: connected groups of wanted tiles, known as soon as the scan has passed them.
 *
 * An island is handed out when every tile that can matter to it is there: three rows of tiles after
 * its last one. It can then be measured, and its tiles dropped, while the scan is still read.
 */
#ifndef FG_VISION_ISLANDS_H
#define FG_VISION_ISLANDS_H

#include <stdbool.h>

#include "vision/tiles.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_island {
  int32_t *tiles;              /* row × columns + column of every wanted tile; owned */
  size_t count, capacity;
  int32_t x, y, width, height; /* bounding box in tiles */
} fg_island;

typedef struct fg_islands fg_islands;

fg_status fg_islands_create(fg_context *ctx, const fg_tiles *tiles, fg_islands **islands);

/* Takes in the rows of tiles that were received since the last call. */
fg_status fg_islands_advance(fg_context *ctx, fg_islands *islands);

/* The next island that is complete: true, and the caller frees it with fg_island_free. Islands come
 * in the order of their last rows, then columns. */
bool fg_islands_next(fg_islands *islands, fg_island *island);

void fg_islands_free(fg_islands *islands);
void fg_island_free(fg_island *island);

/* Drops the tiles of an island that was measured, as far as no other island needs them. Call it
 * from one thread at a time. */
void fg_island_drop(fg_tiles *tiles, const fg_island *island);

#ifdef __cplusplus
}
#endif
#endif

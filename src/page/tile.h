/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tiles: the numbers that come first on a page. They stand in a <dl class="tiles">. */
#ifndef FG_PAGE_TILE_H
#define FG_PAGE_TILE_H

#include <stdio.h>

typedef enum fg_tile_look {
  FG_TILE_PLAIN,
  FG_TILE_GOOD,
  FG_TILE_BAD,
  FG_TILE_OPEN,
  FG_TILE_LOOKS
} fg_tile_look;

/* Writes one tile: its title, its value as of printf, and smaller words under it (NULL or "":
 * none). All of it is markup already. */
void fg_html_tile(FILE *out, const char *title, const char *small, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Writes a tile of a count that is good or bad news: by a sign, then by a colour. */
void fg_html_count_tile(FILE *out, fg_tile_look look, const char *title, size_t count,
                        const char *small);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tiles: the numbers that come first on a page. They stand in a <dl class="tiles">. */
#ifndef FG_PAGE_TILE_H
#define FG_PAGE_TILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Good and bad news are told by a sign, then by a colour. */
typedef enum fg_tile_look {
  FG_TILE_PLAIN,
  FG_TILE_GOOD,
  FG_TILE_BAD,
  FG_TILE_OPEN,
  FG_TILE_LOOKS
} fg_tile_look;

/* One tile. Its texts are markup already. A count is a value without unit and decimals. */
typedef struct fg_tile {
  const char *title; /* NULL: the tile is left out */
  const char *text;  /* in place of the value; NULL: the value */
  double value, u;   /* a value that is not finite is written as a dash */
  const char *unit;  /* NULL: none, and no space for it */
  int decimals;
  int digits;          /* significant, in place of decimals; 0: decimals */
  bool plus;           /* values above 0 have their sign */
  const char *u_words; /* behind "± U", which comes before the small words; NULL: U is not told */
  const char *small;   /* smaller words under the value; NULL or "": none */
  const char *unknown; /* the small words beside a dash; NULL: those of the value */
  fg_tile_look look;
} fg_tile;

/* U of a page that does not say elsewhere which U it means. */
#define FG_TILE_U_IS_2U " (U = 2 u)"

void fg_html_tile(FILE *out, const fg_tile *tile);

/* Writes the list of tiles; `style` is its class: "tiles", "tiles four". */
void fg_html_tiles(FILE *out, const char *style, const fg_tile *tiles, size_t count);

#endif

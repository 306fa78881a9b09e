/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Objects that share an island without belonging together.
 *
 * Tiles that touch are one island, so two foils may be one island when they lie less than two tiles
 * apart. Whether they are depends on where the scan's tiles lie. A foil must be measured as if it
 * were alone, so such an island is split: pieces between which a walk along a strip could cross the
 * gap stay together, and each group of them becomes an island of its own.
 */
#ifndef FG_VISION_ISLAND_SPLIT_H
#define FG_VISION_ISLAND_SPLIT_H

#include "vision/islands.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_island_split_options {
  double min_px; /* diagonal of the smallest object that is no dust */
  double gap_px; /* pieces of one strip may lie so far apart */
} fg_island_split_options;

typedef struct fg_island_list {
  fg_island *list; /* owned, and each of them */
  size_t count;
  size_t specks; /* groups that are smaller than min_px, and left out */
} fg_island_list;

/* Splits an island of `tiles`. The list is empty when the island is one group, or dust alone: then
 * it is measured as it is. FG_ERR_MEMORY. */
fg_status fg_island_split(fg_context *ctx, const fg_tiles *tiles, const fg_island *island,
                          const fg_island_split_options *options, fg_island_list *parts);

void fg_island_list_free(fg_island_list *parts);

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tiles anchored on the foil, so that its measurement does not depend on its place on the glass.
 *
 * Block means, medians and the background between them depend on where the tiles' corners lie on
 * the foil. They shift the measured values by some nanometres. So an island is cut anew, from a
 * corner of the foil's own: its leftmost and uppermost pixel beyond a limit between background and
 * foil. The new tiles hold the surroundings of such pixels, not the area that the scan's tiles
 * happened to hold. Corner and limit come from the kept pixels, and these from corner and limit:
 * the cut is repeated until both converge.
 */
#ifndef FG_VISION_ANCHOR_H
#define FG_VISION_ANCHOR_H

#include "vision/islands.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_anchor_options {
  double min_px;    /* diagonal of the smallest object that is no dust */
  double border_px; /* objects nearer to the scan's border may be cut by it */
  unsigned threads;
} fg_anchor_options;

typedef struct fg_anchored {
  bool anchored;        /* false: nothing below is set, and the island is best measured in place */
  fg_tiles view;        /* owned */
  fg_island island;     /* in the view; owned */
  int64_t corner_px[2]; /* corner of the view, in the tiles it was cut from */
  size_t specks;        /* parts of the island that the view leaves out */
} fg_anchored;

/* Cuts an island of `tiles` anew. The island stays in place when it lies at the scan's border,
 * holds nothing large and clear, or when memory is short. FG_ERR_MEMORY. */
fg_status fg_anchor_island(fg_context *ctx, const fg_tiles *tiles, const fg_island *island,
                           const fg_anchor_options *options, fg_anchored *out);

#ifdef __cplusplus
}
#endif
#endif

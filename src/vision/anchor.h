/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tiles anchored on the foil: what is measured of it does not depend on where it lies on the glass.
 *
 * Block means, medians and the background between them depend on where the tiles' corners lie on
 * the foil, and with them, by some nanometres, what is measured. So an island is cut anew: the
 * corner is the foil's own, its leftmost and uppermost pixel beyond a limit between background and
 * foil, and what is kept is what lies around such pixels, not what the scan's tiles happened to
 * hold. Corner and limit come from the pixels that are kept, and these from them: that is repeated
 * until both stand.
 */
#ifndef FG_VISION_ANCHOR_H
#define FG_VISION_ANCHOR_H

#include "vision/islands.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_anchor_options {
  double min_px;    /* diagonal of the smallest object that is no dust */
  double border_px; /* what lies nearer to the scan's border may be cut by it */
} fg_anchor_options;

typedef struct fg_anchored {
  bool anchored;        /* else nothing below is set, and the island is best measured where it is */
  fg_tiles view;        /* owned */
  fg_island island;     /* in the view; owned */
  int64_t corner_px[2]; /* of the view, in the tiles it was cut from */
  size_t specks;        /* parts of the island that are in the view no more */
} fg_anchored;

/* Cuts an island of `tiles` anew. It stays where it is when it lies at the scan's border, holds
 * nothing large and clear, or when memory is short. FG_ERR_MEMORY. */
fg_status fg_anchor_island(fg_context *ctx, const fg_tiles *tiles, const fg_island *island,
                           const fg_anchor_options *options, fg_anchored *out);

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How an edge runs from dark to bright, without a model: where its counts cross a tenth, the half
 * and nine tenths of the contrast. A tone curve whose middle lies q of the contrast too high makes
 * the bright part of that way longer, by a quarter of q of all of it; a blur that is symmetric leaves both
 * parts alike. It tells whether two scans have one tone curve. */
#ifndef FG_VISION_EDGE_SPREAD_H
#define FG_VISION_EDGE_SPREAD_H

#include <stddef.h>

enum { FG_SPREAD_BINS = 128 };

typedef struct fg_edge_spread {
  double sum[FG_SPREAD_BINS], weight[FG_SPREAD_BINS];
} fg_edge_spread;

/* A count as a share of the contrast, so far on the bright side of the edge. */
void fg_edge_spread_add(fg_edge_spread *spread, double bright_px, double share, double weight);

/* From a tenth to nine tenths, over what that is of a Gaussian blur of sd 1; and the bright part of
 * it less the dark one, over the whole. NaN where it is not seen. */
void fg_edge_spread_measure(const fg_edge_spread *spread, double *blur_px, double *asymmetry);

#endif

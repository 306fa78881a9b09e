/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rise of an edge from dark to bright, without a model: the places where its counts cross a tenth,
 * the half and nine tenths of the contrast.
 *
 * A tone curve whose middle lies q of the contrast too high makes the bright part of this rise
 * longer, by a quarter of q of its whole length; a symmetric blur leaves both parts alike. So the
 * spread tells whether two scans have one tone curve. */
#ifndef FG_VISION_EDGE_SPREAD_H
#define FG_VISION_EDGE_SPREAD_H

#include <stddef.h>

enum { FG_SPREAD_BINS = 128 };

typedef struct fg_edge_spread {
  double sum[FG_SPREAD_BINS], weight[FG_SPREAD_BINS];
} fg_edge_spread;

/* Adds a count, as a share of the contrast, at `bright_px` on the bright side of the edge. */
void fg_edge_spread_add(fg_edge_spread *spread, double bright_px, double share, double weight);

/* *blur_px: length from a tenth to nine tenths, over that of a Gaussian blur of sd 1. *asymmetry:
 * its bright part less the dark one, over the whole. NaN where they are not seen. */
void fg_edge_spread_measure(const fg_edge_spread *spread, double *blur_px, double *asymmetry);

#endif

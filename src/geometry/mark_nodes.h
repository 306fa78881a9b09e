/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A mark is as large as its edges: a displacement of the picture moves it by the mean over them. */
#ifndef FG_GEOMETRY_MARK_NODES_H
#define FG_GEOMETRY_MARK_NODES_H

#include "foilgauge/grid.h"

enum { FG_MARK_NODES_MAX = 32 };

/* The mark moves along a direction e by the sum of weight · d(at) over its nodes. */
typedef struct fg_mark_node {
  fg_point at, weight;
} fg_mark_node;

/* Fills at most `count` nodes, evenly along the edges; returns their number, 1 where the mark's
 * reach is not known. `along` is e, a unit vector; of corners it lies across one of the edges.
 *
 * Of a dot's edge the least-squares circle's centre takes the mean of 2 n (n · d), n the edge's
 * normal; of a corner the edge at right angles to e takes the mean of d. */
size_t fg_mark_nodes(const fg_mark *mark, fg_point along, size_t count,
                     fg_mark_node nodes[FG_MARK_NODES_MAX]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sub-pixel edges of a traced strip: an intensity model of both edges, fitted to every pixel.
 *
 * Three steps. (1) Mean profiles of short segments tell the shape: levels, slopes, blur, tone
 * curve. (2) The shape is smoothed along the strip as a function of the edge's direction and place,
 * for it changes with those alone (shading, one-sided blur of the carriage, a wall on one side).
 * Local deviations from that function enter only as far as they exceed their own uncertainty. (3)
 * With the shape held, both edges of every station follow from its pixels by Gauss-Newton: the
 * maximum-likelihood estimate, whose variance is the bound (n/A)² 2 s sqrt(pi) for an edge that
 * stands alone.
 *
 * A Gaussian blur of sd s moves a curved edge towards its centre of curvature by s²/(2R). The
 * stations hold the edge as seen; the fits of circles correct the shift.
 */
#ifndef FG_VISION_EDGES_H
#define FG_VISION_EDGES_H

#include "foilgauge/strip.h"
#include "vision/segment.h"
#include "vision/trace.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_edge_options {
  const double *dpi; /* x and y */
  unsigned threads;  /* 0: all cores */
  bool linear;       /* counts are proportional to the light: no tone curve is fitted */
  bool plain;        /* where a tone curve is found, measure with counts used as light as well */
} fg_edge_options;

/* Fills `strip` (zeroed by the caller; fg_strip_free it). The result does not depend on the
 * threads. FG_ERR_NUMERIC when no edges are found along the trace. */
fg_status fg_edges_measure(fg_context *ctx, const fg_tiles *tiles,
                           const fg_segmentation *segmentation, const fg_trace *trace,
                           const fg_edge_options *options, fg_strip *strip);

#ifdef __cplusplus
}
#endif
#endif

/* Sub-pixel edges of a traced strip: an intensity model of both edges, fitted to every pixel.
 *
 * Three steps. (1) Mean profiles of short segments tell the shape: levels, slopes, blur, tone
 * curve. (2) The shape is smoothed along the strip as a function of the edge's direction and place,
 * for it changes with those alone (shading, one-sided blur of the carriage, a wall on one side),
 * and what is left over enters only as far as it exceeds its own uncertainty. (3) With the shape
 * held, both edges of every station follow from its pixels by Gauss-Newton: the maximum-likelihood
 * estimate, whose variance is the bound (n/A)² 2 s sqrt(pi) for an edge that stands alone.
 *
 * A Gaussian blur of sd s moves a curved edge towards its centre of curvature by s²/(2R). The
 * stations hold the edge as it is seen; the fits of circles put the shift back.
 */
#ifndef FG_VISION_EDGES_H
#define FG_VISION_EDGES_H

#include "foilgauge/strip.h"
#include "vision/pixel_band.h"
#include "vision/edge_model.h"
#include "vision/segment.h"
#include "vision/trace.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Fills `strip` (zeroed by the caller; fg_strip_free it). `dpi` is x and y. FG_ERR_NUMERIC when
 * no edges are found along the trace. */
fg_status fg_edges_measure(fg_context *ctx, const fg_tiles *tiles,
                           const fg_segmentation *segmentation, const fg_trace *trace,
                           const double dpi[2], fg_strip *strip);

/* One station at work. */
typedef struct fg_edge_station {
  float middle_px;        /* centre of the strip, from the reference line */
  float edge_px[2];       /* left and right, from the reference line */
  float plateau, step[2]; /* P, and b - P */
  float slope[2], blur_px[2];
  float m11, m12, m22, g1, g2, misfit; /* sums over pixels */
  int32_t used, seen;
  float u_px[2];
  float weight;
} fg_edge_station;

/* What one strip is measured with. */
typedef struct fg_edge_work {
  const fg_reference *reference;
  const fg_pixel_band *band;
  fg_edge_station *stations; /* reference->count */
  fg_edge_tables *tables;
  double width_px;           /* of the strip */
  double reach_px;           /* of the band beyond the strip's edges */
  double noise;              /* sd of a pixel, counts */
  double contrast;           /* |P - b|, counts */
  bool clipped, side_band;
  double thickness_px, blur_px[2], gamma;
} fg_edge_work;

/* Step 1 and 2: the shape of every station from its middle. edges_shape.c */
fg_status fg_edges_find_shape(fg_context *ctx, fg_edge_work *work, bool find_gamma);

/* Step 3: `rounds` of Gauss-Newton on all stations. edges_solve.c */
void fg_edges_solve(fg_edge_work *work, int rounds);

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What JPEG's loss does to edges, as measured on renders (reports/jpeg.md). Quality 0: nothing was
 * lost. */
#ifndef FG_MEASURE_LOSS_H
#define FG_MEASURE_LOSS_H

/* Standard uncertainty of an edge's place across it, pixels, that all edges of a scan have
 * together: outwards or inwards. What differs from place to place is seen in the residuals, and
 * counted there. `contrast` is that of the edge in gray values of 8 bits. */
double fg_loss_edge_px(int jpeg_quality, double contrast, double blur_px);

/* Share by which the variance of a turn of stations is more than its spectrum tells. */
double fg_loss_turn_variance(int jpeg_quality);

/* The same of the arcs of a strip and their residuals. */
double fg_loss_arc_variance(int jpeg_quality);

#endif

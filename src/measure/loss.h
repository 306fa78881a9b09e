/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effect of JPEG's loss on edges, as measured on renders (reports/jpeg.md). Quality 0: lossless. */
#ifndef FG_MEASURE_LOSS_H
#define FG_MEASURE_LOSS_H

/* Standard uncertainty, px, of an edge's place across it that all edges of a scan share: outwards
 * or inwards. Local differences are visible in the residuals, and counted there. `contrast` is that
 * of the edge in gray values of 8 bits. */
double fg_loss_edge_px(int jpeg_quality, double contrast, double blur_px);

/* Share by which the variance of a turn of stations exceeds the one by its spectrum. */
double fg_loss_turn_variance(int jpeg_quality);

/* Share by which the variance of the arcs of a strip exceeds the one by their residuals. */
double fg_loss_arc_variance(int jpeg_quality);

#endif

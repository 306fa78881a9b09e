/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The edge of one round feature: an intensity model of one step, fitted to every pixel near it.
 *
 * (1) Mean profiles of sectors tell the shape (levels, slopes, blur, tone curve) and centre the
 * circle. (2) The shape is smoothed around the circle by its first harmonics: blur is one-sided
 * along the carriage, the wall of a hole shows on one side. (3) With the shape held, the edge of
 * every station follows from its pixels by Gauss-Newton. The edge is also estimated from the core's
 * pixels and from the flanks' pixels alone: where the two differ, the model's symmetry is wrong.
 *
 * A Gaussian blur of sd s moves the edge towards the centre by s²/(2R), whichever side is bright;
 * the stations are corrected for it. Lengths are square pixels (vision/disc_find.h).
 */
#ifndef FG_VISION_DISC_EDGE_H
#define FG_VISION_DISC_EDGE_H

#include "vision/disc_work.h"

/* Estimates the tone curve from the edge around a candidate: from its asymmetry, where no side is
 * white. FG_ERR_NUMERIC when there is no edge. One feature is too uncertain: pool them. */
fg_status fg_disc_edge_tone(fg_context *ctx, const fg_tiles *tiles, const fg_pixel_shape *shape,
                            const fg_disc_candidate *candidate, fg_tone *tone);

/* One tone curve for all features. gamma is 1, with uncertainty 0, unless the features agree on
 * another value. Where slopes hide the tone curve, gamma is 1 with a large uncertainty. */
fg_tone fg_tone_linear(void);
fg_tone fg_tone_pool(const fg_tone *tones, size_t count);
fg_tone fg_tone_pool_within(const fg_tone *tones, size_t count, const double range[2]);

/* FG_ERR_NUMERIC when there is no edge around the candidate. */
fg_status fg_disc_edge_measure(fg_context *ctx, const fg_tiles *tiles, const fg_pixel_shape *shape,
                               const fg_disc_candidate *candidate, const fg_tone *tone,
                               fg_disc_edge *edge);
void fg_disc_edge_free(fg_disc_edge *edge);

#endif

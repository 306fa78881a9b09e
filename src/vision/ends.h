/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cut ends of a strip: where the strip's side ends, to a fraction of a pixel.
 *
 * Beyond the last stations the middle goes on as a parabola through those before it. With u along
 * it, v across, d = u - e - k v the distance beyond the cut and S(v) the strip's own profile, the
 * light is
 *
 *  I(u, v) = G( q S(v) (1 + h d) + (b + g d - q S(v) (1 + h d)) Phi(d/s) + g s phi(d/s) )
 *
 * the product of a strip and an edge across it: a straight cut under a Gaussian blur. e (the cut on
 * the middle), k (its deviation from square), s, b, g, q and h are fitted to every pixel between
 * the strip's edges.
 */
#ifndef FG_VISION_ENDS_H
#define FG_VISION_ENDS_H

#include "vision/edge_work.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Fills strip->ends, in order of the stations. An end that does not look like a cut is left out:
 * that is no error. */
void fg_ends_measure(const fg_edge_work *work, const double dpi[2], fg_strip *strip);

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The round end of a cut, whose circle is found with its stations. */
#ifndef FG_VISION_LINE_END_H
#define FG_VISION_LINE_END_H

#include "vision/line_edge.h"

/* Half chord of the arc at a cut's end, in radii. */
#define FG_END_SHARE 0.89

/* Measures a stretch as fg_line_edge_measure. At the end of a cut that is measured by its light the
 * light follows from the circle, and the circle from the stations: both are found in turns, and the
 * stretch becomes the circle's. */
fg_status fg_line_end_measure(fg_context *ctx, const fg_line_view *view, const fg_line_tone *tone,
                              fg_stretch *stretch, fg_line_found *found);

/* Returns true for a straight stretch, and for a cut's end in which no circle is seen. */
bool fg_line_end_is_flat(const fg_stretch *stretch);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tracing: the coarse midline of every strip in an object, by walking along it.
 *
 * From a seed inside the strip the walk steps along the tangent, cuts the strip across, and puts
 * the next point into the middle of the cut. It goes on through short gaps (a scratch, a speck of
 * dust) and stops at the strip's end. Points are good to a few tenths of a pixel: a reference line
 * for the edges, not a measurement.
 */
#ifndef FG_VISION_TRACE_H
#define FG_VISION_TRACE_H

#include <stdbool.h>

#include "vision/trace_walk.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_trace_list {
  fg_trace *traces; /* owned */
  size_t count;
} fg_trace_list;

/* Traces all strips of one object. `width_px` is the design's width; strips of a quarter to four
 * times that are traced. An object that is no strip gives an empty list. */
fg_status fg_trace_object(fg_context *ctx, const fg_tiles *tiles,
                          const fg_segmentation *segmentation, const fg_object *object,
                          double width_px, fg_trace_list *list);

/* Returns true when the shorter of two traces lies on the longer: they are one strip. */
bool fg_trace_is_same(const fg_trace *a, const fg_trace *b);

void fg_trace_list_free(fg_trace_list *list);

#ifdef __cplusplus
}
#endif
#endif

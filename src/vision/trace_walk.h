/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One walk along a strip. trace.c chooses the seeds, and decides which walks are strips. */
#ifndef FG_VISION_TRACE_WALK_H
#define FG_VISION_TRACE_WALK_H

#include "foilgauge/circle.h"
#include "vision/segment.h"

#define FG_TRACE_STEPS_PER_WIDTH 3.0
/* A walk ends where it has missed the strip for so many widths. With the step that finds it again,
 * this is the longest gap that is bridged. */
#define FG_TRACE_MISSED_WIDTHS 4.0
#define FG_TRACE_GAP_WIDTHS    (FG_TRACE_MISSED_WIDTHS + 1 / FG_TRACE_STEPS_PER_WIDTH)

typedef struct fg_trace {
  fg_point *points; /* px, from one end to the other; owned */
  size_t count, capacity;
  double width_px; /* of the strip at half contrast, at the seed */
  double blur_px;  /* mean sd of the edges' blur, roughly */
  double contrast; /* contrast at the seed, 8-bit counts */
  unsigned facts;  /* fg_strip_fact: border, other, gap */
} fg_trace;

typedef struct fg_trace_walker {
  const fg_tiles *tiles;
  const fg_segmentation *segmentation;
  const fg_object *object;
  double half_window_px; /* of a cut */
  double width_px;       /* of the strip at the seed */
  double contrast;
  double blur_sum; /* over the cuts of a walk */
  size_t blur_count;
} fg_trace_walker;

/* The strip's own contrast at a seed: the largest excess of the pixels around it, less the
 * extremes (a 90th percentile). */
double fg_trace_contrast_at(const fg_trace_walker *walker, fg_point seed);

/* Walks both ways from a seed; a seed on no strip leaves the trace empty. */
fg_status fg_trace_from_seed(fg_context *ctx, fg_trace_walker *walker, fg_point seed,
                             fg_trace *trace);

#endif

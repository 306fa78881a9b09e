/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marks of a grid, coarsely: places where a fit can start. */
#ifndef FG_VISION_MARK_FIND_H
#define FG_VISION_MARK_FIND_H

#include "vision/mark_fit.h"
#include "vision/reduce.h"

typedef struct fg_mark_starts {
  fg_mark_fit *list; /* owned */
  size_t count, capacity;
} fg_mark_starts;

/* Corners of a chessboard. */
fg_status fg_mark_find_corners(fg_context *ctx, const fg_reduced *picture, fg_mark_starts *found);

/* Dots, crosses or lines: objects of one size. */
fg_status fg_mark_find_objects(fg_context *ctx, const fg_reduced *picture, fg_mark_kind kind,
                               fg_mark_starts *found);

#endif

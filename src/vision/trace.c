/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/trace.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "foilgauge/strip.h"

enum {
  STRIPS_MAX = 16, /* strips in one object */
  POINTS_MIN = 8,  /* of a strip */
};
#define LENGTH_MIN 12.0 /* shortest strip, in strip widths */
/* Min share of the shorter of two traces that lies on the longer, for one strip. */
#define OVERLAP_SHARE 0.5
/* Half width of the first cuts: they hold a strip of four times the design's width, and background
 * beside it. */
#define SEED_WINDOW_WIDTHS 3.0
#define SEED_WINDOW_PX     8.0

/* Clears the blocks of the object that lie along a trace, and returns the number of the others. */
static int32_t clear_along(const fg_trace *trace, const fg_trace_walker *w, fg_point seed,
                           uint8_t *open) {
  const fg_object *o = w->object;
  int32_t reach = (int32_t)((w->width_px / 2 + 2 * FG_BLOCK_PX) / FG_BLOCK_PX) + 1, left = 0;
  for (size_t i = 0; i <= trace->count; i++) {
    fg_point p = i < trace->count ? trace->points[i] : seed;
    int32_t bx = (int32_t)(p.x / FG_BLOCK_PX) - o->x, by = (int32_t)(p.y / FG_BLOCK_PX) - o->y;
    for (int32_t y = by - reach; y <= by + reach; y++)
      for (int32_t x = bx - reach; x <= bx + reach; x++)
        if (x >= 0 && y >= 0 && x < o->width && y < o->height)
          open[(size_t)y * (size_t)o->width + (size_t)x] = 0;
  }
  for (size_t i = 0; i < (size_t)o->width * (size_t)o->height; i++)
    left += open[i];
  return left;
}

/* The open block with the largest excess: the middle of the strip, away from its fringes. */
static bool find_seed(const fg_trace_walker *w, const uint8_t *open, fg_point *seed) {
  const fg_object *o = w->object;
  const fg_segmentation *s = w->segmentation;
  float best = 0;
  for (int32_t y = 0; y < o->height; y++)
    for (int32_t x = 0; x < o->width; x++) {
      if (!open[(size_t)y * (size_t)o->width + (size_t)x]) continue;
      float excess = fg_segmentation_excess(s, x + o->x, y + o->y);
      if (excess <= best) continue;
      best = excess;
      *seed =
          (fg_point){(x + o->x + 0.5) * FG_BLOCK_PX - 0.5, (y + o->y + 0.5) * FG_BLOCK_PX - 0.5};
    }
  return best > 0;
}

static void open_blocks(const fg_trace_walker *w, uint8_t *open) {
  const fg_object *o = w->object;
  for (int32_t y = 0; y < o->height; y++)
    for (int32_t x = 0; x < o->width; x++)
      open[(size_t)y * (size_t)o->width + (size_t)x] =
          fg_segmentation_label(w->segmentation, x + o->x, y + o->y) == o->label;
}

static void free_trace(fg_trace *trace) {
  free(trace->points);
  memset(trace, 0, sizeof *trace);
}

bool fg_trace_is_same(const fg_trace *a, const fg_trace *b) {
  const fg_trace *brief = a->count < b->count ? a : b, *full = brief == a ? b : a;
  double limit = 0.25 * full->width_px * full->width_px;
  size_t on = 0;
  for (size_t i = 0; i < brief->count; i++)
    for (size_t j = 0; j < full->count; j++) {
      double dx = brief->points[i].x - full->points[j].x;
      double dy = brief->points[i].y - full->points[j].y;
      if (dx * dx + dy * dy >= limit) continue;
      on++;
      break;
    }
  return (double)on > OVERLAP_SHARE * (double)brief->count;
}

/* Keeps a trace that is long enough for a strip; of one strip the longest trace stays. */
static void keep_or_drop(fg_trace *trace, fg_trace_list *list) {
  double length = 0;
  for (size_t k = 0; k < list->count; k++) {
    fg_trace *other = &list->traces[k];
    if (!fg_trace_is_same(trace, other)) continue;
    if (trace->count > other->count) {
      fg_trace swap = *other;
      *other = *trace;
      *trace = swap;
    }
    free_trace(trace);
    return;
  }
  for (size_t i = 1; i < trace->count; i++)
    length += hypot(trace->points[i].x - trace->points[i - 1].x,
                    trace->points[i].y - trace->points[i - 1].y);
  if (trace->count < POINTS_MIN || length < LENGTH_MIN * trace->width_px)
    free_trace(trace);
  else
    list->traces[list->count++] = *trace;
}

fg_status fg_trace_object(fg_context *ctx, const fg_tiles *tiles,
                          const fg_segmentation *segmentation, const fg_object *object,
                          double width_px, fg_trace_list *list) {
  memset(list, 0, sizeof *list);
  fg_trace_walker w = {.tiles = tiles, .segmentation = segmentation, .object = object};
  uint8_t *open = NULL;
  fg_status status = FG_OK;
  fg_trace trace = {0};
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, (size_t)object->width * (size_t)object->height, 1, (void **)&open));
  FG_TRY_EXIT(fg_memory_allocate(ctx, STRIPS_MAX, sizeof *list->traces, (void **)&list->traces));
  open_blocks(&w, open);
  fg_point seed = {0, 0};
  int32_t left = object->blocks, little = (int32_t)(LENGTH_MIN * width_px / FG_BLOCK_PX);
  for (int i = 0; i < STRIPS_MAX && left > little && find_seed(&w, open, &seed); i++) {
    trace = (fg_trace){0};
    w.contrast = fg_trace_contrast_at(&w, seed);
    w.half_window_px = SEED_WINDOW_WIDTHS * width_px + SEED_WINDOW_PX;
    w.width_px = width_px;
    w.blur_sum = 0;
    w.blur_count = 0;
    FG_TRY_EXIT(fg_trace_from_seed(ctx, &w, seed, &trace));
    left = clear_along(&trace, &w, seed, open);
    keep_or_drop(&trace, list);
    trace = (fg_trace){0};
  }
  if (list->count > 1)
    for (size_t i = 0; i < list->count; i++)
      list->traces[i].facts |= FG_STRIP_TOUCHES_OTHER;
exit:
  free(open);
  free_trace(&trace);
  if (status != FG_OK) fg_trace_list_free(list);
  return status;
}

void fg_trace_list_free(fg_trace_list *list) {
  if (!list) return;
  for (size_t i = 0; i < list->count; i++)
    free_trace(&list->traces[i]);
  free(list->traces);
  memset(list, 0, sizeof *list);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dots, crosses and lines: objects of one size, darker or lighter than their surroundings. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "vision/grid.h"
#include "vision/mark_find.h"

/* Share of the cells that are darker (lighter) than the marks' level is read from; level of the
 * mask between background and marks; contrast below which there are no marks, counts. */
#define TAIL_SHARE   0.003
#define MASK_LEVEL   0.4
#define CONTRAST_MIN 12.0
enum { AREA_MIN = 5, LEVELS = 256 };
/* Areas of marks lie within this factor of each other; lines are as elongated as this. */
#define AREA_FACTOR    1.35
#define ELONGATION_MIN 3.0
/* Windows of fits: radii of a dot and pixels beside, share of a cross's arm and of a line. */
#define DOT_REACH   1.3
#define BESIDE_PX   5.0
#define CROSS_REACH 0.8
#define LINE_ALONG  0.38

/* An object of the mask, in cells. */
typedef struct mark_object {
  double area, x, y;       /* centroid */
  double xx, xy, yy;       /* second moments about it */
  double fourth[2], reach; /* of the fourfold direction; farthest cell */
  bool at_border;
} mark_object;

typedef struct object_search {
  const fg_reduced *picture;
  uint8_t *mask;   /* owned */
  int32_t *labels; /* owned */
  fg_blob *blobs;  /* owned */
  int32_t blob_count;
  mark_object *objects; /* owned */
  double level, contrast;
} object_search;

static void free_search(object_search *search) {
  free(search->mask);
  free(search->labels);
  free(search->blobs);
  free(search->objects);
}

/* Level of the picture's middle and of its darkest (way -1) or lightest places. */
static void find_levels(const fg_reduced *r, int way, double *level, double *contrast) {
  size_t histogram[LEVELS] = {0}, cells = (size_t)r->width * (size_t)r->height, sum = 0;
  for (size_t i = 0; i < cells; i++)
    histogram[r->cells[i]]++;
  int middle = 0, tail = way < 0 ? 0 : LEVELS - 1;
  for (sum = 0; sum + histogram[middle] < cells / 2; middle++)
    sum += histogram[middle];
  size_t wanted = (size_t)(TAIL_SHARE * (double)cells);
  for (sum = histogram[tail]; sum < wanted; sum += histogram[tail])
    tail -= way;
  *level = middle;
  *contrast = tail - middle;
}

static void add_cells(object_search *search) {
  const fg_reduced *r = search->picture;
  for (int32_t y = 0; y < r->height; y++)
    for (int32_t x = 0; x < r->width; x++) {
      int32_t label = search->labels[(size_t)y * (size_t)r->width + (size_t)x];
      if (!label) continue;
      mark_object *o = &search->objects[label - 1];
      o->area++;
      o->x += x;
      o->y += y;
    }
  for (int32_t i = 0; i < search->blob_count; i++) {
    mark_object *o = &search->objects[i];
    const fg_blob *b = &search->blobs[i];
    o->x /= o->area;
    o->y /= o->area;
    o->at_border =
        b->x == 0 || b->y == 0 || b->x + b->width >= r->width || b->y + b->height >= r->height;
  }
}

static void add_moments(object_search *search) {
  const fg_reduced *r = search->picture;
  for (int32_t y = 0; y < r->height; y++)
    for (int32_t x = 0; x < r->width; x++) {
      int32_t label = search->labels[(size_t)y * (size_t)r->width + (size_t)x];
      if (!label) continue;
      mark_object *o = &search->objects[label - 1];
      double dx = x - o->x, dy = y - o->y, distance = hypot(dx, dy);
      o->xx += dx * dx / o->area;
      o->xy += dx * dy / o->area;
      o->yy += dy * dy / o->area;
      o->reach = fmax(o->reach, distance);
      double angle = 4 * atan2(dy, dx);
      o->fourth[0] += distance * distance * cos(angle);
      o->fourth[1] += distance * distance * sin(angle);
    }
}

static fg_status label_objects(fg_context *ctx, int way, object_search *search) {
  const fg_reduced *r = search->picture;
  size_t w = (size_t)r->width, h = (size_t)r->height;
  find_levels(r, way, &search->level, &search->contrast);
  if (fabs(search->contrast) < CONTRAST_MIN) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, w * h, 1, (void **)&search->mask));
  FG_TRY(fg_memory_allocate(ctx, w * h, sizeof *search->labels, (void **)&search->labels));
  double limit = search->level + MASK_LEVEL * search->contrast;
  for (size_t i = 0; i < w * h; i++)
    search->mask[i] = way < 0 ? r->cells[i] < limit : r->cells[i] > limit;
  FG_TRY(fg_grid_label(ctx, search->mask, r->width, r->height, search->labels, &search->blobs,
                       &search->blob_count));
  FG_TRY(fg_memory_allocate(ctx, (size_t)search->blob_count, sizeof *search->objects,
                            (void **)&search->objects));
  add_cells(search);
  add_moments(search);
  return FG_OK;
}

/* Principal spreads of an object, cells: sd along and across. */
static void find_spreads(const mark_object *o, double *along, double *across, double *angle) {
  double middle = 0.5 * (o->xx + o->yy), half = hypot(0.5 * (o->xx - o->yy), o->xy);
  *along = sqrt(middle + half + 1.0 / 12);
  *across = sqrt(fmax(0, middle - half) + 1.0 / 12);
  *angle = 0.5 * atan2(2 * o->xy, o->xx - o->yy);
}

static bool can_be_mark(const mark_object *o, fg_mark_kind kind) {
  double along, across, angle;
  if (o->at_border || o->area < AREA_MIN) return false;
  find_spreads(o, &along, &across, &angle);
  if (kind == FG_MARKS_LINES) return along > ELONGATION_MIN * across;
  return along < 1.5 * across;
}

/* The area that most objects have; larger ones count more, for dust is small. Lines may be of
 * several lengths: their width decides. */
static double mark_size(const mark_object *o, fg_mark_kind kind) {
  double along, across, angle;
  if (kind != FG_MARKS_LINES) return o->area;
  find_spreads(o, &along, &across, &angle);
  return across * across;
}

static int compare_sizes(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static fg_status find_common_size(fg_context *ctx, const object_search *search, fg_mark_kind kind,
                                  double *size, double *score) {
  double *sizes;
  size_t count = 0;
  *size = *score = 0;
  FG_TRY(fg_memory_allocate(ctx, (size_t)search->blob_count, sizeof *sizes, (void **)&sizes));
  for (int32_t i = 0; i < search->blob_count; i++)
    if (can_be_mark(&search->objects[i], kind))
      sizes[count++] = mark_size(&search->objects[i], kind);
  fg_sort_items(sizes, count, sizeof *sizes, compare_sizes);
  for (size_t i = 0, low = 0, high = 0; i < count; i++) {
    while (sizes[low] * AREA_FACTOR < sizes[i])
      low++;
    while (high < count && sizes[high] <= sizes[i] * AREA_FACTOR)
      high++;
    double own = (double)(high - low) * sqrt(sizes[i]);
    if (own > *score) *score = own, *size = sizes[i];
  }
  free(sizes);
  return FG_OK;
}

static fg_mark_fit start_object(const object_search *search, const mark_object *o,
                                fg_mark_kind kind) {
  double cell = search->picture->cell_px, along, across, angle;
  fg_mark_fit start = {0};
  find_spreads(o, &along, &across, &angle);
  start.p[FG_MARK_X] = (o->x + 0.5) * cell - 0.5;
  start.p[FG_MARK_Y] = (o->y + 0.5) * cell - 0.5;
  start.p[FG_MARK_LEVEL] = search->level;
  start.p[FG_MARK_CONTRAST] = search->contrast;
  double *shape = &start.p[FG_MARK_SHAPE];
  if (kind == FG_MARKS_DOTS) {
    shape[0] = sqrt(o->area / M_PI) * cell;
    start.reach_px = DOT_REACH * shape[0] + BESIDE_PX;
  } else if (kind == FG_MARKS_CROSSES) {
    shape[0] = 0.25 * atan2(o->fourth[1], o->fourth[0]);
    shape[1] = shape[0] + M_PI / 2;
    shape[2] = fmax(0.5, o->area / (8 * o->reach)) * cell;
    start.reach_px = CROSS_REACH * o->reach * cell;
  } else {
    shape[0] = angle + M_PI / 2;
    shape[1] = sqrt(3) * across * cell;
    start.reach_px = 1.5 * shape[1] + BESIDE_PX;
    start.along_px = LINE_ALONG * sqrt(12) * along * cell;
  }
  return start;
}

static fg_status collect_objects(fg_context *ctx, const object_search *search, fg_mark_kind kind,
                                 double size, fg_mark_starts *found) {
  for (int32_t i = 0; i < search->blob_count; i++) {
    const mark_object *o = &search->objects[i];
    if (!can_be_mark(o, kind)) continue;
    double ratio = mark_size(o, kind) / size;
    if (ratio > AREA_FACTOR * AREA_FACTOR || ratio < 1 / (AREA_FACTOR * AREA_FACTOR)) continue;
    FG_TRY(fg_memory_reserve(ctx, found->count + 1, sizeof *found->list, &found->capacity,
                             (void **)&found->list));
    found->list[found->count++] = start_object(search, o, kind);
  }
  return FG_OK;
}

fg_status fg_mark_find_objects(fg_context *ctx, const fg_reduced *picture, fg_mark_kind kind,
                               fg_mark_starts *found) {
  object_search searches[2] = {{.picture = picture}, {.picture = picture}};
  double size[2] = {0}, score[2] = {0};
  fg_status status = FG_OK;
  *found = (fg_mark_starts){0};
  for (int i = 0; i < 2; i++) {
    FG_TRY_EXIT(label_objects(ctx, i ? 1 : -1, &searches[i]));
    if (searches[i].objects)
      FG_TRY_EXIT(find_common_size(ctx, &searches[i], kind, &size[i], &score[i]));
  }
  int best = score[1] > score[0];
  if (score[best] > 0) FG_TRY_EXIT(collect_objects(ctx, &searches[best], kind, size[best], found));
exit:
  free_search(&searches[0]);
  free_search(&searches[1]);
  return status;
}

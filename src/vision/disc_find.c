/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/disc_find.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/select.h"
#include "vision/cv_bridge.h"
#include "vision/disc_contour.h"
#include "vision/reduce.h"

enum { LEVELS = 32, LEVEL_STEP_MIN = 2, RARE_CELLS = 20, CELLS_MAX = 6000000, LEVELS_AGREE = 2 };

/* Circles of one level. */
typedef struct level_rounds {
  double level;
  fg_round *rounds;
  size_t count, capacity, rejected;
} level_rounds;

typedef struct search {
  const fg_pixel_shape *shape;
  fg_reduced picture;
  double min_px;
  level_rounds levels[LEVELS];
} search;

fg_pixel_shape fg_pixel_shape_of(const double dpi[2]) {
  double k = sqrt(dpi[1] / dpi[0]);
  return (fg_pixel_shape){.scale = {k, 1 / k}, .um = 25400 / sqrt(dpi[0] * dpi[1])};
}

/* Spreads levels over the picture's range, without a few cells at either end. */
static void choose_levels(search *s) {
  size_t counts[256] = {0}, n = (size_t)s->picture.width * (size_t)s->picture.height, sum = 0;
  int low = 0, high = 255;
  for (size_t i = 0; i < n; i++)
    counts[s->picture.cells[i]]++;
  while (low < 255 && (sum += counts[low]) <= RARE_CELLS)
    low++;
  for (sum = 0; high > low && (sum += counts[high]) <= RARE_CELLS;)
    high--;
  double step = fmax((double)(high - low) / LEVELS, LEVEL_STEP_MIN);
  for (int i = 0; i < LEVELS; i++)
    s->levels[i].level = low + (i + 0.5) * step;
}

/* Fills the outline in square px, without its part along the scan's border. */
static void fill_outline(const search *s, const fg_contours *c, size_t index, fg_outline *o) {
  const fg_reduced *p = &s->picture;
  o->count = 0;
  for (size_t i = c->starts[index]; i < c->starts[index + 1]; i++) {
    int32_t x = c->xy[2 * i], y = c->xy[2 * i + 1];
    if (x < 2 || y < 2 || x >= p->width - 2 || y >= p->height - 2) continue;
    double half = 0.5 * (p->cell_px - 1);
    o->points[o->count++] = (fg_point){(x * (double)p->cell_px + half) * s->shape->scale[0],
                                       (y * (double)p->cell_px + half) * s->shape->scale[1]};
  }
}

static fg_status extract_circles(fg_context *ctx, fg_outline *o, level_rounds *level) {
  fg_round round;
  size_t taken = 0;
  while (fg_outline_extract_circle(o, &round)) {
    FG_TRY(fg_memory_reserve(ctx, level->count + 1, sizeof *level->rounds, &level->capacity,
                             (void **)&level->rounds));
    level->rounds[level->count++] = round;
    taken++;
  }
  level->rejected += taken == 0;
  return FG_OK;
}

static fg_status search_level(fg_context *ctx, void *shared, size_t index) {
  search *s = shared;
  level_rounds *level = &s->levels[index];
  fg_contours contours = {0};
  const fg_reduced *p = &s->picture;
  fg_outline outline = {.cell = p->cell_px, .min_radius = s->min_px};
  fg_status status = FG_OK;
  int32_t min = (int32_t)fmax(4, 1.2 * s->min_px / p->cell_px);
  FG_TRY_EXIT(fg_cv_contours(ctx, p->cells, p->width, p->height, level->level, min, &contours));
  size_t points = contours.starts[contours.count];
  FG_TRY_EXIT(fg_memory_allocate(ctx, points, sizeof *outline.points, (void **)&outline.points));
  FG_TRY_EXIT(fg_memory_allocate(ctx, points, sizeof *outline.weights, (void **)&outline.weights));
  for (size_t i = 0; i < contours.count; i++) {
    fill_outline(s, &contours, i, &outline);
    FG_TRY_EXIT(extract_circles(ctx, &outline, level));
  }
exit:
  fg_contours_free(&contours);
  free(outline.points);
  free(outline.weights);
  return status;
}

/* All levels' circles in one list. */
static fg_status gather_rounds(fg_context *ctx, const search *s, fg_round **all, size_t *count) {
  *count = 0;
  for (int i = 0; i < LEVELS; i++)
    *count += s->levels[i].count;
  FG_TRY(fg_memory_allocate(ctx, *count, sizeof **all, (void **)all));
  fg_round *to = *all;
  for (int i = 0; i < LEVELS; i++)
    for (size_t k = 0; k < s->levels[i].count; k++)
      *to++ = s->levels[i].rounds[k];
  return FG_OK;
}

/* Returns true when two circles are outlines of one edge: outlines of gaps run one cell outside
 * those of bright areas. */
static bool is_same_edge(const fg_circle *a, const fg_circle *b, double cell) {
  double limit = cell + 0.015 * fmin(a->radius, b->radius);
  return hypot(a->x - b->x, a->y - b->y) <= limit && fabs(a->radius - b->radius) <= limit;
}

/* Returns true when two circles are views of one feature: two features lie apart, or one well
 * inside the other. */
static bool is_same_feature(const fg_circle *a, const fg_circle *b) {
  double distance = hypot(a->x - b->x, a->y - b->y);
  double small = fmin(a->radius, b->radius), large = fmax(a->radius, b->radius);
  return distance < 0.95 * (small + large) && distance + small > 0.85 * large;
}

/* Returns the number of levels that agree with a circle; cleaner outlines count for more. */
static double support_of(const fg_round *all, size_t count, size_t i, double cell, int *levels) {
  double sum = 0;
  *levels = 0;
  for (size_t k = 0; k < count; k++) {
    if (!is_same_edge(&all[i].circle, &all[k].circle, cell)) continue;
    sum += 1 / (1 + all[k].rms * all[k].rms / (cell * cell));
    ++*levels;
  }
  double ratio = all[i].rms / cell;
  return sum * (1 + 0.1 / (1 + ratio * ratio));
}

typedef struct ranked {
  double support;
  int levels;
  size_t index;
} ranked;

static int compare_ranked(const void *a, const void *b) {
  const ranked *x = a, *y = b;
  if (x->support != y->support) return (x->support < y->support) - (x->support > y->support);
  return (x->index > y->index) - (x->index < y->index);
}

static int compare_candidates(const void *a, const void *b) {
  const fg_circle *x = &((const fg_disc_candidate *)a)->circle;
  const fg_circle *y = &((const fg_disc_candidate *)b)->circle;
  if (x->y != y->y) return (x->y > y->y) - (x->y < y->y);
  return (x->x > y->x) - (x->x < y->x);
}

static void keep_best(const fg_round *all, const ranked *ranks, size_t count, double cell,
                      fg_disc_candidates *found) {
  for (size_t i = 0; i < count; i++) {
    const fg_circle *circle = &all[ranks[i].index].circle;
    bool free_place = ranks[i].levels >= LEVELS_AGREE;
    for (size_t k = 0; k < found->count && free_place; k++)
      free_place = !is_same_feature(circle, &found->list[k].circle);
    if (!free_place) continue;
    found->list[found->count++] = (fg_disc_candidate){
        .circle = *circle, .levels = ranks[i].levels, .u_px = 1.5 * cell + 0.02 * circle->radius};
  }
}

static fg_status choose_circles(fg_context *ctx, const search *s, fg_disc_candidates *found) {
  fg_round *all = NULL;
  ranked *ranks = NULL;
  size_t count;
  double cell = s->picture.cell_px;
  fg_status status = FG_OK;
  FG_TRY_EXIT(gather_rounds(ctx, s, &all, &count));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *ranks, (void **)&ranks));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *found->list, (void **)&found->list));
  for (size_t i = 0; i < count; i++) {
    ranks[i].index = i;
    ranks[i].support = support_of(all, count, i, cell, &ranks[i].levels);
  }
  fg_sort_items(ranks, count, sizeof *ranks, compare_ranked);
  keep_best(all, ranks, count, cell, found);
  fg_sort_items(found->list, found->count, sizeof *found->list, compare_candidates);
exit:
  free(all);
  free(ranks);
  return status;
}

fg_status fg_discs_find(fg_context *ctx, const fg_tiles *tiles, const fg_pixel_shape *shape,
                        double min_px, unsigned threads, fg_disc_candidates *found) {
  search s = {.shape = shape, .min_px = min_px};
  fg_status status = FG_OK;
  memset(found, 0, sizeof *found);
  FG_TRY_EXIT(fg_reduce(ctx, tiles, CELLS_MAX, &s.picture));
  choose_levels(&s);
  FG_TRY_EXIT(fg_parallel_run(ctx, threads, LEVELS, search_level, &s));
  FG_TRY_EXIT(choose_circles(ctx, &s, found));
  found->other_shapes = s.levels[LEVELS / 2].rejected;
exit:
  for (int i = 0; i < LEVELS; i++)
    free(s.levels[i].rounds);
  free(s.picture.cells);
  if (status != FG_OK) fg_disc_candidates_free(found);
  return status;
}

void fg_disc_candidates_free(fg_disc_candidates *found) {
  if (!found) return;
  free(found->list);
  memset(found, 0, sizeof *found);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "load_test/strokes.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/splitmix.h"
#include "load_test/usable.h"

/* A way back that is shorter than this share of the travel is noise, or a stop on the way. */
static const double turn_share = 0.1;

/* Minimum number of samples of a stroke for a profile and its scatter. */
enum { STROKE_SAMPLES_MIN = 24 };

void fg_load_stroke_free(fg_load_stroke *stroke) {
  free(stroke->x);
  free(stroke->f);
  free(stroke->variance);
  free(stroke->scatter);
  free(stroke->after_hole);
  *stroke = (fg_load_stroke){0};
}

void fg_load_strokes_free(fg_load_strokes *strokes) {
  for (size_t i = 0; i < strokes->count; i++)
    fg_load_stroke_free(&strokes->stroke[i]);
  free(strokes->stroke);
  free(strokes->left_out);
  *strokes = (fg_load_strokes){0};
}

static fg_status allocate_stroke(fg_context *ctx, size_t count, fg_load_stroke *stroke) {
  stroke->count = count;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *stroke->x, (void **)&stroke->x));
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *stroke->f, (void **)&stroke->f));
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *stroke->scatter, (void **)&stroke->scatter));
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *stroke->after_hole, (void **)&stroke->after_hole));
  return fg_memory_allocate(ctx, count, sizeof *stroke->variance, (void **)&stroke->variance);
}

/* Scatter of a sample about the line between its neighbours (T. Gasser, L. Sroka, C.
 * Jennen-Steinmetz, Residual variance and residual pattern in nonlinear regression, Biometrika 73,
 * 1986). */
static void find_scatter(fg_load_stroke *s) {
  for (size_t i = 1; i + 1 < s->count; i++) {
    double span = s->x[i + 1] - s->x[i - 1];
    double a = span > 0 ? (s->x[i + 1] - s->x[i]) / span : 0.5, b = 1 - a;
    double off = a * s->f[i - 1] + b * s->f[i + 1] - s->f[i];
    s->scatter[i] = off * off / (a * a + b * b + 1);
  }
}

/* A number that follows from a sample's place in the record and from nothing else. */
static uint64_t shuffled(size_t i) {
  uint64_t state = (uint64_t)i;
  return fg_splitmix_next(&state);
}

typedef struct placed {
  double x, f;
  uint64_t order;
} placed;

/* Orders samples by displacement alone. Of a rounded column many samples have one displacement:
 * ordered by force, or by time, neighbours would differ less than the scatter. */
static int by_x(const void *left, const void *right) {
  const placed *a = left, *b = right;
  if (a->x != b->x) return a->x < b->x ? -1 : 1;
  return (a->order > b->order) - (a->order < b->order);
}

/* Record that is being cut. */
typedef struct cutting {
  const fg_load_sample *samples;
  size_t begin, end, record;
  double depth_mm; /* of loops on the way */
  bool found_loops;
  fg_load_strokes *strokes;
} cutting;

static size_t count_usable(const cutting *c, const fg_load_stroke *stroke) {
  size_t count = 0;
  for (size_t i = stroke->first; i <= stroke->last; i++)
    count += !c->strokes->left_out[i];
  return count;
}

static fg_status fill_stroke(fg_context *ctx, const cutting *c, size_t count,
                             fg_load_stroke *stroke) {
  placed *sorted = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(allocate_stroke(ctx, count, stroke));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *sorted, (void **)&sorted));
  for (size_t i = stroke->first, n = 0; i <= stroke->last; i++) {
    const fg_load_sample *s = &c->samples[i];
    if (!c->strokes->left_out[i]) sorted[n++] = (placed){s->x_mm, s->force_n, shuffled(i)};
  }
  fg_sort_items(sorted, count, sizeof *sorted, by_x);
  for (size_t i = 0; i < count; i++) {
    stroke->x[i] = sorted[i].x;
    stroke->f[i] = sorted[i].f;
  }
  find_scatter(stroke);
exit:
  free(sorted);
  return status;
}

static fg_status add_stroke(fg_context *ctx, cutting *c, size_t first, size_t last, int sense) {
  fg_load_strokes *strokes = c->strokes;
  fg_load_stroke stroke = {.first = first,
                           .last = last,
                           .begin = c->begin,
                           .end = c->end,
                           .sense = sense,
                           .record = c->record};
  if (last <= first) return FG_OK;
  if (fg_load_mark_loops(c->samples, first, last, sense, c->depth_mm, c->strokes->left_out))
    c->found_loops = true;
  size_t count = count_usable(c, &stroke);
  if (count < STROKE_SAMPLES_MIN) return FG_OK;
  FG_TRY(fg_memory_reserve(ctx, strokes->count + 1, sizeof *strokes->stroke, &strokes->capacity,
                           (void **)&strokes->stroke));
  strokes->stroke[strokes->count++] = stroke;
  return fill_stroke(ctx, c, count, &strokes->stroke[strokes->count - 1]);
}

/* Cuts strokes of one record: from one extreme to the next at a distance of at least `way`. */
static fg_status cut_record(fg_context *ctx, cutting *c, double way) {
  const fg_load_sample *samples = c->samples;
  size_t start = c->begin, low = start, high = start;
  int sense = 0;
  for (size_t i = c->begin; i < c->end; i++) {
    if (samples[i].x_mm < samples[low].x_mm) low = i;
    if (samples[i].x_mm > samples[high].x_mm) high = i;
    bool up = samples[i].x_mm - samples[low].x_mm > way;
    bool down = samples[high].x_mm - samples[i].x_mm > way;
    if (sense >= 0 && down) { /* turned at `high` */
      FG_TRY(add_stroke(ctx, c, start, high, 1));
      start = high, low = i, sense = -1;
    } else if (sense <= 0 && up) {
      FG_TRY(add_stroke(ctx, c, start, low, -1));
      start = low, high = i, sense = 1;
    }
  }
  if (!sense) return FG_OK;
  return add_stroke(ctx, c, start, sense > 0 ? high : low, sense);
}

fg_status fg_load_strokes_cut(fg_context *ctx, const fg_load_test *test,
                              fg_load_direction *direction, const fg_load_records *records,
                              fg_load_strokes *strokes) {
  size_t end = direction->first + direction->count;
  cutting c = {.samples = test->samples + direction->first, .strokes = strokes};
  *strokes = (fg_load_strokes){0};
  FG_TRY(fg_memory_allocate(ctx, direction->count, sizeof *strokes->left_out,
                            (void **)&strokes->left_out));
  fg_load_mark_saturated(test, direction, strokes->left_out);
  FG_TRY(fg_load_find_depth(ctx, test, direction, &c.depth_mm));
  for (size_t i = 0; i < records->count; i++) {
    size_t from = records->begin[i];
    if (from < direction->first || from >= end) continue;
    size_t to = i + 1 < records->count && records->begin[i + 1] < end ? records->begin[i + 1] : end;
    c.begin = from - direction->first, c.end = to - direction->first, c.record = i;
    FG_TRY(cut_record(ctx, &c, turn_share * direction->travel_mm));
  }
  if (c.found_loops) direction->flags |= FG_LOAD_LOOPS;
  return FG_OK;
}

/* Sample with its variance and drift. */
typedef struct cell {
  double x, f, variance, scatter;
  uint64_t order;
} cell;

static int by_cell(const void *left, const void *right) {
  const cell *a = left, *b = right;
  if (a->x != b->x) return a->x < b->x ? -1 : 1;
  return (a->order > b->order) - (a->order < b->order);
}

double fg_load_stroke_drifted(const fg_load_stroke *stroke, double share) {
  return stroke->shift_mm + stroke->drift_mm * (share - 0.5);
}

double fg_load_stroke_turn(const fg_load_stroke *stroke, bool high) {
  bool end = high == (stroke->sense > 0);
  return (high ? stroke->high_mm : stroke->low_mm) - fg_load_stroke_drifted(stroke, end ? 1 : 0);
}

/* Samples of a stroke follow each other at even times. */
static double without_drift(const fg_load_stroke *s, size_t k) {
  double share = ((double)k + 0.5) / (double)s->count;
  return s->x[k] - fg_load_stroke_drifted(s, s->sense > 0 ? share : 1 - share);
}

fg_status fg_load_strokes_merge(fg_context *ctx, const fg_load_stroke *const *chosen, size_t count,
                                fg_load_stroke *merged) {
  cell *cells = NULL;
  size_t total = 0, n = 0;
  fg_status status = FG_OK;
  *merged = (fg_load_stroke){.sense = count ? chosen[0]->sense : 0,
                             .resolution_mm = count ? chosen[0]->resolution_mm : 0};
  for (size_t i = 0; i < count; i++)
    total += chosen[i]->count;
  FG_TRY_EXIT(allocate_stroke(ctx, total, merged));
  FG_TRY_EXIT(fg_memory_allocate(ctx, total, sizeof *cells, (void **)&cells));
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < chosen[i]->count; k++, n++)
      cells[n] = (cell){without_drift(chosen[i], k), chosen[i]->f[k], chosen[i]->variance[k],
                        chosen[i]->scatter[k], shuffled(n)};
  fg_sort_items(cells, total, sizeof *cells, by_cell);
  for (size_t i = 0; i < total; i++) {
    merged->x[i] = cells[i].x;
    merged->f[i] = cells[i].f;
    merged->variance[i] = cells[i].variance;
    merged->scatter[i] = cells[i].scatter;
  }
  fg_load_stroke_find_holes(merged);
exit:
  free(cells);
  return status;
}

fg_status fg_load_strokes_merge_sense(fg_context *ctx, const fg_load_strokes *strokes, int sense,
                                      fg_load_stroke *merged) {
  const fg_load_stroke **chosen;
  size_t count = 0;
  FG_TRY(fg_memory_allocate(ctx, strokes->count, sizeof *chosen, (void **)&chosen));
  for (size_t i = 0; i < strokes->count; i++)
    if (strokes->stroke[i].sense == sense) chosen[count++] = &strokes->stroke[i];
  fg_status status = fg_load_strokes_merge(ctx, chosen, count, merged);
  free(chosen);
  return status;
}

size_t fg_load_stroke_from(const fg_load_stroke *stroke, double x) {
  size_t low = 0, high = stroke->count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (stroke->x[middle] < x)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

fg_status fg_load_stroke_half(fg_context *ctx, const fg_load_stroke *stroke, size_t from,
                              fg_load_stroke *half) {
  *half = *stroke;
  half->x = half->f = half->variance = half->scatter = NULL;
  half->after_hole = NULL;
  FG_TRY(allocate_stroke(ctx, (stroke->count - from + 1) / 2, half));
  for (size_t i = 0; i < half->count; i++) {
    half->x[i] = stroke->x[2 * i + from];
    half->f[i] = stroke->f[2 * i + from];
    half->variance[i] = stroke->variance[2 * i + from];
    half->scatter[i] = stroke->scatter[2 * i + from];
  }
  fg_load_stroke_find_holes(half);
  return FG_OK;
}

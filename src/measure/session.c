#include "measure/session.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "vision/edges.h"
#include "vision/segment.h"
#include "vision/trace.h"

enum { WORKERS_MAX = 63 };
/* An object smaller than this share of the design's bump radius is dust. */
#define OBJECT_LEAST 1.0
/* A strip without bumps is a foil that failed when its width is the design's within this factor,
 * and some other thing (a scratch, a hair) when it is not. */
#define WIDTH_FACTOR 1.6

struct fg_session {
  fg_measurement *measurement;
  fg_tiles *tiles;
  fg_islands *islands;
  unsigned threads;
  fg_thread workers[WORKERS_MAX];
  unsigned worker_count;
  pthread_mutex_t lock; /* of everything below */
  pthread_cond_t changed;
  fg_island *queue;
  size_t queued, queue_capacity, taken, done;
  bool ended; /* nothing more will be queued */
  fg_status status;
  fg_context context;
  size_t light, dark; /* islands by polarity */
  size_t foil_capacity;
};

/* Puts a measured foil into the results; on failure it is freed. */
static fg_status add_foil(fg_context *ctx, fg_session *s, fg_foil *foil) {
  fg_measurement *m = s->measurement;
  pthread_mutex_lock(&s->lock);
  fg_status status = fg_memory_reserve(ctx, m->foil_count + 1, sizeof *m->foils,
                                       &s->foil_capacity, (void **)&m->foils);
  if (status == FG_OK) m->foils[m->foil_count++] = *foil;
  pthread_mutex_unlock(&s->lock);
  if (status != FG_OK) fg_foil_free(foil);
  return status;
}

static void count_specks(fg_session *s, size_t specks) {
  pthread_mutex_lock(&s->lock);
  s->measurement->specks += specks;
  pthread_mutex_unlock(&s->lock);
}

static void box_from_trace(const fg_trace *trace, int64_t box[4]) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (size_t i = 0; i < trace->count; i++) {
    low[0] = fmin(low[0], trace->points[i].x);
    low[1] = fmin(low[1], trace->points[i].y);
    high[0] = fmax(high[0], trace->points[i].x);
    high[1] = fmax(high[1], trace->points[i].y);
  }
  for (int k = 0; k < 2; k++) {
    box[k] = (int64_t)floor(low[k]);
    box[2 + k] = (int64_t)ceil(high[k] - low[k]) + 1;
  }
}

static double expected_width_px(const fg_measurement *m) {
  return m->design.thickness_mm * sqrt(m->dpi[0] * m->dpi[1]) / 25.4;
}

/* A foil from one trace. What cannot be measured is a flag; what is no foil is a speck. */
static fg_status measure_trace(fg_context *ctx, fg_session *s, const fg_segmentation *seg,
                               const fg_trace *trace) {
  const fg_measurement *m = s->measurement;
  fg_foil foil = {0};
  fg_status status =
      fg_edges_measure(ctx, s->tiles, seg, trace, m->dpi, s->threads, &foil.strip);
  if (status == FG_OK) status = fg_foil_measure(ctx, &m->design, s->threads, &foil);
  if (status == FG_ERR_NUMERIC) {
    foil.flags |= FG_FOIL_NOT_MEASURED;
    snprintf(foil.error, sizeof foil.error, "%.255s", ctx->message);
    box_from_trace(trace, foil.strip.box_px);
    status = FG_OK;
  }
  double ratio = trace->width_px / expected_width_px(m);
  bool other = foil.flags & FG_FOIL_NOT_MEASURED && !foil.bump_count &&
               (ratio > WIDTH_FACTOR || ratio < 1 / WIDTH_FACTOR);
  if (status != FG_OK || other) {
    fg_foil_free(&foil);
    if (other) count_specks(s, 1);
    return status;
  }
  return add_foil(ctx, s, &foil);
}

static fg_status measure_objects(fg_context *ctx, fg_session *s, const fg_segmentation *seg) {
  fg_trace_list list = {0};
  fg_status status = FG_OK;
  for (size_t i = 0; i < seg->object_count && status == FG_OK; i++) {
    status = fg_trace_object(ctx, s->tiles, seg, &seg->objects[i],
                             expected_width_px(s->measurement), &list);
    if (status == FG_OK && !list.count) count_specks(s, 1);
    for (size_t j = 0; j < list.count && status == FG_OK; j++)
      status = measure_trace(ctx, s, seg, &list.traces[j]);
    fg_trace_list_free(&list);
  }
  return status;
}

static fg_status measure_island(fg_context *ctx, fg_session *s, const fg_island *island) {
  const fg_measurement *m = s->measurement;
  double px_per_mm = sqrt(m->dpi[0] * m->dpi[1]) / 25.4;
  double least_px = OBJECT_LEAST * m->design.bump_radius_mm * px_per_mm;
  if (hypot(island->width, island->height) * FG_TILE_PX < least_px) {
    count_specks(s, 1);
    return FG_OK;
  }
  fg_segmentation seg;
  FG_TRY(fg_segment(ctx, s->tiles, island, least_px, &seg));
  count_specks(s, seg.speck_count);
  pthread_mutex_lock(&s->lock);
  if (seg.object_count) *(seg.light_on_dark ? &s->light : &s->dark) += 1;
  pthread_mutex_unlock(&s->lock);
  fg_status status = measure_objects(ctx, s, &seg);
  fg_segmentation_free(&seg);
  return status;
}

/* The next island of the queue; waits for one while more may come. */
static bool take_island(fg_session *s, bool wait, fg_island *island) {
  pthread_mutex_lock(&s->lock);
  while (wait && s->taken == s->queued && !s->ended && s->status == FG_OK)
    pthread_cond_wait(&s->changed, &s->lock);
  bool got = s->taken < s->queued && s->status == FG_OK;
  if (got) *island = s->queue[s->taken++];
  pthread_mutex_unlock(&s->lock);
  return got;
}

static void finish_island(fg_session *s, fg_island *island, const fg_context *ctx,
                          fg_status status) {
  pthread_mutex_lock(&s->lock);
  fg_island_drop(s->tiles, island);
  s->done++;
  if (status != FG_OK && s->status == FG_OK) {
    s->status = status;
    s->context = *ctx;
  }
  pthread_cond_broadcast(&s->changed);
  pthread_mutex_unlock(&s->lock);
  fg_island_free(island);
}

static void work_on_islands(fg_session *s, bool wait) {
  fg_island island;
  while (take_island(s, wait, &island)) {
    fg_context ctx = {.message = ""};
    fg_status status = measure_island(&ctx, s, &island);
    finish_island(s, &island, &ctx, status);
  }
}

static void *run_worker(void *session) {
  work_on_islands(session, true);
  return NULL;
}

fg_status fg_session_create(fg_context *ctx, fg_measurement *measurement, fg_tiles *tiles,
                            unsigned threads, fg_session **session) {
  *session = NULL;
  fg_session *s = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *s, (void **)&s));
  s->measurement = measurement;
  s->tiles = tiles;
  s->threads = threads ? threads : (unsigned)sysconf(_SC_NPROCESSORS_ONLN);
  pthread_mutex_init(&s->lock, NULL);
  pthread_cond_init(&s->changed, NULL);
  *session = s;
  return FG_OK;
}

/* Islands are made from the tiles' size, which is known with the first strip. Workers start with
 * the first island: most scans need none before their end. */
static fg_status start_workers(fg_session *s) {
  while (s->worker_count + 1 < s->threads && s->worker_count < WORKERS_MAX &&
         fg_thread_start(&s->workers[s->worker_count], run_worker, s) == FG_OK)
    s->worker_count++;
  return FG_OK;
}

static fg_status push_island(fg_context *ctx, fg_session *s, const fg_island *island) {
  pthread_mutex_lock(&s->lock);
  fg_status status = s->status;
  if (status != FG_OK)
    fg_fail(ctx, status, "%s", s->context.message);
  else
    status = fg_memory_reserve(ctx, s->queued + 1, sizeof *s->queue, &s->queue_capacity,
                               (void **)&s->queue);
  if (status == FG_OK) s->queue[s->queued++] = *island;
  pthread_cond_signal(&s->changed);
  pthread_mutex_unlock(&s->lock);
  return status;
}

fg_status fg_session_advance(fg_context *ctx, fg_tiles *tiles, void *session) {
  fg_session *s = session;
  fg_island island;
  if (!s->islands) FG_TRY(fg_islands_create(ctx, tiles, &s->islands));
  FG_TRY(fg_islands_advance(ctx, s->islands));
  while (fg_islands_next(s->islands, &island)) {
    fg_status status = push_island(ctx, s, &island);
    if (status != FG_OK) {
      fg_island_free(&island);
      return status;
    }
    bool reading = tiles->received < tiles->rows;
    if (!s->worker_count && reading) FG_TRY(start_workers(s));
  }
  return FG_OK;
}

static int compare_boxes(const void *a, const void *b) {
  const int64_t *p = ((const fg_foil *)a)->strip.box_px, *q = ((const fg_foil *)b)->strip.box_px;
  if (p[1] != q[1]) return (p[1] > q[1]) - (p[1] < q[1]);
  return (p[0] > q[0]) - (p[0] < q[0]);
}

static int compare_columns(const void *a, const void *b) {
  const int64_t *p = ((const fg_foil *)a)->strip.box_px, *q = ((const fg_foil *)b)->strip.box_px;
  if (p[0] != q[0]) return (p[0] > q[0]) - (p[0] < q[0]);
  return (p[1] > q[1]) - (p[1] < q[1]);
}

/* Foils whose middle lies within the first foil's height are one row of the bed. */
static void sort_foils(fg_measurement *m) {
  if (!m->foil_count) return;
  qsort(m->foils, m->foil_count, sizeof *m->foils, compare_boxes);
  for (size_t first = 0; first < m->foil_count;) {
    int64_t low = m->foils[first].strip.box_px[1] + m->foils[first].strip.box_px[3];
    size_t next = first + 1;
    while (next < m->foil_count &&
           m->foils[next].strip.box_px[1] + m->foils[next].strip.box_px[3] / 2 < low)
      next++;
    qsort(m->foils + first, next - first, sizeof *m->foils, compare_columns);
    first = next;
  }
  for (size_t i = 0; i < m->foil_count; i++) m->foils[i].number = (int)i + 1;
}

/* No more islands: the workers run out and end. */
static void end_work(fg_session *s) {
  pthread_mutex_lock(&s->lock);
  s->ended = true;
  pthread_cond_broadcast(&s->changed);
  pthread_mutex_unlock(&s->lock);
}

fg_status fg_session_finish(fg_context *ctx, fg_session *s) {
  end_work(s);
  work_on_islands(s, false);
  for (unsigned i = 0; i < s->worker_count; i++) fg_thread_join(&s->workers[i]);
  s->worker_count = 0;
  if (s->status != FG_OK) return fg_fail(ctx, s->status, "%s", s->context.message);
  s->measurement->light_on_dark = s->light >= s->dark;
  sort_foils(s->measurement);
  return FG_OK;
}

void fg_session_free(fg_session *s) {
  if (!s) return;
  pthread_mutex_lock(&s->lock);
  if (s->status == FG_OK) s->status = FG_ERR_INTERRUPTED; /* queued islands are left */
  pthread_mutex_unlock(&s->lock);
  end_work(s);
  for (unsigned i = 0; i < s->worker_count; i++) fg_thread_join(&s->workers[i]);
  for (size_t i = s->taken; i < s->queued; i++) fg_island_free(&s->queue[i]);
  free(s->queue);
  fg_islands_free(s->islands);
  pthread_mutex_destroy(&s->lock);
  pthread_cond_destroy(&s->changed);
  free(s);
}

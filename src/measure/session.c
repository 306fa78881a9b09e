/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/session.h"
#include "geometry/foil_kind.h"
#include "measure/loss.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/select.h"
#include "measure/beams.h"
#include "measure/gauges.h"
#include "measure/place.h"
#include "vision/anchor.h"
#include "vision/edges.h"
#include "vision/island_split.h"
#include "vision/segment.h"
#include "vision/trace.h"

enum { WORKERS_MAX = 63 };
/* A strip without bumps is a foil that failed when its width is the design's within this factor,
 * and a scratch or a hair when it is not. */
#define WIDTH_FACTOR 1.6

/* A foil that lies this many strip widths from the scan's border may be cut by it. */
#define BORDER_WIDTHS 2.0

/* The reader helps when islands wait with more than this: workers that fall behind would otherwise
 * fill the memory with tiles. */
#define WAITING_BYTES_MAX ((size_t)32 << 20)

/* An island on its way through a worker. */
typedef struct job {
  fg_island island;
  fg_tiles view;
  int64_t origin_px[2];
  double background; /* form cantilever: level of the scan's border */
  size_t number;     /* of the island, in the order in which they are read */
} job;

struct fg_session {
  fg_measurement *measurement;
  fg_islands *islands;
  unsigned threads;
  bool plain;
  fg_thread workers[WORKERS_MAX];
  unsigned worker_count;
  pthread_mutex_t lock; /* of everything below */
  pthread_cond_t changed;
  job *queue;
  size_t queued, queue_capacity, taken;
  size_t waiting_bytes; /* of the jobs that are queued and not taken */
  bool ended;           /* nothing more will be queued */
  fg_status status;
  fg_context context;
  size_t light, dark;   /* tiles of islands by polarity */
  fg_flat_parts *parts; /* form cantilever: of each island of the queue, so that sums over them do
                           not depend on the order in which threads have measured them */
  size_t parts_capacity;
  fg_gauge_sightings sightings;
  size_t foil_capacity;
};

/* Puts a measured foil into the results; on failure it is freed. */
static fg_status append_foil(fg_context *ctx, fg_session *s, fg_foil *foil) {
  fg_measurement *m = s->measurement;
  pthread_mutex_lock(&s->lock);
  fg_status status = fg_memory_reserve(ctx, m->foil_count + 1, sizeof *m->foils, &s->foil_capacity,
                                       (void **)&m->foils);
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

static const fg_foil_traits *kind_of(const fg_measurement *m) {
  return fg_foil_traits_of(m->design.kind);
}

static double expected_width_px(const fg_measurement *m) {
  return m->design.thickness_mm * sqrt(m->dpi[0] * m->dpi[1]) / 25.4;
}

/* Diagonal of the smallest object that may be a foil. */
static double min_foil_px(const fg_measurement *m) {
  return fg_foil_row_of(m->design.kind)->min_object_mm(&m->design) * sqrt(m->dpi[0] * m->dpi[1]) /
         25.4;
}

/* Of the smallest that is no dust: a foil or a gauge. */
static double min_object_px(const fg_measurement *m) {
  return fmin(min_foil_px(m), fg_gauge_min_px(m));
}

/* Of a file that says itself that it is a JPEG, or of one whose pixels do. */
static void find_loss(const fg_measurement *m, fg_strip *strip) {
  int quality = m->file.jpeg_quality ? m->file.jpeg_quality : strip->picture.block_quality;
  double um = 25400 / sqrt(m->dpi[0] * m->dpi[1]);
  double blur_px = 0.5 * (strip->blur_left_um + strip->blur_right_um) / um;
  strip->loss_variance = fg_loss_arc_variance(quality);
  strip->loss_um = um * fg_loss_edge_px(quality, 255 * strip->contrast, blur_px);
}

/* Measures a foil from one trace. Values that cannot be measured are flagged; other objects are
 * specks. */
static fg_status measure_trace(fg_context *ctx, fg_session *s, const job *j,
                               const fg_segmentation *seg, const fg_trace *trace) {
  const fg_measurement *m = s->measurement;
  fg_foil foil = {0};
  const fg_edge_options edges = {.dpi = m->dpi,
                                 .threads = s->threads,
                                 .linear = m->design.tone == FG_TONE_LINEAR,
                                 .plain = s->plain || m->design.gauge_count};
  fg_status status = fg_edges_measure(ctx, &j->view, seg, trace, &edges, &foil.strip);
  find_loss(m, &foil.strip);
  if (status == FG_OK) status = fg_foil_measure(ctx, &m->design, s->threads, &foil);
  if (status == FG_ERR_NUMERIC) {
    fg_foil_give_up(&foil, ctx->message);
    fg_place_from_trace(trace, &foil);
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
  fg_place_move(j->origin_px, m->dpi, &foil);
  return append_foil(ctx, s, &foil);
}

/* Traces of an island's objects that are measured already. */
typedef struct traced {
  fg_trace_list *lists; /* one per object */
  size_t count;
} traced;

/* A gap parts a strip into two objects, and each one's trace runs over it along the whole strip. */
static bool is_traced(const traced *done, const fg_trace *trace) {
  for (size_t i = 0; i + 1 < done->count; i++) /* the last one is its own object's */
    for (size_t k = 0; k < done->lists[i].count; k++)
      if (fg_trace_is_same(&done->lists[i].traces[k], trace)) return true;
  return false;
}

static fg_status keep_sightings(fg_context *ctx, fg_session *s, fg_gauge_sightings *seen) {
  fg_status status = FG_OK;
  pthread_mutex_lock(&s->lock);
  for (size_t i = 0; i < seen->count && status == FG_OK; i++)
    status = fg_gauge_sightings_add(ctx, &s->sightings, &seen->list[i]);
  pthread_mutex_unlock(&s->lock);
  seen->count = 0;
  return status;
}

/* Object that a trace shows: a gauge, or a foil. */
static fg_status measure_gauge_or_foil(fg_context *ctx, fg_session *s, const job *j,
                                       const fg_gauge_object *object, const fg_trace *trace,
                                       fg_gauge_sightings *seen) {
  bool taken;
  FG_TRY(fg_gauge_test_leaf(ctx, object, trace, s->threads, seen, &taken));
  return taken ? FG_OK : measure_trace(ctx, s, j, object->segmentation, trace);
}

static fg_status measure_object(fg_context *ctx, fg_session *s, const job *j,
                                const fg_segmentation *seg, size_t i, traced *done,
                                fg_gauge_sightings *seen) {
  const fg_gauge_object object = {s->measurement, &j->view, seg, &seg->objects[i], j->origin_px};
  fg_trace_list *list = &done->lists[done->count++];
  double diagonal = FG_BLOCK_PX * hypot(object.object->width, object.object->height);
  bool taken = false, sought = s->measurement->design.gauge_count > 0;
  if (sought) FG_TRY(fg_gauge_find_round(ctx, &object, seen, &taken));
  if (taken) return FG_OK;
  if (diagonal >= min_foil_px(s->measurement))
    FG_TRY(fg_trace_object(ctx, &j->view, seg, object.object, expected_width_px(s->measurement),
                           list));
  for (size_t k = 0; k < list->count; k++)
    if (!is_traced(done, &list->traces[k]))
      FG_TRY(measure_gauge_or_foil(ctx, s, j, &object, &list->traces[k], seen));
  if (!list->count && sought) FG_TRY(fg_gauge_trace_leaf(ctx, &object, s->threads, seen, &taken));
  if (!list->count && !taken) count_specks(s, 1);
  return FG_OK;
}

static fg_status measure_objects(fg_context *ctx, fg_session *s, const job *j,
                                 const fg_segmentation *seg) {
  traced done = {0};
  fg_gauge_sightings seen = {0};
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, seg->object_count, sizeof *done.lists, (void **)&done.lists));
  for (size_t i = 0; i < seg->object_count && status == FG_OK; i++)
    status = measure_object(ctx, s, j, seg, i, &done, &seen);
  if (status == FG_OK) status = keep_sightings(ctx, s, &seen);
  free(seen.list);
  for (size_t i = 0; i < seg->object_count; i++)
    fg_trace_list_free(&done.lists[i]);
  free(done.lists);
  return status;
}

static void free_job(job *j) {
  fg_tiles_free(&j->view);
  fg_island_free(&j->island);
}

/* Puts the island on tiles of its own. */
static fg_status anchor_job(fg_context *ctx, fg_session *s, job *j) {
  const fg_anchor_options options = {.min_px = min_object_px(s->measurement),
                                     .border_px = BORDER_WIDTHS * expected_width_px(s->measurement),
                                     .threads = s->threads};
  fg_anchored a;
  FG_TRY(fg_anchor_island(ctx, &j->view, &j->island, &options, &a));
  if (!a.anchored) return FG_OK;
  free_job(j);
  j->view = a.view;
  j->island = a.island;
  for (int k = 0; k < 2; k++)
    j->origin_px[k] += a.corner_px[k];
  count_specks(s, a.specks);
  return FG_OK;
}

/* Its edges lie where its pixels have them, wherever tiles' corners are: it needs no anchor. */
static fg_status measure_flat(fg_context *ctx, fg_session *s, const job *j) {
  fg_flat_parts parts = {0};
  const fg_flat_island island = {&j->view, &j->island, j->origin_px, j->background};
  fg_status status = fg_flat_island_measure(ctx, &island, s->measurement, s->threads, &parts);
  pthread_mutex_lock(&s->lock);
  if (status == FG_OK) status = fg_flat_parts_move(ctx, &parts, &s->parts[j->number]);
  pthread_mutex_unlock(&s->lock);
  fg_flat_parts_free(&parts);
  return status;
}

/* Measures an island that holds one object, or objects too near to each other to be parted. */
static fg_status measure_anchored(fg_context *ctx, fg_session *s, job *j) {
  fg_segmentation seg;
  FG_TRY(anchor_job(ctx, s, j));
  FG_TRY(fg_segment(ctx, &j->view, &j->island, min_object_px(s->measurement), &seg));
  count_specks(s, seg.speck_count);
  pthread_mutex_lock(&s->lock);
  if (seg.object_count) *(seg.light_on_dark ? &s->light : &s->dark) += j->island.count;
  pthread_mutex_unlock(&s->lock);
  fg_status status = measure_objects(ctx, s, j, &seg);
  fg_segmentation_free(&seg);
  return status;
}

/* Cuts one part of an island out of the island's view, as that was cut out of the scan. */
static fg_status measure_part(fg_context *ctx, fg_session *s, job *whole, fg_island *island) {
  job part = {.island = *island};
  memset(island, 0, sizeof *island);
  fg_status status = fg_island_cut(ctx, &whole->view, &part.island, &part.view, part.origin_px);
  for (int k = 0; k < 2; k++)
    part.origin_px[k] += whole->origin_px[k];
  if (status == FG_OK) status = measure_anchored(ctx, s, &part);
  free_job(&part);
  return status;
}

static fg_status measure_island(fg_context *ctx, fg_session *s, job *j) {
  const fg_measurement *m = s->measurement;
  const fg_island_split_options options = {.min_px = min_object_px(m),
                                           .gap_px = FG_TRACE_GAP_WIDTHS * expected_width_px(m)};
  fg_island_list parts;
  if (kind_of(m)->lies_flat) return measure_flat(ctx, s, j);
  FG_TRY(fg_island_split(ctx, &j->view, &j->island, &options, &parts));
  count_specks(s, parts.specks);
  fg_status status = parts.count ? FG_OK : measure_anchored(ctx, s, j);
  for (size_t i = 0; i < parts.count && status == FG_OK; i++)
    status = measure_part(ctx, s, j, &parts.list[i]);
  fg_island_list_free(&parts);
  return status;
}

/* About what a job's pixels take, the tiles around the island with them. */
static size_t job_bytes(const job *j) {
  return j->island.count * 3 * FG_TILE_PX * FG_TILE_PX * (size_t)j->view.bytes_per_pixel;
}

/* The next job of the queue; waits for one while more may come. */
static bool take_job(fg_session *s, bool wait, job *j) {
  pthread_mutex_lock(&s->lock);
  while (wait && s->taken == s->queued && !s->ended && s->status == FG_OK)
    pthread_cond_wait(&s->changed, &s->lock);
  bool got = s->taken < s->queued && s->status == FG_OK;
  if (got) {
    *j = s->queue[s->taken++];
    s->waiting_bytes -= job_bytes(j);
  }
  pthread_mutex_unlock(&s->lock);
  return got;
}

static void note_failure(fg_session *s, const fg_context *ctx, fg_status status) {
  pthread_mutex_lock(&s->lock);
  if (s->status == FG_OK) {
    s->status = status;
    s->context = *ctx;
  }
  pthread_cond_broadcast(&s->changed);
  pthread_mutex_unlock(&s->lock);
}

static bool work_on_one(fg_session *s, bool wait) {
  job j;
  if (!take_job(s, wait, &j)) return false;
  fg_context ctx = {.message = ""};
  fg_status status = measure_island(&ctx, s, &j);
  free_job(&j);
  if (status != FG_OK) note_failure(s, &ctx, status);
  return true;
}

static void *run_worker(void *session) {
  while (work_on_one(session, true))
    continue;
  return NULL;
}

fg_status fg_session_create(fg_context *ctx, fg_measurement *measurement, unsigned threads,
                            bool plain, fg_session **session) {
  *session = NULL;
  fg_session *s = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *s, (void **)&s));
  s->measurement = measurement;
  s->threads = threads ? threads : fg_core_count();
  s->plain = plain;
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

static fg_status push_job(fg_context *ctx, fg_session *s, const job *j) {
  pthread_mutex_lock(&s->lock);
  fg_status status = s->status;
  if (status != FG_OK)
    fg_fail(ctx, status, "%s", s->context.message);
  else
    status = fg_memory_reserve(ctx, s->queued + 1, sizeof *s->queue, &s->queue_capacity,
                               (void **)&s->queue);
  if (status == FG_OK)
    status = fg_memory_reserve(ctx, s->queued + 1, sizeof *s->parts, &s->parts_capacity,
                               (void **)&s->parts);
  if (status == FG_OK) {
    s->parts[s->queued] = (fg_flat_parts){0};
    s->queue[s->queued] = *j;
    s->queue[s->queued].number = s->queued;
    s->queued++;
    s->waiting_bytes += job_bytes(j);
  }
  pthread_cond_signal(&s->changed);
  pthread_mutex_unlock(&s->lock);
  return status;
}

/* Level of the border of what has been read: the median of its outermost blocks. */
static fg_status find_background(fg_context *ctx, const fg_tiles *tiles, double *level) {
  int32_t w = tiles->block_columns, h = tiles->received * FG_BLOCKS_PER_TILE;
  if (h > tiles->block_rows) h = tiles->block_rows;
  size_t n = 0;
  double *values;
  FG_TRY(fg_memory_allocate(ctx, (size_t)w + 2 * (size_t)h, sizeof *values, (void **)&values));
  for (int32_t x = 0; x < w; x++)
    values[n++] = (double)fg_tiles_block(tiles, x, 0);
  for (int32_t y = 0; y < h; y++) {
    values[n++] = (double)fg_tiles_block(tiles, 0, y);
    values[n++] = (double)fg_tiles_block(tiles, w - 1, y);
  }
  *level = fg_select(values, n, n / 2);
  free(values);
  return FG_OK;
}

/* Hands an island to the workers; dust is counted and forgotten. */
static fg_status take_island(fg_context *ctx, fg_session *s, fg_tiles *tiles, fg_island *island) {
  if (hypot(island->width, island->height) * FG_TILE_PX < min_object_px(s->measurement)) {
    fg_island_release(tiles, island);
    fg_island_free(island);
    count_specks(s, 1);
    return FG_OK;
  }
  job j = {.island = *island};
  fg_status status = FG_OK;
  if (kind_of(s->measurement)->lies_flat) status = find_background(ctx, tiles, &j.background);
  if (status == FG_OK) status = fg_island_cut(ctx, tiles, &j.island, &j.view, j.origin_px);
  if (status == FG_OK) status = push_job(ctx, s, &j);
  if (status != FG_OK) free_job(&j);
  return status;
}

static bool is_behind(fg_session *s) {
  pthread_mutex_lock(&s->lock);
  bool behind = s->waiting_bytes > WAITING_BYTES_MAX;
  pthread_mutex_unlock(&s->lock);
  return behind;
}

fg_status fg_session_advance(fg_context *ctx, fg_tiles *tiles, void *session) {
  fg_session *s = session;
  fg_island island;
  if (!s->islands) FG_TRY(fg_islands_create(ctx, tiles, &s->islands));
  FG_TRY(fg_islands_advance(ctx, s->islands));
  while (fg_islands_next(s->islands, &island)) {
    FG_TRY(take_island(ctx, s, tiles, &island));
    bool reading = tiles->received < tiles->rows;
    if (!s->worker_count && reading && s->queued) FG_TRY(start_workers(s));
  }
  while (is_behind(s) && work_on_one(s, false))
    continue;
  return FG_OK;
}

/* No more islands: the workers run out and end. */
static void end_work(fg_session *s) {
  pthread_mutex_lock(&s->lock);
  s->ended = true;
  pthread_cond_broadcast(&s->changed);
  pthread_mutex_unlock(&s->lock);
}

/* Strips and discs that are no gauge of the design. */
static void count_unmatched(fg_session *s) {
  size_t found = 0;
  for (size_t i = 0; i < s->measurement->design.gauge_count; i++)
    found += s->measurement->gauges[i].found;
  s->measurement->specks += s->sightings.count - found;
}

static fg_status assemble_flat_foils(fg_context *ctx, fg_session *s) {
  fg_flat_parts all = {0};
  fg_status status = FG_OK;
  for (size_t i = 0; i < s->queued && status == FG_OK; i++)
    status = fg_flat_parts_move(ctx, &s->parts[i], &all);
  if (status == FG_OK) status = fg_flat_foils_assemble(ctx, &all, s->measurement);
  fg_flat_parts_free(&all);
  return status;
}

fg_status fg_session_finish(fg_context *ctx, fg_session *s) {
  end_work(s);
  while (work_on_one(s, false))
    continue;
  for (unsigned i = 0; i < s->worker_count; i++)
    fg_thread_join(&s->workers[i]);
  s->worker_count = 0;
  if (s->status != FG_OK) return fg_fail(ctx, s->status, "%s", s->context.message);
  s->measurement->light_on_dark = s->light >= s->dark;
  if (kind_of(s->measurement)->lies_flat) FG_TRY(assemble_flat_foils(ctx, s));
  fg_place_sort_foils(s->measurement);
  fg_gauges_match(&s->sightings, s->measurement);
  count_unmatched(s);
  return FG_OK;
}

void fg_session_free(fg_session *s) {
  if (!s) return;
  pthread_mutex_lock(&s->lock);
  if (s->status == FG_OK) s->status = FG_ERR_INTERRUPTED; /* queued islands are left */
  pthread_mutex_unlock(&s->lock);
  end_work(s);
  for (unsigned i = 0; i < s->worker_count; i++)
    fg_thread_join(&s->workers[i]);
  for (size_t i = s->taken; i < s->queued; i++)
    free_job(&s->queue[i]);
  free(s->queue);
  fg_islands_free(s->islands);
  for (size_t i = 0; i < s->queued; i++)
    fg_flat_parts_free(&s->parts[i]);
  free(s->parts);
  free(s->sightings.list);
  pthread_mutex_destroy(&s->lock);
  pthread_cond_destroy(&s->changed);
  free(s);
}

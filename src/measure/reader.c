/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/reader.h"

#include <stdbool.h>
#include <string.h>

#include "core/parallel.h"

/* The decoding thread fills the tiles' strips ahead of the caller, who consumes them. */
typedef struct ring {
  fg_scan *scan;
  fg_tiles *tiles;
  fg_reader_visit *visit;
  void *data;
  fg_context decode_context;
  fg_status decode_status;
  int32_t filled, taken; /* number of strips */
  bool stop;
  pthread_mutex_t lock;
  pthread_cond_t changed;
} ring;

static fg_status decode_strip(fg_context *ctx, ring *r, int32_t strip) {
  return fg_scan_read_rows(ctx, r->scan, fg_tiles_strip_rows(r->tiles, strip),
                           fg_tiles_strip(r->tiles, strip),
                           r->tiles->width_px * r->tiles->bytes_per_pixel);
}

/* Waits until the place of a strip is free: its earlier strip has been consumed, and so has the one
 * after that. False when the other side has given up. */
static bool wait_for_place(ring *r, int32_t strip) {
  pthread_mutex_lock(&r->lock);
  while (strip >= r->taken + FG_TILE_STRIPS - 1 && !r->stop)
    pthread_cond_wait(&r->changed, &r->lock);
  bool go_on = !r->stop;
  pthread_mutex_unlock(&r->lock);
  return go_on;
}

static void *decode_strips(void *argument) {
  ring *r = argument;
  fg_status status = FG_OK;
  for (int32_t strip = 0; strip < r->tiles->rows && status == FG_OK; strip++) {
    if (!wait_for_place(r, strip)) break;
    status = decode_strip(&r->decode_context, r, strip);
    pthread_mutex_lock(&r->lock);
    if (status == FG_OK) r->filled++;
    r->decode_status = status;
    pthread_cond_signal(&r->changed);
    pthread_mutex_unlock(&r->lock);
  }
  return NULL;
}

/* Waits for the next strip, or for the decoder's error. */
static fg_status wait_for_strip(fg_context *ctx, ring *r, int32_t strip) {
  pthread_mutex_lock(&r->lock);
  while (r->filled <= strip && r->decode_status == FG_OK)
    pthread_cond_wait(&r->changed, &r->lock);
  fg_status status = r->filled > strip ? FG_OK : r->decode_status;
  pthread_mutex_unlock(&r->lock);
  return status == FG_OK ? FG_OK : fg_fail(ctx, status, "%s", r->decode_context.message);
}

static void release_ring(ring *r, bool stop) {
  pthread_mutex_lock(&r->lock);
  r->taken++;
  r->stop |= stop;
  pthread_cond_signal(&r->changed);
  pthread_mutex_unlock(&r->lock);
}

static fg_status accept_strip(fg_context *ctx, ring *r) {
  FG_TRY(fg_tiles_accept_strip(ctx, r->tiles));
  return r->visit(ctx, r->tiles, r->data);
}

static fg_status consume_strips(fg_context *ctx, ring *r, bool threaded) {
  fg_status status = FG_OK;
  for (int32_t strip = 0; strip < r->tiles->rows && status == FG_OK; strip++) {
    status = threaded ? wait_for_strip(ctx, r, strip) : decode_strip(ctx, r, strip);
    if (status == FG_OK) status = accept_strip(ctx, r);
    if (threaded) release_ring(r, status != FG_OK);
  }
  if (status == FG_OK) status = fg_tiles_finish(ctx, r->tiles);
  return status == FG_OK ? r->visit(ctx, r->tiles, r->data) : status;
}

/* Runs both sides; one after the other, if no second thread is available or wanted. */
static fg_status run_ring(fg_context *ctx, ring *r) {
  fg_thread decoder;
  bool threaded =
      fg_scan_get_threads(r->scan) != 1 && fg_thread_start(&decoder, decode_strips, r) == FG_OK;
  fg_status status = consume_strips(ctx, r, threaded);
  if (threaded) fg_thread_join(&decoder);
  return status;
}

/* The file's digest: of a format that reads at random computed beside the decoding, else known
 * after it. */
typedef struct digest {
  fg_scan *scan;
  fg_context context;
  fg_status status;
  char *hex;
} digest;

static void *run_digest(void *argument) {
  digest *d = argument;
  d->status = fg_scan_sha256(&d->context, d->scan, d->hex);
  if (d->status != FG_OK) d->hex[0] = '\0';
  return NULL;
}

static fg_status run_with_digest(fg_context *ctx, ring *r, char sha256[65]) {
  digest d = {.scan = r->scan, .hex = sha256};
  fg_thread digester;
  bool beside = fg_scan_sums_apart(r->scan) && fg_scan_get_threads(r->scan) != 1 &&
                fg_thread_start(&digester, run_digest, &d) == FG_OK;
  fg_status status = run_ring(ctx, r);
  if (beside)
    fg_thread_join(&digester);
  else if (status == FG_OK)
    run_digest(&d);
  if (status == FG_OK && d.status != FG_OK)
    status = fg_fail(ctx, d.status, "%s", d.context.message);
  fg_status unchanged =
      fg_scan_check_unchanged(ctx, r->scan); /* a changed file explains any other failure */
  if (unchanged != FG_OK) sha256[0] = '\0';
  return unchanged != FG_OK ? unchanged : status;
}

fg_status fg_reader_run(fg_context *ctx, fg_scan *scan, fg_reader_visit *visit, void *data,
                        fg_budget *budget, fg_tiles *tiles, char sha256[65]) {
  const fg_scan_info *info = fg_scan_get_info(scan);
  ring r = {.scan = scan,
            .tiles = tiles,
            .visit = visit,
            .data = data,
            .lock = PTHREAD_MUTEX_INITIALIZER,
            .changed = PTHREAD_COND_INITIALIZER};
  memset(tiles, 0, sizeof *tiles);
  FG_TRY(
      fg_tiles_create(ctx, info->width_px, info->height_px, info->bytes_per_pixel, budget, tiles));
  fg_status status = run_with_digest(ctx, &r, sha256);
  pthread_mutex_destroy(&r.lock);
  pthread_cond_destroy(&r.changed);
  return status;
}

#include "measure/reader.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

enum { SLOTS = 4 };

/* A ring of strips between the decoding thread and the caller. */
typedef struct ring {
  fg_scan *scan;
  fg_context decode_context;
  fg_status decode_status;
  int64_t strips, stride_bytes, height_px;
  uint8_t *slots[SLOTS];
  int64_t filled, taken; /* strips */
  bool stop;
  pthread_mutex_t lock;
  pthread_cond_t changed;
} ring;

static int64_t rows_of(const ring *r, int64_t strip) {
  int64_t left = r->height_px - strip * FG_TILE_PX;
  return left < FG_TILE_PX ? left : FG_TILE_PX;
}

/* Waits for a free slot; false when the other side has given up. */
static bool wait_for_slot(ring *r) {
  pthread_mutex_lock(&r->lock);
  while (r->filled - r->taken >= SLOTS && !r->stop) pthread_cond_wait(&r->changed, &r->lock);
  bool go_on = !r->stop;
  pthread_mutex_unlock(&r->lock);
  return go_on;
}

static void *decode(void *argument) {
  ring *r = argument;
  fg_status status = FG_OK;
  for (int64_t strip = 0; strip < r->strips && status == FG_OK && wait_for_slot(r); strip++) {
    status = fg_scan_read_rows(&r->decode_context, r->scan, rows_of(r, strip),
                               r->slots[strip % SLOTS], r->stride_bytes);
    pthread_mutex_lock(&r->lock);
    if (status == FG_OK) r->filled++;
    r->decode_status = status;
    pthread_cond_signal(&r->changed);
    pthread_mutex_unlock(&r->lock);
  }
  return NULL;
}

/* The next strip, or the decoder's error. */
static fg_status wait_for_strip(fg_context *ctx, ring *r, int64_t strip) {
  pthread_mutex_lock(&r->lock);
  while (r->filled <= strip && r->decode_status == FG_OK)
    pthread_cond_wait(&r->changed, &r->lock);
  fg_status status = r->filled > strip ? FG_OK : r->decode_status;
  pthread_mutex_unlock(&r->lock);
  return status == FG_OK ? FG_OK : fg_fail(ctx, status, "%s", r->decode_context.message);
}

static void release(ring *r, bool stop) {
  pthread_mutex_lock(&r->lock);
  r->taken++;
  r->stop |= stop;
  pthread_cond_signal(&r->changed);
  pthread_mutex_unlock(&r->lock);
}

static fg_status consume(fg_context *ctx, ring *r, fg_tiles *tiles) {
  fg_status status = FG_OK;
  for (int64_t strip = 0; strip < r->strips && status == FG_OK; strip++) {
    status = wait_for_strip(ctx, r, strip);
    if (status == FG_OK)
      status = fg_tiles_add_strip(ctx, tiles, r->slots[strip % SLOTS], r->stride_bytes);
    release(r, status != FG_OK);
  }
  return status == FG_OK ? fg_tiles_finish(ctx, tiles) : status;
}

/* Runs both sides. Where no second thread is to be had, it is one after the other. */
static fg_status run_ring(fg_context *ctx, ring *r, fg_tiles *tiles) {
  pthread_t decoder;
  if (pthread_create(&decoder, NULL, decode, r) != 0) {
    fg_status status = FG_OK;
    for (int64_t strip = 0; strip < r->strips && status == FG_OK; strip++) {
      status = fg_scan_read_rows(ctx, r->scan, rows_of(r, strip), r->slots[0], r->stride_bytes);
      if (status == FG_OK) status = fg_tiles_add_strip(ctx, tiles, r->slots[0], r->stride_bytes);
    }
    return status == FG_OK ? fg_tiles_finish(ctx, tiles) : status;
  }
  fg_status status = consume(ctx, r, tiles);
  pthread_join(decoder, NULL);
  return status;
}

/* The file's digest, computed beside the decoding. */
typedef struct digest {
  fg_scan *scan;
  fg_context context;
  fg_status status;
  char *hex;
} digest;

static void *run_digest(void *argument) {
  digest *d = argument;
  d->status = fg_scan_sha256(&d->context, d->scan, d->hex);
  return NULL;
}

fg_status fg_reader_run(fg_context *ctx, fg_scan *scan, fg_tiles *tiles, char sha256[65]) {
  const fg_scan_info *info = fg_scan_get_info(scan);
  ring r = {.scan = scan, .height_px = info->height_px, .lock = PTHREAD_MUTEX_INITIALIZER,
            .changed = PTHREAD_COND_INITIALIZER};
  digest d = {.scan = scan, .hex = sha256};
  fg_status status = FG_OK;
  r.strips = (info->height_px + FG_TILE_PX - 1) / FG_TILE_PX;
  r.stride_bytes = info->width_px * info->bytes_per_pixel;
  memset(tiles, 0, sizeof *tiles);
  for (int i = 0; i < SLOTS; i++)
    FG_TRY_EXIT(fg_memory_allocate(ctx, (size_t)r.stride_bytes, FG_TILE_PX, (void **)&r.slots[i]));
  FG_TRY_EXIT(fg_tiles_create(ctx, info->width_px, info->height_px, info->bytes_per_pixel, tiles));
  FG_TRY_EXIT(run_ring(ctx, &r, tiles));
  run_digest(&d);
  status = d.status;
  if (status != FG_OK) fg_fail(ctx, status, "%s", d.context.message);
exit:
  for (int i = 0; i < SLOTS; i++) free(r.slots[i]);
  pthread_mutex_destroy(&r.lock);
  pthread_cond_destroy(&r.changed);
  if (status != FG_OK) fg_tiles_free(tiles);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compressed strips and tiles, decoded by several threads at once. Each thread has its own view of
 * the file, and decodes the next part (a strip, a tile) until the batch is done. */
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "scan/tiff_reader.h"

/* A longer strip is read row by row: it may be the whole image. */
#define STRIP_BYTES_MAX ((size_t)1 << 22)
/* Bytes of a batch of strips per thread that make up for its start. */
#define SHARE_BYTES ((size_t)1 << 19)

/* Codecs without state beyond a strip or a tile, and without settings of their own. */
static bool is_plain_codec(const fg_tiff *r) {
  return r->compression == COMPRESSION_LZW || r->compression == COMPRESSION_ADOBE_DEFLATE ||
         r->compression == COMPRESSION_DEFLATE || r->compression == COMPRESSION_PACKBITS ||
         r->compression == COMPRESSION_ZSTD || r->compression == COMPRESSION_LZMA;
}

static void count_threads(fg_tiff *r, uint64_t parts) {
  if (r->threads == 0) r->threads = fg_core_count();
  if (r->threads > FG_TIFF_WORKERS_MAX) r->threads = FG_TIFF_WORKERS_MAX;
  if (r->threads > parts) r->threads = (unsigned)parts;
  if (!is_plain_codec(r)) r->threads = 1;
}

bool fg_tiff_plan_strips(fg_tiff *r) {
  size_t strip = (size_t)r->rows_per_strip * r->row_bytes;
  uint64_t strips = (r->height + r->rows_per_strip - 1) / r->rows_per_strip;
  if (!is_plain_codec(r) || strip == 0 || strip > STRIP_BYTES_MAX) return false;
  count_threads(r, strips);
  uint64_t together = (SHARE_BYTES + strip - 1) / strip * r->threads;
  r->batch_rows = (together < strips ? together : strips) * r->rows_per_strip;
  if (r->batch_rows > r->height) r->batch_rows = r->height;
  return true;
}

void fg_tiff_plan_tiles(fg_tiff *r) {
  count_threads(r, (r->width + r->tile_width - 1) / r->tile_width);
  r->batch_rows = r->tile_height;
}

uint64_t fg_tiff_batch_memory(const fg_tiff *r) {
  return r->batch_rows * r->row_bytes + r->tile_bytes * r->threads;
}

/* Opens a view beside the reader's; without it there are fewer threads. */
static bool open_view(fg_context *ctx, fg_tiff *r, fg_tiff_worker *w) {
  if (fg_source_window_open(ctx, &w->window) != FG_OK) return false;
  w->own = (fg_tiff_handle){.source = r->source, .window = &w->window};
  if (!fg_tiff_handle_open(&w->own)) return false;
  w->own.in_image = true;
  w->own.complained = false;
  w->handle = &w->own;
  return true;
}

fg_status fg_tiff_start_batch(fg_context *ctx, fg_tiff *r) {
  unsigned ready = 1;
  r->workers[0].handle = &r->main;
  while (ready < r->threads && open_view(NULL, r, &r->workers[ready]))
    ready++;
  r->threads = ready;
  for (unsigned i = 0; i < ready && r->tile_bytes; i++)
    FG_TRY(fg_memory_allocate(ctx, r->tile_bytes, 1, (void **)&r->workers[i].tile));
  return fg_memory_allocate(ctx, r->row_bytes, (size_t)r->batch_rows, (void **)&r->batch);
}

void fg_tiff_free_batch(fg_tiff *r) {
  for (int i = 0; i < FG_TIFF_WORKERS_MAX; i++) {
    fg_tiff_worker *w = &r->workers[i];
    fg_tiff_handle_close(&w->own);
    fg_source_window_close(&w->window);
    free(w->tile);
  }
  free(r->batch);
}

static bool came_through(const fg_tiff_worker *w, tmsize_t got, size_t wanted) {
  return got >= 0 && (size_t)got >= wanted && !w->handle->complained;
}

static bool decode_strip(fg_tiff *r, fg_tiff_worker *w, uint64_t part) {
  uint64_t first = part * r->rows_per_strip, left = r->height - (r->row + first);
  size_t size = (size_t)(left < r->rows_per_strip ? left : r->rows_per_strip) * r->row_bytes;
  uint32_t strip = (uint32_t)((r->row + first) / r->rows_per_strip);
  return came_through(w,
                      fg_libtiff.ReadEncodedStrip(w->handle->tiff, strip,
                                                  r->batch + first * r->row_bytes, (tmsize_t)size),
                      size);
}

/* Puts a tile's rows beside those of the tiles around it. */
static bool decode_tile(fg_tiff *r, fg_tiff_worker *w, uint64_t part) {
  uint64_t x = part * r->tile_width;
  size_t pixel_bits = (size_t)(r->bits * r->channels), bytes = r->tile_width * pixel_bits / 8;
  size_t tile_row = bytes, from = (size_t)x * pixel_bits / 8;
  tmsize_t got = fg_libtiff.ReadTile(w->handle->tiff, w->tile, (uint32_t)x, (uint32_t)r->row, 0, 0);
  if (!came_through(w, got, r->tile_bytes)) return false;
  if (from + bytes > r->row_bytes) bytes = r->row_bytes - from;
  for (size_t y = 0; y < r->tile_height; y++)
    memcpy(r->batch + y * r->row_bytes + from, w->tile + y * tile_row, bytes);
  return true;
}

typedef struct batch {
  fg_tiff *reader;
  uint64_t parts;
  _Atomic uint64_t next;
} batch;

static fg_status decode_parts(fg_context *ctx, void *shared, size_t item) {
  (void)ctx;
  batch *b = shared;
  fg_tiff *r = b->reader;
  fg_tiff_worker *w = &r->workers[item];
  for (uint64_t part; !w->failed && (part = atomic_fetch_add(&b->next, 1)) < b->parts;) {
    w->failed = !(r->tile_bytes ? decode_tile : decode_strip)(r, w, part);
    w->failed_part = part;
  }
  return FG_OK;
}

/* Reports the first part that failed, in any thread. */
static fg_status fail_batch(fg_context *ctx, fg_tiff *r) {
  fg_tiff_worker *first = NULL;
  for (unsigned i = 0; i < r->threads; i++) {
    fg_tiff_worker *w = &r->workers[i];
    if (w->failed && (!first || w->failed_part < first->failed_part)) first = w;
  }
  if (!first) return FG_OK;
  if (!r->tile_bytes) r->row += first->failed_part * r->rows_per_strip;
  if (first->window.error) r->source->error = first->window.error;
  return fg_tiff_fail(ctx, r, first->handle->words);
}

static fg_status decode_batch(fg_context *ctx, fg_tiff *r) {
  uint64_t left = r->height - r->row, rows = left < r->batch_rows ? left : r->batch_rows;
  batch b = {.reader = r};
  b.parts = r->tile_bytes ? (r->width + r->tile_width - 1) / r->tile_width
                          : (rows + r->rows_per_strip - 1) / r->rows_per_strip;
  FG_TRY(fg_parallel_run(ctx, r->threads, r->threads, decode_parts, &b));
  return fail_batch(ctx, r);
}

fg_status fg_tiff_fetch_batch(fg_context *ctx, fg_tiff *r, uint8_t *row) {
  uint64_t y = r->row % r->batch_rows;
  if (y == 0) FG_TRY(decode_batch(ctx, r));
  memcpy(row, r->batch + y * r->row_bytes, r->row_bytes);
  return FG_OK;
}

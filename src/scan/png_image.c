/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/png_image.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "scan/png_unfilter.h"

/* A block stays in the processor's second cache from its decompression to its rows' conversion. */
enum { BLOCK_BYTES = 1 << 18, BLOCKS = 3 };
/* Bytes decompressed before the start of a thread is worth it. */
#define BESIDE_BYTES_MIN ((size_t)1 << 20)

typedef struct block {
  uint8_t *lines; /* rows with their filter's byte in front */
  size_t rows;
} block;

struct fg_png_image {
  fg_png_stream *stream;
  fg_png_image_layout layout;
  size_t block_rows, block_count;
  block blocks[BLOCKS]; /* a ring */
  uint8_t *above;       /* the last row read of the block before */
  block *hand;          /* block in reading; NULL: none */
  size_t rows_read;     /* of `hand` */
  bool beside;          /* a thread is to start with the first row */
  bool bad_filter;
  /* shared with the thread, if there is one: */
  uint32_t rows_left; /* to decompress */
  uint64_t filled, taken;
  bool ended; /* nothing more will be filled */
  bool stop, threaded;
  fg_thread thread;
  pthread_mutex_t lock;
  pthread_cond_t changed;
};

static block *block_at(fg_png_image *image, uint64_t number) {
  return &image->blocks[number % image->block_count];
}

/* Fills a block with the next rows, still filtered. False: they are the last, or fewer than
 * expected. */
static bool fill_block(fg_png_image *image, block *b) {
  size_t line = image->layout.row_bytes + 1;
  size_t wanted = image->rows_left < image->block_rows ? image->rows_left : image->block_rows;
  b->rows = fg_png_stream_read(image->stream, b->lines, wanted * line) / line;
  image->rows_left -= (uint32_t)b->rows;
  return b->rows == wanted && image->rows_left > 0;
}

static bool wait_for_room(fg_png_image *image) {
  pthread_mutex_lock(&image->lock);
  while (image->filled - image->taken == image->block_count && !image->stop)
    pthread_cond_wait(&image->changed, &image->lock);
  bool go_on = !image->stop;
  pthread_mutex_unlock(&image->lock);
  return go_on;
}

static void *decompress_blocks(void *argument) {
  fg_png_image *image = argument;
  bool more = true;
  while (more && wait_for_room(image)) {
    more = fill_block(image, block_at(image, image->filled));
    pthread_mutex_lock(&image->lock);
    image->filled++;
    image->ended = !more;
    pthread_cond_signal(&image->changed);
    pthread_mutex_unlock(&image->lock);
  }
  return NULL;
}

/* Starts the thread. Without one, blocks are filled on demand. */
static void start_thread(fg_png_image *image) {
  image->beside = false;
  image->threaded = fg_thread_start(&image->thread, decompress_blocks, image) == FG_OK;
}

/* Gives back the block in hand; the next one needs its last row. */
static void give_back(fg_png_image *image) {
  size_t size = image->layout.row_bytes, line = size + 1;
  memcpy(image->above, image->hand->lines + image->hand->rows * line - size, size);
  image->hand = NULL;
  image->rows_read = 0;
  pthread_mutex_lock(&image->lock);
  image->taken++;
  pthread_cond_signal(&image->changed);
  pthread_mutex_unlock(&image->lock);
}

static bool wait_for_block(fg_png_image *image) {
  pthread_mutex_lock(&image->lock);
  while (image->filled == image->taken && !image->ended)
    pthread_cond_wait(&image->changed, &image->lock);
  bool got = image->filled > image->taken;
  pthread_mutex_unlock(&image->lock);
  return got;
}

static bool fill_now(fg_png_image *image) {
  if (image->ended) return false;
  image->ended = !fill_block(image, block_at(image, image->filled++));
  return true;
}

/* False: there are no more rows. */
static bool use_next_block(fg_png_image *image) {
  if (image->beside) start_thread(image);
  if (image->threaded ? !wait_for_block(image) : !fill_now(image)) return false;
  image->hand = block_at(image, image->taken);
  return image->hand->rows > 0;
}

static const uint8_t *fail_rows(fg_png_image *image) {
  fg_png_image_stop(image);
  return NULL;
}

const uint8_t *fg_png_image_next(fg_png_image *image) {
  size_t size = image->layout.row_bytes;
  if (image->hand && image->rows_read == image->hand->rows) give_back(image);
  if (!image->hand && !use_next_block(image)) return fail_rows(image);
  uint8_t *line = image->hand->lines + image->rows_read * (size + 1);
  const uint8_t *above = image->rows_read ? line - size : image->above;
  image->bad_filter = !fg_png_unfilter(line[0], image->layout.pixel_bytes, above, line + 1, size);
  if (image->bad_filter) return fail_rows(image);
  image->rows_read++;
  return line + 1;
}

bool fg_png_image_finish(fg_png_image *image, uint8_t head[FG_PNG_CHUNK_HEAD_BYTES]) {
  fg_png_image_stop(image);
  return fg_png_stream_finish(image->stream, head);
}

const char *fg_png_image_problem(const fg_png_image *image) {
  return image->bad_filter ? "bad adaptive filter value" : fg_png_stream_problem(image->stream);
}

static fg_status allocate_blocks(fg_context *ctx, fg_png_image *image) {
  size_t line = image->layout.row_bytes + 1;
  image->block_rows = BLOCK_BYTES / line > 0 ? BLOCK_BYTES / line : 1;
  if (image->block_rows > image->layout.height_px) image->block_rows = image->layout.height_px;
  for (size_t i = 0; i < image->block_count; i++)
    FG_TRY(fg_memory_allocate(ctx, image->block_rows * line + FG_PNG_ROW_SLACK, 1,
                              (void **)&image->blocks[i].lines));
  return fg_memory_allocate(ctx, line + FG_PNG_ROW_SLACK, 1, (void **)&image->above);
}

fg_status fg_png_image_create(fg_context *ctx, fg_source *source,
                              const uint8_t head[FG_PNG_CHUNK_HEAD_BYTES],
                              const fg_png_image_layout *layout, bool beside, fg_png_image **out) {
  fg_png_image *image = NULL;
  fg_status status = FG_OK;
  *out = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *image, (void **)&image));
  pthread_mutex_init(&image->lock, NULL);
  pthread_cond_init(&image->changed, NULL);
  image->layout = *layout;
  image->rows_left = layout->height_px;
  image->beside = beside && (layout->row_bytes + 1) * layout->height_px >= BESIDE_BYTES_MIN &&
                  fg_core_count() > 1;
  image->block_count = image->beside ? BLOCKS : 1;
  FG_TRY_EXIT(allocate_blocks(ctx, image));
  FG_TRY_EXIT(fg_png_stream_open(ctx, source, head, &image->stream));
  *out = image;
exit:
  if (status != FG_OK) fg_png_image_free(image);
  return status;
}

void fg_png_image_stop(fg_png_image *image) {
  if (!image->threaded) return;
  pthread_mutex_lock(&image->lock);
  image->stop = true;
  pthread_cond_signal(&image->changed);
  pthread_mutex_unlock(&image->lock);
  fg_thread_join(&image->thread);
  image->threaded = false;
}

void fg_png_image_free(fg_png_image *image) {
  if (!image) return;
  fg_png_image_stop(image);
  for (size_t i = 0; i < image->block_count; i++)
    free(image->blocks[i].lines);
  free(image->above);
  fg_png_stream_close(image->stream);
  pthread_mutex_destroy(&image->lock);
  pthread_cond_destroy(&image->changed);
  free(image);
}

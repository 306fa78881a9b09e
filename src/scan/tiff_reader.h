/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One TIFF or BigTIFF, first image, row by row through libtiff. */
#ifndef FG_SCAN_TIFF_READER_H
#define FG_SCAN_TIFF_READER_H

#include "scan/header.h"
#include "scan/source.h"
#include "scan/tiff_library.h"

/* libtiff's view of the file. Several handles read one file at once, each from a thread of its own.
 */
typedef struct fg_tiff_handle {
  TIFF *tiff;
  fg_source *source;
  fg_source_window *window; /* NULL: the source's own */
  uint64_t position;        /* in the file */
  bool strict;              /* warnings about the image are errors */
  bool in_image, complained;
  bool counts_replaced; /* libtiff found the byte counts wrong and made its own */
  char words[160];      /* libtiff's last error */
} fg_tiff_handle;

typedef struct fg_tiff fg_tiff;

/* Fetches the next row in the file's layout, all channels of a pixel together, samples of fewer
 * than 8 bits packed. */
typedef fg_status fg_tiff_fetch(fg_context *ctx, fg_tiff *reader, uint8_t *row);

/* A thread's share in decoding a batch. */
typedef struct fg_tiff_worker {
  fg_tiff_handle *handle, own; /* the reader's, or its own */
  fg_source_window window;     /* of its own */
  uint8_t *tile;
  bool failed;
  uint64_t failed_part;
} fg_tiff_worker;

enum { FG_TIFF_WORKERS_MAX = 8 };

struct fg_tiff {
  fg_tiff_handle main;
  fg_source *source;
  unsigned threads; /* max number of decoding threads */
  uint64_t width, height, row;
  int bits, channels; /* of a sample; of a pixel */
  uint16_t compression;
  bool separate; /* each channel in a plane of its own */
  fg_tiff_fetch *fetch;
  size_t row_bytes;  /* of a packed row, all channels */
  uint8_t *packed;   /* buffer where samples must be unpacked or interleaved */
  uint64_t *offsets; /* of strips, where they are read directly */
  uint64_t strip_count, rows_per_strip;
  /* Rows that are decoded together: a row of tiles, or some strips. */
  uint64_t batch_rows;
  uint8_t *batch;
  uint32_t tile_width, tile_height;
  size_t tile_bytes;
  fg_tiff_worker workers[FG_TIFF_WORKERS_MAX];
};

/* Opens the file for libtiff; source, window and strictness are set. False: the words give the
 * reason; no words: out of memory. tiff_handle.c */
bool fg_tiff_handle_open(fg_tiff_handle *handle);
void fg_tiff_handle_close(fg_tiff_handle *handle);

/* Explains libtiff's error or a missing part of the file. tiff_handle.c */
fg_status fg_tiff_fail(fg_context *ctx, const fg_tiff *reader, const char *what);

/* Chooses how rows are fetched, checks that the file holds them, and returns the memory for that in
 * `header`. tiff_rows.c */
fg_status fg_tiff_plan_rows(fg_context *ctx, fg_tiff *reader, fg_scan_header *header);
fg_status fg_tiff_start_rows(fg_context *ctx, fg_tiff *reader);
fg_status fg_tiff_read_row(fg_context *ctx, fg_tiff *reader, void *samples);
void fg_tiff_free_rows(fg_tiff *reader);

/* Rows decoded in batches, on up to reader->threads threads; the layout of strips or tiles is set.
 * Fewer threads are used when a handle cannot be opened, or a codec keeps state. tiff_batch.c */
bool fg_tiff_plan_strips(fg_tiff *reader); /* false: the strips cannot be decoded in batches */
void fg_tiff_plan_tiles(fg_tiff *reader);
uint64_t fg_tiff_batch_memory(const fg_tiff *reader);
fg_status fg_tiff_start_batch(fg_context *ctx, fg_tiff *reader);
fg_status fg_tiff_fetch_batch(fg_context *ctx, fg_tiff *reader, uint8_t *row);
void fg_tiff_free_batch(fg_tiff *reader);

#endif

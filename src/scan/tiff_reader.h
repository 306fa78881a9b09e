/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One TIFF or BigTIFF, first image, row by row through libtiff. */
#ifndef FG_SCAN_TIFF_READER_H
#define FG_SCAN_TIFF_READER_H

#include <tiffio.h>

#include "scan/header.h"
#include "scan/source.h"

/* libtiff's view of the file. Several see one file at once, each from a thread of its own. */
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

/* The next row as it stands in the file, all channels of a pixel together, samples of fewer than 8
 * bits packed. */
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
  unsigned threads; /* that may decode */
  uint64_t width, height, row;
  int bits, channels; /* of a sample; of a pixel */
  uint16_t compression;
  bool separate; /* each channel in a plane of its own */
  fg_tiff_fetch *fetch;
  size_t row_bytes;  /* of a packed row, all channels */
  uint8_t *packed;   /* room for it where samples must be unpacked or interleaved */
  uint64_t *offsets; /* of strips, where they are read directly */
  uint64_t strip_count, rows_per_strip;
  /* Rows that are decoded together: a row of tiles, or some strips. */
  uint64_t batch_rows;
  uint8_t *batch;
  uint32_t tile_width, tile_height;
  size_t tile_bytes;
  fg_tiff_worker workers[FG_TIFF_WORKERS_MAX];
};

/* Opens the file as libtiff sees it; source, window and strictness are set. False: the words say
 * why; none: out of memory. tiff_handle.c */
bool fg_tiff_handle_open(fg_tiff_handle *handle);
void fg_tiff_handle_close(fg_tiff_handle *handle);

/* Words for what libtiff said or what the file lacks. tiff_words.c */
fg_status fg_tiff_fail(fg_context *ctx, const fg_tiff *reader, const char *what);

/* Chooses how rows are fetched, checks that the file holds them, and says how much memory that
 * takes. tiff_rows.c */
fg_status fg_tiff_plan_rows(fg_context *ctx, fg_tiff *reader, fg_scan_header *header);
fg_status fg_tiff_start_rows(fg_context *ctx, fg_tiff *reader);
fg_status fg_tiff_read_row(fg_context *ctx, fg_tiff *reader, void *samples);
void fg_tiff_free_rows(fg_tiff *reader);

/* Rows that are decoded in batches, on as many threads as there are; the layout of strips or tiles
 * is set. A handle that cannot be had, or a codec that keeps things to itself, leaves fewer.
 * tiff_batch.c */
bool fg_tiff_plan_strips(fg_tiff *reader); /* false: strips are not to be decoded so */
void fg_tiff_plan_tiles(fg_tiff *reader);
uint64_t fg_tiff_batch_memory(const fg_tiff *reader);
fg_status fg_tiff_start_batch(fg_context *ctx, fg_tiff *reader);
fg_status fg_tiff_fetch_batch(fg_context *ctx, fg_tiff *reader, uint8_t *row);
void fg_tiff_free_batch(fg_tiff *reader);

#endif

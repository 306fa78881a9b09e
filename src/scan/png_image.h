/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The image of a common PNG (whole samples, not interlaced) without libpng: its stream
 * (png_stream.h) and our own filters. Memory is a few blocks of rows, whatever the height; a large
 * image is decompressed on a thread of its own, ahead of the rows that are taken. */
#ifndef FG_SCAN_PNG_IMAGE_H
#define FG_SCAN_PNG_IMAGE_H

#include "scan/png_stream.h"

typedef struct fg_png_image_layout {
  uint32_t height_px;
  size_t pixel_bytes; /* 1, 2, 3, 4, 6 or 8 */
  size_t row_bytes;   /* without the filter's */
} fg_png_image_layout;

typedef struct fg_png_image fg_png_image;

/* The source is as fg_png_stream_open wants it; until the image is stopped, nobody else may read
 * it. `beside`: a thread may help. FG_ERR_MEMORY. */
fg_status fg_png_image_create(fg_context *ctx, fg_source *source,
                              const uint8_t head[FG_PNG_CHUNK_HEAD_BYTES],
                              const fg_png_image_layout *layout, bool beside, fg_png_image **image);

/* Ends the thread; after that only fg_png_image_free is left, unless all rows were taken. */
void fg_png_image_stop(fg_png_image *image);
void fg_png_image_free(fg_png_image *image); /* NULL is fine */

/* The next row, as the file's samples are (16 bit: big-endian); good until the next call. NULL: an
 * error, and the image is stopped. */
const uint8_t *fg_png_image_next(fg_png_image *image);

/* After the last row: as fg_png_stream_finish. */
bool fg_png_image_finish(fg_png_image *image, uint8_t head[FG_PNG_CHUNK_HEAD_BYTES]);

/* As fg_png_stream_problem, of the rows too. */
const char *fg_png_image_problem(const fg_png_image *image);

#endif

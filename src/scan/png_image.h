/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The image of a common PNG (whole samples, not interlaced) without libpng: its stream
 * (png_stream.h) and our own filters.
 *
 * Memory is a few blocks of rows, whatever the height. A large image is decompressed on a thread of
 * its own, ahead of the reader of its rows. */
#ifndef FG_SCAN_PNG_IMAGE_H
#define FG_SCAN_PNG_IMAGE_H

#include "scan/png_stream.h"

typedef struct fg_png_image_layout {
  uint32_t height_px;
  size_t pixel_bytes; /* 1, 2, 3, 4, 6 or 8 */
  size_t row_bytes;   /* without the filter's byte */
} fg_png_image_layout;

typedef struct fg_png_image fg_png_image;

/* The source stands as for fg_png_stream_open; until the image is stopped, nobody else may read it.
 * `beside`: a thread may help. FG_ERR_MEMORY. */
fg_status fg_png_image_create(fg_context *ctx, fg_source *source,
                              const uint8_t head[FG_PNG_CHUNK_HEAD_BYTES],
                              const fg_png_image_layout *layout, bool beside, fg_png_image **image);

/* Ends the thread; after that only fg_png_image_free is allowed, unless all rows were read. */
void fg_png_image_stop(fg_png_image *image);
void fg_png_image_free(fg_png_image *image); /* NULL is fine */

/* Returns the next row in the file's samples (16 bit: big-endian), valid until the next call. NULL:
 * an error, and the image is stopped. */
const uint8_t *fg_png_image_next(fg_png_image *image);

/* Checks the end after the last row, as fg_png_stream_finish. */
bool fg_png_image_finish(fg_png_image *image, uint8_t head[FG_PNG_CHUNK_HEAD_BYTES]);

/* Describes an error as fg_png_stream_problem, also of the rows. */
const char *fg_png_image_problem(const fg_png_image *image);

#endif

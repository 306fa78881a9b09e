/* The image of a common PNG (whole samples, not interlaced) without libpng: the IDAT chunks through
 * ISA-L's inflate, which takes a third of the time that zlib takes, and our own filters. Memory is
 * a block of rows, whatever the height.
 *
 * What is wrong is told in the words that libpng has for it. */
#ifndef FG_SCAN_PNG_IMAGE_H
#define FG_SCAN_PNG_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/status.h"
#include "scan/source.h"

enum { FG_PNG_CHUNK_HEAD_BYTES = 8 };

typedef struct fg_png_image_layout {
  uint32_t height_px;
  size_t pixel_bytes; /* 1, 2, 3, 4, 6 or 8 */
  size_t row_bytes;   /* without the filter's */
} fg_png_image_layout;

typedef struct fg_png_image fg_png_image;

/* The source stands behind the head of the first IDAT chunk, which is `head`. FG_ERR_MEMORY. */
fg_status fg_png_image_create(fg_context *ctx, fg_source *source,
                              const uint8_t head[FG_PNG_CHUNK_HEAD_BYTES],
                              const fg_png_image_layout *layout, fg_png_image **image);
void fg_png_image_free(fg_png_image *image); /* NULL is fine */

/* The next row, as the file's samples are (16 bit: big-endian); good until the next call. NULL: an
 * error. */
const uint8_t *fg_png_image_next(fg_png_image *image);

/* After the last row: checks that the data end there, and goes to the first chunk that is no IDAT,
 * whose head goes to `head`. False: an error. */
bool fg_png_image_finish(fg_png_image *image, uint8_t head[FG_PNG_CHUNK_HEAD_BYTES]);

/* What is wrong, in libpng's words. NULL: the file ends too early, or cannot be read on. */
const char *fg_png_image_problem(const fg_png_image *image);

#endif

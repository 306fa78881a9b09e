/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One PNG, read from front to back: the image of the common kinds by png_image.h, everything else
 * by libpng, whose setjmp stays behind this header.
 *
 * Order of calls: open, start, one read for each row (and, when interlaced, of each pass), finish.
 * After an error only close is allowed. */
#ifndef FG_SCAN_PNG_READER_H
#define FG_SCAN_PNG_READER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scan/header.h"
#include "scan/source.h"

typedef struct fg_png_header {
  uint32_t width_px, height_px;
  int bit_depth; /* of a sample in the file */
  int channels;  /* 1 to 4; palette images have 1 */
  bool interlaced;
  bool has_phys;
  bool phys_in_metres;
  uint32_t per_metre[2]; /* x, y; as in pHYs, whatever its unit */
  bool has_palette;      /* samples are indices into `palette` */
  size_t palette_size;
  fg_scan_colour palette[256];
} fg_png_header;

typedef struct fg_png fg_png;

/* Reads the file up to the image. The source stays the caller's and must outlive the reader.
 * FG_ERR_DATA: not a PNG, damaged; FG_ERR_IO, FG_ERR_MEMORY. */
fg_status fg_png_open(fg_context *ctx, fg_source *source, fg_png **png);
const fg_png_header *fg_png_get_header(const fg_png *png);

/* Opens a PNG of which libpng reads every image: the reference for the reading of the common kinds.
 */
fg_status fg_png_open_reference(fg_context *ctx, fg_source *source, fg_png **png);

/* Prepares for rows; separate from opening, so that the caller can refuse a size before its memory
 * is allocated. `beside`: a thread may decompress beside the caller, and reads the source. */
fg_status fg_png_start(fg_context *ctx, fg_png *png, bool beside);

/* Reads the next row's samples, all channels: one to a byte (up to 8 bits), one to a uint16_t in
 * host order (16 bits). `samples` holds the full width of the image even where a pass has fewer
 * columns. */
fg_status fg_png_read_row(fg_context *ctx, fg_png *png, void *samples);

/* Reads and checks everything from the last row to the end of the PNG. */
fg_status fg_png_finish(fg_context *ctx, fg_png *png);

/* Stops the thread that reads the source beside the caller; after that only close is allowed. */
void fg_png_stop(fg_png *png);

void fg_png_close(fg_png *png); /* NULL is fine */

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One JPEG, row by row through libjpeg, whose setjmp stays behind this header.
 *
 * Order of calls: open, start, one read for each row, finish. After an error only close is allowed.
 */
#ifndef FG_SCAN_JPEG_READER_H
#define FG_SCAN_JPEG_READER_H

#include <stdbool.h>
#include <stdint.h>

#include "scan/exif.h"
#include "scan/source.h"

typedef struct fg_jpeg_header {
  uint32_t width_px, height_px;
  bool colour;           /* it holds colours, as YCbCr or RGB */
  bool has_luminance;    /* a channel of its own: gray, or the Y of YCbCr */
  bool whole;            /* the image comes in several scans and needs memory as a whole */
  bool arithmetic;       /* arithmetic coding, which has no min size */
  uint64_t memory_bytes; /* of a whole image's coefficients */
  uint64_t blocks;       /* of 8 by 8, all channels */
  int quality;           /* by fg_jpeg_quality_of of the luminance's table */
  bool has_density;      /* JFIF states a resolution or the shape of the pixels */
  int density_unit;      /* as JFIF: 0 none, 1 per inch, 2 per cm */
  uint16_t density[2];
  fg_exif exif;
} fg_jpeg_header;

typedef struct fg_jpeg_in fg_jpeg_in;

/* Reads the file up to the image. The source stays the caller's and must outlive the reader.
 * FG_ERR_DATA: damaged, or an unsupported kind; FG_ERR_IO, FG_ERR_MEMORY. */
fg_status fg_jpeg_open(fg_context *ctx, fg_source *source, fg_jpeg_in **jpeg);
const fg_jpeg_header *fg_jpeg_get_header(const fg_jpeg_in *jpeg);

/* Prepares for rows of the luminance alone, or of all three colours. */
fg_status fg_jpeg_start(fg_context *ctx, fg_jpeg_in *jpeg, bool luminance);

/* Reads the next row's samples, a byte each. */
fg_status fg_jpeg_read_row(fg_context *ctx, fg_jpeg_in *jpeg, void *samples);

/* Reads and checks the remainder, to the end of the image. */
fg_status fg_jpeg_finish(fg_context *ctx, fg_jpeg_in *jpeg);

void fg_jpeg_close(fg_jpeg_in *jpeg); /* NULL is fine */

#endif

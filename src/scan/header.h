/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Header of a scan of any format, before its first row, and its resolution. */
#ifndef FG_SCAN_HEADER_H
#define FG_SCAN_HEADER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/scan.h"

typedef struct fg_scan_colour {
  uint8_t red, green, blue;
} fg_scan_colour;

/* A row of samples holds `channels` per pixel: one to a byte (up to 8 bits), one to a uint16_t in
 * host order (16 bits). */
typedef struct fg_scan_header {
  uint64_t width_px, height_px;
  int bit_depth; /* of a sample: 1, 2, 4, 8, 16 */
  int channels;  /* samples of a pixel */
  bool
      colour; /* the first three are red, green, blue; else the first is gray; others are ignored */
  bool inverted;       /* gray: 0 is white */
  bool luminance_only; /* it has colours, of which the reader returns the luminance as gray */
  int jpeg_quality;    /* of a lossy image: by its quantization tables; 0: lossless */
  unsigned white;      /* max of a sample where that is not 2^bit_depth - 1; else 0 */
  bool has_palette;    /* samples are indices into `palette` */
  size_t palette_size;
  fg_scan_colour palette[256];
  double dpi[2];         /* stated in the file, x and y; NaN when not stated */
  const char *no_dpi;    /* then: the reason, in words; NULL: the format has no resolution */
  double dpi_step;       /* of one dot per cm where the file counts whole ones; else 0 */
  char dpi_source[64];   /* the field that states it, for error texts */
  double bytes_min;      /* min size of the file for its image; 0: not known */
  uint64_t memory_bytes; /* memory of the reader: a whole image, a row of tiles */
  char warning[256];     /* odd, but no error; empty: none */
} fg_scan_header;

/* Warning of a file whose foils beyond the first image are not measured. */
#define FG_SCAN_MORE_IMAGES "it holds more than one image: only the first is read"

/* Appends an oddity to a warning of `size` bytes. */
void fg_scan_warn(char *warning, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Fills dpi, dpi_file and averaged of `info`, and its size. `dpi` 0 uses the file's. Errors as
 * fg_scan_open's. */
fg_status fg_resolution_find(fg_context *ctx, const char *name, const fg_scan_header *header,
                             const fg_scan_options *options, fg_scan_info *info);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the reader of any format says of a scan before its first row. */
#ifndef FG_SCAN_HEADER_H
#define FG_SCAN_HEADER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct fg_scan_loop_colour {
  uint8_t red, green, blue;
} fg_scan_loop_colour;

/* A row of samples holds `channels` per pixel: one to a byte (up to 8 bits), one to a uint16_t in
 * host order (16 bits). */
typedef struct fg_scan_header {
  uint64_t width_px, height_px;
  int bit_depth; /* of a sample: 1, 2, 4, 8, 16 */
  int channels;  /* samples of a pixel */
  bool colour;   /* the first three are red, green, blue; else the first is gray; others are left */
  bool inverted; /* gray: 0 is white */
  bool luminance_only; /* it has colours, of which the reader gives the luminance as gray */
  int jpeg_quality;    /* of what has lost: as its quantization tables tell; 0: without loss */
  unsigned white;      /* a sample's largest value where that is not 2^bit_depth - 1; else 0 */
  bool has_palette;    /* samples are indices into `palette` */
  size_t palette_size;
  fg_scan_loop_colour palette[256];
  double dpi[2];         /* as the file says, x and y; NaN when it says none */
  const char *no_dpi;    /* then: why, in words; NULL: the format has no resolution */
  char dpi_source[64];   /* which field says it, for error texts */
  double bytes_min;      /* that the file must have to hold the image; 0: not known */
  uint64_t memory_bytes; /* that the reader will hold: a whole image, a row of tiles */
  char warning[256];     /* what is odd and not wrong; empty when nothing is */
} fg_scan_header;

#endif

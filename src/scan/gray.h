/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conversion of rows of samples to rows of gray. */
#ifndef FG_SCAN_GRAY_H
#define FG_SCAN_GRAY_H

#include <stddef.h>
#include <stdint.h>

#include "foilgauge/scan.h"
#include "scan/header.h"

typedef struct fg_gray fg_gray;

typedef void fg_gray_convert(const fg_gray *gray, const void *samples, size_t width, void *out);

struct fg_gray {
  fg_gray_convert *convert; /* NULL: the samples are the gray values already */
  int channels;             /* samples per pixel */
  int taken;                /* index of the sample to copy, where gray is one sample */
  int bytes_per_pixel;      /* of the gray row: 1 or 2 */
  unsigned white;           /* 16 bit: max of a sample */
  size_t table_size;        /* samples at or above it are invalid; 0: no table */
  uint8_t table[256];       /* sample or palette index to gray */
};

/* Chooses the conversion. `channel` (not FG_CHANNEL_AUTO) matters where there are colours. */
void fg_gray_init(const fg_scan_header *header, fg_channel channel, fg_gray *gray);

/* Returns the first column whose sample the table does not have; `width` when there is none. */
size_t fg_gray_find_invalid(const fg_gray *gray, const void *samples, size_t width);

#endif

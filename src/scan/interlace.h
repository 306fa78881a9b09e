/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An interlaced (Adam7) image is decoded whole, because its rows come in no useful order. */
#ifndef FG_SCAN_INTERLACE_H
#define FG_SCAN_INTERLACE_H

#include "scan/png_reader.h"

/* Reads all rows of samples, one after another, to `image`; `row` has room for one of them. */
fg_status fg_interlace_read(fg_context *ctx, fg_png *png, void *row, uint8_t *image);

#endif

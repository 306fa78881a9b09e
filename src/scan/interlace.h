/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An interlaced (Adam7) image: its rows come in no useful order, so it is decoded whole. */
#ifndef FG_SCAN_INTERLACE_H
#define FG_SCAN_INTERLACE_H

#include "scan/png_reader.h"

/* All rows of samples, one after another, to `image`; `row` is room for one of them. */
fg_status fg_interlace_read(fg_context *ctx, fg_png *png, void *row, uint8_t *image);

#endif

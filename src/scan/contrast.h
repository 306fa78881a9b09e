/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which channel of a colour scan shows the parts best. */
#ifndef FG_SCAN_CONTRAST_H
#define FG_SCAN_CONTRAST_H

#include "foilgauge/scan.h"
#include "scan/header.h"

/* The contrast of a channel: the sum of the ranges of short runs of pixels, as far as a range is
 * beyond noise and shading. Every few rows are looked at. */
typedef struct fg_contrast {
  const fg_scan_header *header; /* with colours or a palette */
  uint64_t sums[3];             /* red, green, blue; in 8-bit counts */
} fg_contrast;

void fg_contrast_add_row(fg_contrast *contrast, int64_t row, const void *samples);

/* Of equal ones green, which the eye and most sensors see best. */
fg_channel fg_contrast_best(const fg_contrast *contrast);

#endif

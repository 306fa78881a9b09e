/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Choice of the channel of a colour scan that shows the parts best. */
#ifndef FG_SCAN_CONTRAST_H
#define FG_SCAN_CONTRAST_H

#include "foilgauge/scan.h"
#include "scan/header.h"

/* Contrast of a channel: the sum of the ranges of short runs of pixels, as far as a range is beyond
 * noise and shading. Rows are sampled. */
typedef struct fg_contrast {
  const fg_scan_header *header; /* with colours or a palette */
  uint64_t sums[3];             /* red, green, blue; in 8-bit counts */
} fg_contrast;

void fg_contrast_add_row(fg_contrast *contrast, int64_t row, const void *samples);

/* Returns the channel of most contrast; of equal ones green, to which the eye and most sensors are
 * most sensitive. */
fg_channel fg_contrast_best(const fg_contrast *contrast);

#endif

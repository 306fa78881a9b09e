/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Resolution and orientation in EXIF data: a TIFF directory in a JPEG's APP1. */
#ifndef FG_SCAN_EXIF_H
#define FG_SCAN_EXIF_H

#include <stddef.h>
#include <stdint.h>

typedef struct fg_exif {
  double dpi[2];   /* NaN: not stated */
  int orientation; /* 1: upright; 0: not stated */
} fg_exif;

/* `bytes` is the content of an APP1 after its length; damaged values count as not stated. */
void fg_exif_read(const uint8_t *bytes, size_t length, fg_exif *exif);

#endif

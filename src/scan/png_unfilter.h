/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The filters of PNG undone (PNG specification, section 9). */
#ifndef FG_SCAN_PNG_UNFILTER_H
#define FG_SCAN_PNG_UNFILTER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Behind a row as many bytes may be read, whatever they are. */
enum { FG_PNG_ROW_SLACK = 8 };

/* Undoes `filter` in place. `above` is the row before, undone; of the first row: zeros. Both have
 * `row_bytes`; a pixel has `pixel_bytes`: 1, 2, 3, 4, 6 or 8. False: there is no such filter. */
bool fg_png_unfilter(unsigned filter, size_t pixel_bytes, const uint8_t *above, uint8_t *row,
                     size_t row_bytes);

#endif

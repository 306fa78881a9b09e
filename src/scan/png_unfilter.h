/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inverse of PNG's filters (PNG specification, section 9). */
#ifndef FG_SCAN_PNG_UNFILTER_H
#define FG_SCAN_PNG_UNFILTER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Number of bytes after a row that may be read; their values do not matter. */
enum { FG_PNG_ROW_SLACK = 8 };

/* Undoes `filter` in place. `above` is the unfiltered row before; of the first row: zeros. Both
 * have `row_bytes`; a pixel has `pixel_bytes`: 1, 2, 3, 4, 6 or 8. False: there is no such filter.
 */
bool fg_png_unfilter(unsigned filter, size_t pixel_bytes, const uint8_t *above, uint8_t *row,
                     size_t row_bytes);

#endif

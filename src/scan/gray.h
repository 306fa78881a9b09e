/* Rows of PNG samples to rows of gray. */
#ifndef FG_SCAN_GRAY_H
#define FG_SCAN_GRAY_H

#include <stddef.h>
#include <stdint.h>

#include "foilgauge/status.h"

typedef struct fg_gray fg_gray;

/* Samples come one to a byte (up to 8 bits) or one to a uint16_t in host order (16 bits). */
typedef void fg_gray_convert(const fg_gray *gray, const void *samples, size_t width, void *out);

struct fg_gray {
  fg_gray_convert *convert; /* NULL: the samples are the gray values already */
  int channels;             /* samples per pixel: 1 to 4 */
  int bytes_per_pixel;      /* of the gray row: 1 or 2 */
  size_t table_size;        /* samples at or above it have no meaning; 0: no table */
  uint8_t table[256];       /* sample or palette index to gray */
};

typedef struct fg_gray_colour {
  uint8_t red, green, blue;
} fg_gray_colour;

/* Chooses the conversion. `palette` (of `palette_size` colours) is NULL when samples are no palette
 * indices. */
void fg_gray_init(fg_gray *gray, int channels, int bit_depth, const fg_gray_colour *palette,
                  size_t palette_size);

/* The first column whose sample the table does not have; `width` when there is none. */
size_t fg_gray_find_invalid(const fg_gray *gray, const void *samples, size_t width);

#endif

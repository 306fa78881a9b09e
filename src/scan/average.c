/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/average.h"

#include <stdlib.h>
#include <string.h>

fg_status fg_average_open(fg_context *ctx, fg_average *a) {
  if (a->columns == 1 && a->rows == 1) return FG_OK;
  return fg_memory_allocate(ctx, a->width + 1, sizeof *a->sums, (void **)&a->sums);
}

void fg_average_close(fg_average *a) {
  free(a->sums);
  a->sums = NULL;
}

void fg_average_add(fg_average *a, const void *row) {
  const uint8_t *narrow = row;
  const uint16_t *wide = row;
  size_t columns = (size_t)a->columns;
  for (size_t x = 0; x < a->width; x++)
    for (size_t c = 0; c < columns; c++)
      a->sums[x] += a->bytes_per_pixel == 1 ? narrow[x * columns + c] : wide[x * columns + c];
}

void fg_average_put(fg_average *a, void *out) {
  uint8_t *narrow = out;
  uint16_t *wide = out;
  uint32_t count = (uint32_t)(a->columns * a->rows);
  for (size_t x = 0; x < a->width; x++) {
    uint32_t mean = (a->sums[x] + count / 2) / count;
    if (a->bytes_per_pixel == 1)
      narrow[x] = (uint8_t)mean;
    else
      wide[x] = (uint16_t)mean;
  }
  memset(a->sums, 0, a->width * sizeof *a->sums);
}

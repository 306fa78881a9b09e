/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/interlace.h"

#include <string.h>

/* Adam7 (PNG specification, section 8.2): begin and step of each pass. */
static const struct pass {
  uint8_t x, y, step_x, step_y;
} passes[] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
              {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};

static size_t pixel_bytes(const fg_png_header *header) {
  return (size_t)header->channels * (header->bit_depth == 16 ? 2 : 1);
}

static fg_status read_pass(fg_context *ctx, fg_png *png, const struct pass *pass, void *row,
                           uint8_t *image) {
  const fg_png_header *header = fg_png_get_header(png);
  size_t bytes = pixel_bytes(header), width = header->width_px;
  if (pass->x >= width) return FG_OK;
  for (size_t y = pass->y; y < header->height_px; y += pass->step_y) {
    FG_TRY(fg_png_read_row(ctx, png, row));
    const uint8_t *from = row;
    for (size_t x = pass->x; x < width; x += pass->step_x, from += bytes)
      memcpy(image + (y * width + x) * bytes, from, bytes);
  }
  return FG_OK;
}

fg_status fg_interlace_read(fg_context *ctx, fg_png *png, void *row, uint8_t *image) {
  for (size_t i = 0; i < sizeof passes / sizeof passes[0]; i++)
    FG_TRY(read_pass(ctx, png, &passes[i], row, image));
  return FG_OK;
}

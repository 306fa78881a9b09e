#include "scan/interlace.h"

#include <string.h>

/* Adam7 (PNG specification, section 8.2): where each pass begins and how it steps. */
static const struct pass {
  uint8_t x, y, step_x, step_y;
} passes[] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
              {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};

static void scatter(const uint8_t *grays, const fg_row_place *place, size_t bytes, uint8_t *row) {
  for (size_t i = 0; i < place->count; i++)
    memcpy(row + (place->begin + i * place->step) * bytes, grays + i * bytes, bytes);
}

static fg_status read_pass(fg_context *ctx, const fg_row_reader *reader, const struct pass *pass,
                           void *grays, uint8_t *image) {
  const fg_png_header *header = fg_png_get_header(reader->png);
  size_t bytes = (size_t)reader->gray.bytes_per_pixel;
  size_t width = header->width_px;
  if (pass->x >= width) return FG_OK;
  fg_row_place place = {.count = (width - pass->x + pass->step_x - 1) / pass->step_x,
                        .begin = pass->x,
                        .step = pass->step_x};
  for (place.y = pass->y; place.y < header->height_px; place.y += pass->step_y) {
    FG_TRY(fg_row_read(ctx, reader, &place, grays));
    scatter(grays, &place, bytes, image + place.y * width * bytes);
  }
  return FG_OK;
}

fg_status fg_interlace_read(fg_context *ctx, const fg_row_reader *reader, void *grays,
                            void *image) {
  for (size_t i = 0; i < sizeof passes / sizeof passes[0]; i++)
    FG_TRY(read_pass(ctx, reader, &passes[i], grays, image));
  return FG_OK;
}

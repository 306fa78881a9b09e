#include "scan/row.h"

fg_status fg_row_read(fg_context *ctx, const fg_row_reader *reader, const fg_row_place *place,
                      void *out) {
  const fg_gray *gray = &reader->gray;
  if (!gray->convert) return fg_png_read_row(ctx, reader->png, out);
  FG_TRY(fg_png_read_row(ctx, reader->png, reader->samples));
  size_t invalid = fg_gray_find_invalid(gray, reader->samples, place->count);
  if (invalid < place->count)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: is a damaged PNG: the pixel at row %zu, column %zu has colour %d of a "
                   "palette of %zu; copy or scan it again",
                   reader->name, place->y + 1, place->begin + invalid * place->step + 1,
                   ((const uint8_t *)reader->samples)[invalid], gray->table_size);
  gray->convert(gray, reader->samples, place->count, out);
  return FG_OK;
}

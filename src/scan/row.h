/* One row of a PNG as gray. */
#ifndef FG_SCAN_ROW_H
#define FG_SCAN_ROW_H

#include "scan/gray.h"
#include "scan/png_reader.h"

typedef struct fg_row_reader {
  const char *name; /* of the scan, for error texts */
  fg_png *png;
  fg_gray gray;
  void *samples; /* room for a row of samples; NULL where they need no conversion */
} fg_row_reader;

/* What the row is of the image: pixels begin, begin + step, ... of row y. */
typedef struct fg_row_place {
  size_t count, y, begin, step;
} fg_row_place;

/* The next row, as gray, to `out` (room for the full width of the image). FG_ERR_DATA also when it
 * uses a colour that the palette does not have. */
fg_status fg_row_read(fg_context *ctx, const fg_row_reader *reader, const fg_row_place *place,
                      void *out);

#endif

/* An interlaced (Adam7) image: its rows come in no useful order, so it is decoded whole. */
#ifndef FG_SCAN_INTERLACE_H
#define FG_SCAN_INTERLACE_H

#include "scan/row.h"

/* All rows as gray, one after another, to `image`; `grays` is room for one row of gray. */
fg_status fg_interlace_read(fg_context *ctx, const fg_row_reader *reader, void *grays, void *image);

#endif

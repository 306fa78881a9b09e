/* From a scan that is held as tiles to the foils in it. */
#ifndef FG_MEASURE_OBJECTS_H
#define FG_MEASURE_OBJECTS_H

#include "foilgauge/foil.h"
#include "vision/tiles.h"

/* Measures everything in `tiles`. Reads design and dpi of `measurement` (and scan, for messages);
 * fills polarity, specks and foils. On failure too the caller frees it with fg_measurement_free.
 * FG_ERR_DATA when there is no foil. */
fg_status fg_measure_tiles(fg_context *ctx, const fg_tiles *tiles, unsigned threads,
                           fg_measurement *measurement);

#endif

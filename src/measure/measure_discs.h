/* Every round feature of a scan. */
#ifndef FG_MEASURE_MEASURE_DISCS_H
#define FG_MEASURE_MEASURE_DISCS_H

#include "foilgauge/foil.h"
#include "vision/tiles.h"

/* Fills discs, disc_count, specks and light_on_dark of `m`, whose scan, dpi and design are set.
 * FG_ERR_DATA when there is no round feature. The result does not depend on `threads`. */
fg_status fg_measure_discs(fg_context *ctx, const fg_tiles *tiles, unsigned threads,
                           fg_measurement *m);

#endif

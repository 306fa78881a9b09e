/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every round feature of a scan. */
#ifndef FG_MEASURE_DISCS_H
#define FG_MEASURE_DISCS_H

#include "foilgauge/foil.h"
#include "vision/disc_find.h"
#include "vision/tiles.h"

/* Fills discs, disc_count, specks and light_on_dark of `m`, whose scan, dpi and design are set.
 * FG_ERR_DATA when there is no round feature. The result does not depend on `threads`. */
fg_status fg_measure_discs(fg_context *ctx, const fg_tiles *tiles, unsigned threads,
                           fg_measurement *m);

/* Measures the round feature near a candidate in tiles of the scan of `m`. Without points: there is
 * none. The caller frees it. */
fg_status fg_measure_disc_near(fg_context *ctx, const fg_tiles *tiles, const fg_pixel_shape *shape,
                               const fg_measurement *m, const fg_disc_candidate *candidate,
                               fg_disc *disc);

#endif

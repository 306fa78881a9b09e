/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The grid of a scan. */
#ifndef FG_MEASURE_GRIDS_H
#define FG_MEASURE_GRIDS_H

#include "foilgauge/foil.h"
#include "vision/tiles.h"

/* Fills the grid of `m`, whose scan, dpi and design are set. FG_ERR_DATA when there is none. The
 * result does not depend on `threads`. */
fg_status fg_measure_grid(fg_context *ctx, const fg_tiles *tiles, unsigned threads,
                          fg_measurement *m);

#endif

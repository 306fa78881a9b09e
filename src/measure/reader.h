/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of a scan into tiles: one thread decodes while another reduces. */
#ifndef FG_MEASURE_READER_H
#define FG_MEASURE_READER_H

#include "foilgauge/scan.h"
#include "vision/tiles.h"

/* Called after each strip (and once more after the last, when all tiles are decided). */
typedef fg_status fg_reader_visit(fg_context *ctx, fg_tiles *tiles, void *data);

/* Reads the whole scan into `tiles` (created here; the caller frees them), and its SHA-256. The
 * tiles do not depend on threads: strips are accepted in order. */
fg_status fg_reader_run(fg_context *ctx, fg_scan *scan, fg_reader_visit *visit, void *data,
                        fg_budget *budget, fg_tiles *tiles, char sha256[65]);

#endif

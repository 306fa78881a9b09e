/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The level of a scan's edges, told by something of known width, and the edges moved to it. */
#ifndef FG_MEASURE_LEVEL_H
#define FG_MEASURE_LEVEL_H

#include "foilgauge/foil.h"

/* Share of the contrast, from dark to bright, at which the true edges of a scan are. */
typedef struct fg_level {
  double half, u;
  double contrast; /* of what told it, counts of 255 */
} fg_level;

/* Normal equations of (h, scale error), see foilgauge/gauge.h. */
typedef struct fg_level_sum {
  double hh, he, ee, h, e, squares, contrast;
  size_t count;
} fg_level_sum;

/* Adds what something of known width reads. */
void fg_level_add(fg_level_sum *sum, const fg_gauge *gauge, const fg_gauge_reading *reading);

/* The level, with a scale error of this standard deviation beside it; u is wider where what was
 * added scatters by more than its own u. Returns what chi² / dof is; 0 of one alone. */
double fg_level_solve(const fg_level_sum *sum, double u_scale, fg_level *level);

/* Standard uncertainty of a relative scale error that is found beside an unknown level. */
double fg_level_u_scale(const fg_level_sum *sum);

/* From the gauges that were found in the scan: the level, and what each of them says by itself
 * (m->gauges). False where none is to be used. */
bool fg_level_of_gauges(fg_measurement *m, fg_level *level);

/* Moves every edge of `m` to the level and measures again; `picture` of each strip and disc says by
 * how much. */
fg_status fg_level_apply(fg_context *ctx, const fg_level *level, unsigned threads,
                         fg_measurement *m);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The level of a scan's edges, by objects of known width, and the edges moved to it. */
#ifndef FG_MEASURE_LEVEL_H
#define FG_MEASURE_LEVEL_H

#include "foilgauge/foil.h"

/* Share of the contrast, from dark to bright, at which the true edges of a scan are. */
typedef struct fg_level {
  double half, u;
  double contrast; /* of the objects that gave it, counts of 255 */
} fg_level;

/* Normal equations of (h, scale error), see foilgauge/gauge.h. */
typedef struct fg_level_sum {
  double hh, he, ee, h, e, squares, contrast;
  size_t count;
} fg_level_sum;

/* Adds the reading of an object of known width. */
void fg_level_add(fg_level_sum *sum, const fg_gauge *gauge, const fg_gauge_reading *reading);

/* Solves for the level, with a nuisance scale error of this standard deviation; u is wider where
 * the readings scatter by more than their own u. Returns chi² / dof; 0 of one reading. */
double fg_level_solve(const fg_level_sum *sum, double u_scale, fg_level *level);

/* Returns true where the readings scatter about the level and the scale by more than chance. */
bool fg_level_is_contradicted(const fg_level_sum *sum, double ratio);

/* Standard uncertainty of a relative scale error estimated together with an unknown level. */
double fg_level_u_scale(const fg_level_sum *sum);

/* Finds the level from the gauges of the scan, and each gauge's own level (m->gauges); false where
 * none is usable. */
bool fg_level_of_gauges(fg_measurement *m, fg_level *level);

/* Moves every edge of `m` to the level and measures again; `picture` of each strip and disc holds
 * the move. */
fg_status fg_level_apply(fg_context *ctx, const fg_level *level, unsigned threads,
                         fg_measurement *m);

#endif

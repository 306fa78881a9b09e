/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The level of all edges of a plate beside its scale. */
#ifndef FG_EFFECT_SEARCH_COMMON_LEVEL_H
#define FG_EFFECT_SEARCH_COMMON_LEVEL_H

#include "rows/edge_fit.h"

/* Shift of every radius that the level of the edges, common to all discs, may still cause, µm: the
 * doubt that each scan states, or less, where gauges of known and of several sizes tell the level
 * from a scale. `scale` is the column of the scale at the rows, `residual_um` what it is fitted to.
 */
double fg_common_level_left(const fg_edge_fit *edge_fit, const double *scale,
                            const double *residual_um);

#endif

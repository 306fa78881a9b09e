/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainty that a plate's common edge level leaves in its scale. */
#ifndef FG_EFFECT_SEARCH_COMMON_LEVEL_H
#define FG_EFFECT_SEARCH_COMMON_LEVEL_H

#include "rows/edge_fit.h"

/* Returns the shift of every radius that the level of the edges, common to all discs, may still
 * cause, µm. It is the uncertainty that each scan states, or less where gauges of known and of
 * several sizes tell the level from a scale. `scale` is the column of the scale at the rows,
 * `residual_um` the residual that it is fitted to. */
double fg_common_level_uncertainty(const fg_edge_fit *edge_fit, const double *scale,
                                   const double *residual_um);

#endif

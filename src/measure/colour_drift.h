/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drift along y of the shift between two channels. */
#ifndef FG_MEASURE_COLOUR_DRIFT_H
#define FG_MEASURE_COLOUR_DRIFT_H

#include "measure/colour_fit.h"

/* Finds dy over windows along y beside the other unknowns of `rows`, the smooth curve through them,
 * and the test for a constant one: into the drift of `shift`. `rows` must be fitted with a
 * constant dy; where that does not hold they get the values found beside the drift. *told false:
 * the rows do not determine it. */
fg_status fg_colour_drift_find(fg_context *ctx, fg_colour_rows *rows, fg_colour_shift *shift,
                               bool *told);

/* Returns the smooth drift at a place, um, between the windows' middles; beyond them it is
 * constant. */
double fg_colour_drift_at(const fg_colour_shift *shift, double y_mm);

#endif

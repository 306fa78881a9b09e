/* Effects of scanner and part over the rows of points. */
#ifndef FG_LOOP_POINTS_EFFECTS_H
#define FG_LOOP_POINTS_EFFECTS_H

#include "foilgauge/loop.h"
#include "loop/points.h"

/* Columns of an effect at the rows: um of residual per um of amplitude. `columns` is
 * FG_LOOP_COLUMNS × row_count; returns how many were filled, 0 for an id that is not known. */
size_t fg_points_effect_columns(const fg_points *points, const char *id, const double *shape,
                                double *columns);

#endif

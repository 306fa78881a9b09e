/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Problems on settings that are not the data's, for evaluating effects there.
 *
 * Every coordinate of a grid has as many values as the grid has rows, axis or not, and no value
 * of the data: so an effect over two coordinates never mixes a column of the data with one of the
 * grid. */
#ifndef FG_TABLE_LOOP_GRID_H
#define FG_TABLE_LOOP_GRID_H

#include "foilgauge/loop.h"

/* All coordinates are 0 until fg_engine_grid_axis. Free with fg_engine_grid_close. */
fg_status fg_engine_grid_open(fg_context *ctx, const fg_loop_problem *problem, size_t rows,
                              fg_loop_problem *grid);
/* Gives a coordinate values of its own; the caller fills *value, which has the grid's rows. */
fg_status fg_engine_grid_axis(fg_context *ctx, fg_loop_problem *grid, size_t coordinate,
                              double **value);
void fg_engine_grid_close(fg_loop_problem *grid);

#endif

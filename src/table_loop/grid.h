/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Settings of one's own: a problem whose rows are not the data's, for evaluating effects there.
 *
 * Every coordinate of a grid has as many values as the grid has rows, whether it is an axis or not,
 * and nothing in it is the data's: an effect over two coordinates cannot meet one of each kind. */
#ifndef FG_TABLE_LOOP_GRID_H
#define FG_TABLE_LOOP_GRID_H

#include "foilgauge/loop.h"

/* All coordinates are 0 until fg_engine_grid_axis. Free with fg_engine_grid_close. */
fg_status fg_engine_grid_open(fg_context *ctx, const fg_loop_problem *problem, size_t rows,
                              fg_loop_problem *grid);
/* Gives a coordinate values of its own; *value has room for the grid's rows. */
fg_status fg_engine_grid_axis(fg_context *ctx, fg_loop_problem *grid, size_t coordinate,
                              double **value);
void fg_engine_grid_close(fg_loop_problem *grid);

#endif

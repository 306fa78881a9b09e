/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests between groups. A column that is constant in every group that shares a level is tested by
 * the differences between groups: its dof are those of groups, not of rows. */
#ifndef FG_TABLE_LOOP_BETWEEN_H
#define FG_TABLE_LOOP_BETWEEN_H

#include "table_loop/engine.h"

/* Returns true when unwhitened columns are constant in levels; false when groups share no level. */
bool fg_engine_constant_in_levels(const fg_engine_training *training, const double *columns,
                                  size_t count);

/* The same in outer levels. */
bool fg_engine_constant_in_outer_levels(const fg_engine_training *training, const double *columns,
                                        size_t count);

/* Finds orthonormal whitened columns of the differences between groups, beside the null's span:
 * *between_rank × n, the caller's to free. None (NULL, 0) when groups share no level, or are so
 * many that their dof equal the rows'. */
fg_status fg_engine_between_basis(fg_context *ctx, const fg_engine_training *training,
                                  fg_engine_noise noise, const fg_engine_span *null,
                                  double **between, size_t *between_rank);

#endif

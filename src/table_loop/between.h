/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is the same at every row of a group that shares a level is judged between groups: by what
 * groups differ, with as many degrees of freedom as groups leave, however many rows they have. */
#ifndef FG_TABLE_LOOP_BETWEEN_H
#define FG_TABLE_LOOP_BETWEEN_H

#include "table_loop/engine.h"

/* Not whitened; false where groups share no level. */
bool fg_engine_constant_in_levels(const fg_engine_training *training, const double *columns,
                                  size_t count);

/* Orthonormal whitened columns of all that groups may differ by, beside the null's span:
 * *between_rank × n, the caller's to free. None (NULL, 0) where groups share no level or are so
 * many that their freedom is as good as the rows'. */
fg_status fg_engine_between_basis(fg_context *ctx, const fg_engine_training *training,
                                  fg_engine_noise noise, const fg_engine_span *null,
                                  double **between, size_t *between_rank);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows that lead the fit. */
#ifndef FG_TABLE_LOOP_INFLUENCE_H
#define FG_TABLE_LOOP_INFLUENCE_H

#include "table_loop/run.h"

/* Fills result->influence: rows without which the parameters leave the ellipsoid that holds them
 * with 50 % (Cook 1977), beside everything found. Needs result->parameter in the engine's units. */
fg_status fg_engine_find_influence(fg_context *ctx, fg_engine_run *run, fg_engine_noise noise);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef FG_REPORT_TABLE_LOOP_FITTED_H
#define FG_REPORT_TABLE_LOOP_FITTED_H

#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"

/* Draws the response as measured over a column, and the model with all effects found; `left` is the
 * residual of that model, of each row. */
fg_status fg_loop_fitted_put(fg_context *ctx, FILE *out, const fg_loop_report *report,
                             const fg_loop_coordinate *at, const double *left);

#endif

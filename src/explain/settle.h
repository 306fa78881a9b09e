/* What a search and a fit in turns need, of foils and of discs. */
#ifndef FG_EXPLAIN_SETTLE_H
#define FG_EXPLAIN_SETTLE_H

#include "scan_loop/state.h"

bool fg_settle_same_effects(const fg_effect_set *a, const fg_effect_set *b);

/* Residual (um) and Jacobian at the set's geometry, with what the set does put back, linearly. */
fg_status fg_settle_put_back(fg_context *ctx, fg_points *points, const fg_effect_set *set,
                             double *residual_um, double *jacobian);

/* Weighted sum of squares over the rows that are not kept aside. */
double fg_settle_square(const fg_points *points, const double *residual_um);

/* Fits a set from the geometry that stands. One that runs away, or leaves more than `none` (what no
 * effect at all leaves), is given up: then the set is empty. `geometry` has room for its numbers.
 */
fg_status fg_settle_fit(fg_context *ctx, fg_points *points, fg_effect_set *set, double none,
                        double *geometry, double *residual_um);

/* Rows that lie across a step hold some of both sides: those nearer to it lose their weight. */
void fg_settle_leave_steps_out(fg_points *points, const fg_effect_set *set, double half_mm);

#endif

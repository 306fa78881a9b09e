/* What a search and a fit in turns need, of foils and of discs. */
#ifndef FG_LOOP_SETTLE_H
#define FG_LOOP_SETTLE_H

#include "loop/scan_loop.h"

bool fg_settle_same_effects(const fg_scan_set *a, const fg_scan_set *b);

/* Residual (um) and Jacobian at the set's geometry, with what the set does put back, linearly. */
fg_status fg_settle_put_back(fg_context *ctx, fg_points *points, const fg_scan_set *set,
                             double *residual_um, double *jacobian);

/* Rows that lie across a step hold some of both sides: those nearer to it lose their weight. */
void fg_settle_leave_steps_out(fg_points *points, const fg_scan_set *set, double half_mm);

#endif

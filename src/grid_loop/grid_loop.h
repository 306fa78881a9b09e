/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of the loop on grids, shared by its files. */
#ifndef FG_GRID_LOOP_GRID_LOOP_H
#define FG_GRID_LOOP_GRID_LOOP_H

#include "grid_loop/search.h"
#include "scan_loop/scanner_model.h"

struct fg_grid_loop {
  fg_grid_loop_options options;
  fg_measurement *measurements; /* owned; of the scans that the loop learns from, then held out */
  size_t scan_count, held_out_count;
  grid_problem problem;
  grid_solution solution;
  double widening;         /* factor on standard uncertainties: Student's t at few dof */
  fg_scanner_model *model; /* owned */
  fg_grid_loop_result result;
};

/* Fills the result from the final solution. */
fg_status fg_grid_loop_fill_result(fg_context *ctx, fg_grid_loop *loop);
/* Sentence and advice. */
void fg_grid_loop_write_sentence(fg_grid_loop_result *result);
/* rms of the marks before and after, and on marks that no fit saw: of scans held out, if any. */
fg_status fg_grid_loop_hold_out(fg_context *ctx, fg_grid_loop *loop);
/* Makes the scanner's model: effects and map with their uncertainty. */
fg_status fg_grid_loop_make_model(fg_context *ctx, fg_grid_loop *loop);

/* Variance of the displacement at a place, mm², by jumps whose place the marks tell to a gap. */
fg_point fg_grid_jump_variance(const fg_grid_loop *loop, fg_point at);

/* Standard uncertainty of the place of a jump, mm: anywhere between two marks (GUM 4.3.7). 0: the
 * effect has no jump. */
double fg_grid_jump_u_mm(const grid_problem *problem, const grid_effect *effect);

/* Displacement of the scanner at a place by all columns of the solution: effects and map. Returns
 * how many are not 0. */
size_t fg_grid_displacement_columns(const grid_problem *problem, const grid_columns *columns,
                                    fg_point at, size_t *index, fg_point *value);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of building a problem from a table, for problem.c. */
#ifndef FG_TABLE_LOOP_PARTS_H
#define FG_TABLE_LOOP_PARTS_H

#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"

/* Range of a column's largest magnitude in which squares neither over- nor underflow. */
#define FG_LOOP_TABLE_SMALLEST 1e-304
#define FG_LOOP_TABLE_LARGEST  1e304

typedef struct fg_loop_table_state {
  const fg_table *table;
  const fg_loop_table_spec *spec;
  fg_loop_table_problem *out;
  const char *order; /* column that orders rows (within groups), or NULL */
} fg_loop_table_state;

bool fg_loop_table_is_arc_length(const fg_loop_table_spec *spec);
/* Fills Jacobian, residual and declared columns from a formula, or from the arc length. */
fg_status fg_loop_table_fill_model(fg_context *ctx, const fg_loop_table_state *build);
void fg_loop_table_free_formula(struct fg_loop_formula *formula);
fg_status fg_loop_table_fill_arc_length(fg_context *ctx, const fg_loop_table_state *build);
fg_status fg_loop_table_fill_coordinates(fg_context *ctx, const fg_loop_table_state *build);
fg_status fg_loop_table_add_coordinate(fg_context *ctx, const fg_loop_table_state *build,
                                       const char *name, unsigned roles,
                                       fg_loop_coordinate **added);
void fg_loop_table_finish_coordinate(const fg_loop_problem *problem, fg_loop_coordinate *at);
fg_loop_coordinate *fg_loop_table_coordinate(const fg_loop_problem *problem, const char *name);
/* Returns true for a name with something before that end, a unit, say. */
bool fg_loop_table_name_ends(const char *name, const char *end);
/* Records for the report a column that is no candidate, and the reason. */
fg_status fg_loop_table_leave_out(fg_context *ctx, const fg_loop_table_state *build,
                                  const char *name, const char *why);
/* in codes.c */
void fg_loop_table_drop(fg_loop_problem *problem, size_t coordinate);
/* Keeps one of several columns with the same content; rows without an order of their own use a
 * column's order. */
fg_status fg_loop_table_merge_codes(fg_context *ctx, const fg_loop_table_state *build);
/* in order.c: chooses the order of rows for which none was declared; where there is none, the rows'
 * number is no candidate. */
fg_status fg_loop_table_find_order(fg_context *ctx, const fg_loop_table_state *build);
/* in hold_out.c */
fg_status fg_loop_table_hold_out(fg_context *ctx, const fg_loop_table_state *build);

#endif

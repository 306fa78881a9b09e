/* Steps of building a problem from a table. */
#ifndef FG_LOOP_TABLE_PARTS_H
#define FG_LOOP_TABLE_PARTS_H

#include "foilgauge/loop.h"

/* Magnitudes of a column's largest number that can be computed with. */
#define TABLE_SMALLEST 1e-304
#define TABLE_LARGEST  1e304

typedef struct table_build {
  const fg_table *table;
  const fg_loop_table_spec *spec;
  fg_loop_table_problem *out;
  const char *order; /* column that orders rows (within groups), or NULL */
} table_build;

bool table_is_arc_length(const fg_loop_table_spec *spec);
/* Jacobian, residual and declared columns by a formula, or by the arc length. */
fg_status table_fill_model(fg_context *ctx, const table_build *build);
void table_free_formula(struct fg_loop_formula *formula);
fg_status table_fill_arc_length(fg_context *ctx, const table_build *build);
fg_status table_fill_coordinates(fg_context *ctx, const table_build *build);
fg_status table_add_coordinate(fg_context *ctx, const table_build *build, const char *name,
                               unsigned roles, fg_loop_coordinate **added);
void table_finish_coordinate(const fg_loop_problem *problem, fg_loop_coordinate *at);
fg_loop_coordinate *table_coordinate(const fg_loop_problem *problem, const char *name);
fg_status table_hold_out(fg_context *ctx, const table_build *build);

#endif

/* Effects of scanner and part as rows of the engine's table, over a problem of points. */
#ifndef FG_LOOP_POINTS_EFFECTS_H
#define FG_LOOP_POINTS_EFFECTS_H

#include "foilgauge/loop.h"
#include "loop/points.h"

/* Coordinates of a problem of points, in this order. */
enum {
  FG_POINTS_SCAN_X,
  FG_POINTS_SCAN_Y,
  FG_POINTS_FOIL_S,
  FG_POINTS_BUMP_PHI,
  FG_POINTS_EDGE_NORMAL,
  FG_POINTS_COORDINATES,
};

/* What the engine sees: rows of which every group's own geometry (its bump's X, beta, R) is
 * projected out, so that groups can be left out or flipped as wholes; R0 and the poses stay as
 * columns of the Jacobian. Residuals are in um. */
typedef struct fg_points_problem {
  fg_loop_problem problem;
  const fg_points *points;
  double *own;         /* per row: up to 3 orthonormal values of its group's own columns */
  size_t *own_count;   /* per group */
  double *scale;       /* per group: sqrt(n / (n - own_count)) */
  size_t *group_first; /* per group, into group_row */
  size_t *group_row;
} fg_points_problem;

/* Builds it from points whose geometry is fitted; residual and jacobian as fg_points_residual gave
 * them. `extra` more columns (effects that were accepted: extra_count × rows, in um of residual per
 * unit) become parameters. The points must outlive it. */
fg_status fg_points_problem_build(fg_context *ctx, const fg_points *points, const double *residual,
                                  const double *jacobian, const double *extra, size_t extra_count,
                                  fg_points_problem *problem);
/* v := scale × M v within every group: takes the groups' own geometry out of a column of rows. */
void fg_points_project(const fg_points_problem *problem, double *v);

void fg_points_problem_free(fg_points_problem *problem);

/* The listed effects, and the free curves for what no listed one explains. Both end with id NULL.
 */
const fg_loop_effect *fg_points_effects(void);
const fg_loop_effect *fg_points_free_effects(void);

/* Columns of an effect at the rows, not projected: um of residual per um of amplitude. `columns` is
 * FG_LOOP_COLUMNS × row_count; returns how many were filled. */
size_t fg_points_effect_columns(const fg_points *points, const char *id, const double *shape,
                                double *columns);

#endif

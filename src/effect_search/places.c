/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Search for the best place of a shape: a grid of starts, then finer grids around the best. */
#include <math.h>
#include <stdlib.h>

#include "core/numerics.h"
#include "core/small_solve.h"
#include "effect_search/state.h"

/* Steps of each finer grid between the neighbours of the best place; number of such grids; rows on
 * either side of a step. */
enum { REFINE_STEPS = 24, REFINE_LEVELS = 4, SIDE_ROWS = 12 };
/* A coarse search uses one start in so many. */
enum { COARSER = 40 };
/* Mean square of a column beside the basis, below which it has no information: one row in 64 000.
 */
#define COLUMN_MIN (1e-3 / 64)
/* Its normal equations are singular where a pivot is this share of its diagonal. */
#define SINGULAR 1e-9
/* Limit of a stored grid's columns: beyond it the rows are many, and memory matters. */
#define GRID_BYTES_MAX ((size_t)32 << 20)

/* A step needs rows on both sides that speak of it: one bad row at the foil's end is none. */
static bool has_both_sides(const fg_search_columns *c, const fg_effect *kind, double at_mm) {
  size_t low = 0, all = 0;
  for (size_t i = 0; i < c->rows; i++) {
    const fg_edge_fit_row *row = &c->edge_fit->rows[c->row[i]];
    low += row->weight > 0 && fg_point_along(row->at, kind->axis) < at_mm;
    all += row->weight > 0;
  }
  return low >= SIDE_ROWS && all - low >= SIDE_ROWS;
}

/* Gain of columns beside everything else, in chi². */
static fg_search_hit gain_of(const fg_search *s, size_t rank, double place, size_t count,
                             const double *columns) {
  const fg_search_columns *c = &s->columns;
  double x[FG_SMALL_MAX], square = 0;
  fg_normal_equations system;
  fg_search_hit none = {0, 0, place}, found = none;
  fg_normal_clear(&system, count);
  for (size_t a = 0; a < count; a++) {
    /* `left` is beside the basis already; the products are corrected for the column's part in the
     * basis. */
    system.right[a] = fg_dot_in_lanes(columns + a * c->rows, c->left, c->rows);
    for (size_t b = 0; b <= a; b++)
      system.matrix[a][b] = fg_dot_in_lanes(columns + a * c->rows, columns + b * c->rows, c->rows);
  }
  for (size_t k = 0; k < rank; k++) {
    double along[FG_SMALL_MAX];
    for (size_t a = 0; a < count; a++) {
      along[a] = fg_search_along(c, k, columns + a * c->rows);
      for (size_t b = 0; b <= a; b++)
        system.matrix[a][b] -= along[a] * along[b];
    }
  }
  for (size_t a = 0; a < count; a++)
    if (!(system.matrix[a][a] > COLUMN_MIN * (double)c->rows)) return none;
  if (!fg_normal_solve(&system, SINGULAR, x, NULL)) return none;
  for (size_t a = 0; a < count; a++) {
    found.gain += x[a] * system.right[a];
    square += x[a] * x[a];
  }
  found.gain /= s->out->noise_um * s->out->noise_um * s->out->integral;
  found.amplitude = sqrt(square);
  return found;
}

static fg_search_hit gain_at(const fg_search *s, size_t rank, const fg_effect *kind, double place,
                             double *work) {
  double shape[FG_FIELD_SHAPES] = {place};
  if (kind->jumps && !has_both_sides(&s->columns, kind, place)) return (fg_search_hit){0, 0, place};
  size_t count = fg_search_gather(&s->columns, kind, shape, work);
  return gain_of(s, rank, place, count, work);
}

/* ---- the grid of starts ---- */

/* Returns the columns over all starts; NULL: they would need too much memory. */
static const fg_search_grid *grid_of(fg_search *s, const fg_effect *kind, size_t starts) {
  size_t vector = s->columns.rows * sizeof(double), count = kind->columns;
  for (size_t g = 0; g < s->grids; g++)
    if (s->grid[g].kind == kind) return &s->grid[g];
  if (s->grids == FG_SEARCH_GRIDS || starts * count * vector > GRID_BYTES_MAX) return NULL;
  fg_search_grid *grid = &s->grid[s->grids];
  *grid = (fg_search_grid){kind, starts, count, malloc(starts * count * vector)};
  if (!grid->values) return NULL;
  for (size_t i = 0; i < starts; i++) {
    double shape[FG_FIELD_SHAPES] = {kind->start(&s->columns.edge_fit->frame, i, starts)};
    fg_search_gather(&s->columns, kind, shape, grid->values + i * count * s->columns.rows);
  }
  s->grids++;
  return grid;
}

void fg_search_free_grids(fg_search *s) {
  for (size_t g = 0; g < s->grids; g++)
    free(s->grid[g].values);
  s->grids = 0;
}

static fg_search_hit gain_at_start(fg_search *s, size_t rank, const fg_effect *kind, size_t i,
                                   size_t starts, double *work) {
  double place = kind->start(&s->columns.edge_fit->frame, i, starts);
  const fg_search_grid *grid = grid_of(s, kind, starts);
  if (!grid) return gain_at(s, rank, kind, place, work);
  if (kind->jumps && !has_both_sides(&s->columns, kind, place)) return (fg_search_hit){0, 0, place};
  return gain_of(s, rank, place, grid->columns, grid->values + i * grid->columns * s->columns.rows);
}

/* The best place over a grid of starts, then finer around it. */
fg_search_hit fg_search_find_place(fg_search *s, size_t rank, const fg_effect *kind, double *work) {
  const fg_field_frame *frame = &s->columns.edge_fit->frame;
  fg_search_hit best = {0};
  bool coarse = s->columns.edge_fit->coarse;
  size_t which = 0, starts = kind->starts / (coarse ? COARSER : 1);
  for (size_t i = 0; i < starts; i++) {
    fg_search_hit tried = gain_at_start(s, rank, kind, i, starts, work);
    if (tried.gain <= best.gain) continue;
    best = tried;
    which = i;
  }
  double low = kind->start(frame, which > 0 ? which - 1 : 0, starts);
  double high = kind->start(frame, which + 1 < starts ? which + 1 : which, starts);
  for (int level = 0; level < (coarse ? 1 : REFINE_LEVELS) && best.gain > 0; level++) {
    double step = (high - low) / REFINE_STEPS;
    for (size_t i = 0; i <= REFINE_STEPS; i++) {
      fg_search_hit tried = gain_at(s, rank, kind, low + step * (double)i, work);
      if (tried.gain > best.gain) best = tried;
    }
    low = best.at - step;
    high = best.at + step;
  }
  return best;
}

double fg_search_rest_of_step(const fg_search_columns *c, size_t rank, const fg_effect *kind,
                              double at_mm, double *work) {
  double shape[FG_FIELD_SHAPES] = {at_mm};
  if (!has_both_sides(c, kind, at_mm)) return INFINITY;
  fg_search_gather(c, kind, shape, work);
  double rest = fg_dot_in_lanes(work, work, c->rows);
  for (size_t k = 0; k < rank; k++) {
    double along = fg_search_along(c, k, work);
    rest -= along * along;
  }
  return rest;
}

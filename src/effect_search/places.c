/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Search for the best place of a shape: a grid of starts, then finer grids around the best. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "core/parallel.h"
#include "core/small_solve.h"
#include "effect_search/state.h"

/* Steps of each finer grid between the neighbours of the best place; number of such grids; rows on
 * either side of a step. */
enum { REFINE_STEPS = 24, REFINE_LEVELS = 4, SIDE_ROWS = 12 };
/* Places that a thread looks at without a break. */
enum { AT_ONCE = 9 };
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

/* Places of one shaped effect that threads look at, and their hits. */
typedef struct look {
  const fg_search *search;
  size_t rank;
  const fg_effect *kind;
  const fg_search_grid *grid; /* of the starts' columns; NULL: they are not stored */
  bool fill;                  /* the grid is to be filled */
  double low, step;           /* of places that are no starts */
  size_t starts;              /* 0: no starts */
  fg_search_hit *hit;
  size_t count;
} look;

/* Gain of columns beside everything else, in chi². */
static fg_search_hit gain_of(const look *l, double place, size_t count, const double *columns) {
  const fg_search_columns *c = &l->search->columns;
  const fg_explanations *out = l->search->out;
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
  for (size_t k = 0, taken = 1; k < l->rank; k += taken) {
    double along[FG_SMALL_MAX][FG_DOTS_AT_ONCE];
    for (size_t a = 0; a < count; a++) {
      taken = fg_search_along_next(c, l->rank, k, columns + a * c->rows, along[a]);
      for (size_t q = 0; q < taken; q++)
        for (size_t b = 0; b <= a; b++)
          system.matrix[a][b] -= along[a][q] * along[b][q];
    }
  }
  for (size_t a = 0; a < count; a++)
    if (!(system.matrix[a][a] > COLUMN_MIN * (double)c->rows)) return none;
  if (!fg_normal_solve(&system, SINGULAR, x, NULL)) return none;
  for (size_t a = 0; a < count; a++) {
    found.gain += x[a] * system.right[a];
    square += x[a] * x[a];
  }
  found.gain /= out->noise_um * out->noise_um * out->integral;
  found.amplitude = sqrt(square);
  return found;
}

/* Looks at place i; `own` has the thread's room for work, `work` for a start that is not stored. */
static fg_search_hit look_at_place(const look *l, size_t i, const fg_search_columns *own,
                                   double *work) {
  const fg_field_frame *frame = &own->edge_fit->frame;
  double place = l->starts ? l->kind->start(frame, i, l->starts) : l->low + l->step * (double)i;
  double shape[FG_FIELD_SHAPES] = {place};
  double *columns = l->grid ? l->grid->values + i * l->grid->columns * own->rows : work;
  size_t count = l->grid ? l->grid->columns : l->kind->columns;
  if (!l->grid || l->fill) count = fg_search_gather(own, l->kind, shape, columns);
  if (l->kind->jumps && !has_both_sides(own, l->kind, place)) return (fg_search_hit){0, 0, place};
  return gain_of(l, place, count, columns);
}

static fg_status look_at_places(fg_context *ctx, void *shared, size_t item) {
  const look *l = shared;
  fg_search_columns own = l->search->columns;
  size_t end = (item + 1) * AT_ONCE < l->count ? (item + 1) * AT_ONCE : l->count;
  double *work = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_search_columns_open_work(ctx, &own));
  FG_TRY_EXIT(fg_memory_allocate(ctx, own.rows, FG_SMALL_MAX * sizeof *work, (void **)&work));
  for (size_t i = item * AT_ONCE; i < end; i++)
    l->hit[i] = look_at_place(l, i, &own, work);
exit:
  free(work);
  fg_search_columns_close_work(&own);
  return status;
}

static fg_status look_at_all_places(fg_context *ctx, look *l) {
  unsigned threads = l->search->columns.edge_fit->threads;
  return fg_parallel_run(ctx, threads, (l->count + AT_ONCE - 1) / AT_ONCE, look_at_places, l);
}

/* ---- the grid of starts ---- */

/* Looks for the stored columns over all starts, or makes room for them, unless it were too much. */
static void find_grid(fg_search *s, look *l) {
  size_t vector = s->columns.rows * sizeof(double), count = l->kind->columns;
  for (size_t g = 0; g < s->grids; g++)
    if (s->grid[g].kind == l->kind) l->grid = &s->grid[g];
  if (l->grid || s->grids == FG_SEARCH_GRIDS || l->starts * count * vector > GRID_BYTES_MAX) return;
  fg_search_grid *grid = &s->grid[s->grids];
  *grid = (fg_search_grid){l->kind, l->starts, count, malloc(l->starts * count * vector)};
  if (!grid->values) return;
  s->grids++;
  l->grid = grid;
  l->fill = true;
}

void fg_search_free_grids(fg_search *s) {
  for (size_t g = 0; g < s->grids; g++)
    free(s->grid[g].values);
  s->grids = 0;
}

/* Looks at ever finer grids of places between low and high. */
static fg_status look_finer(fg_context *ctx, look *l, double low, double high,
                            fg_search_hit *best) {
  bool coarse = l->search->columns.edge_fit->coarse;
  l->grid = NULL;
  l->starts = 0;
  l->count = REFINE_STEPS + 1;
  for (int level = 0; level < (coarse ? 1 : REFINE_LEVELS) && best->gain > 0; level++) {
    l->low = low;
    l->step = (high - low) / REFINE_STEPS;
    FG_TRY(look_at_all_places(ctx, l));
    for (size_t i = 0; i < l->count; i++)
      if (l->hit[i].gain > best->gain) *best = l->hit[i];
    low = best->at - l->step;
    high = best->at + l->step;
  }
  return FG_OK;
}

fg_status fg_search_find_place(fg_context *ctx, fg_search *s, size_t rank, const fg_effect *kind,
                               fg_search_hit *best) {
  const fg_field_frame *frame = &s->columns.edge_fit->frame;
  size_t which = 0, starts = kind->starts / (s->columns.edge_fit->coarse ? COARSER : 1);
  look l = {.search = s, .rank = rank, .kind = kind, .starts = starts, .count = starts};
  fg_status status = FG_OK;
  *best = (fg_search_hit){0};
  FG_TRY(fg_memory_allocate(ctx, starts > REFINE_STEPS ? starts : REFINE_STEPS + 1, sizeof *l.hit,
                            (void **)&l.hit));
  find_grid(s, &l);
  FG_TRY_EXIT(look_at_all_places(ctx, &l));
  for (size_t i = 0; i < starts; i++) {
    if (l.hit[i].gain <= best->gain) continue;
    *best = l.hit[i];
    which = i;
  }
  FG_TRY_EXIT(look_finer(ctx, &l, kind->start(frame, which > 0 ? which - 1 : 0, starts),
                         kind->start(frame, which + 1 < starts ? which + 1 : which, starts), best));
exit:
  free(l.hit);
  return status;
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

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan_loop/circles.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"

enum { FOLLOWS = 3 };
/* Length by which an arc's end is uncertain at least; and at most, as a share of the arc. */
#define END_MM    0.04
#define END_SHARE 0.15
/* Share of an arc that may be missing at one end: with a tenth more at both, a deviation of fourth
 * degree doubles. */
#define CUT_SHARE 0.1
/* Share of a column's square below which a circle follows it with fewer numbers. */
#define IN_SPAN 1e-9

size_t fg_circles_of_part(const fg_edge_fit *edge_fit, size_t part) {
  size_t count = 0;
  for (size_t p = 0; p < part; p++)
    count += 1 + edge_fit->parts[p].bump_count;
  return count;
}

/* The first view of a part that is not held out stands for it: the part is the same in all. */
static size_t view_of_part(const fg_edge_fit *edge_fit, size_t part) {
  size_t v = 0;
  while (v < edge_fit->view_count &&
         (edge_fit->views[v].part != part || edge_fit->views[v].held_out))
    v++;
  return v;
}

static size_t circle_of_row(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row) {
  return fg_circles_of_part(edge_fit, row->part) + (row->bump ? 1 + row->bump_index : 0);
}

static bool counts(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row) {
  return row->weight > 0 && row->view == view_of_part(edge_fit, row->part);
}

static void sort_by_circle(fg_circles *c) {
  const fg_edge_fit *edge_fit = c->edge_fit;
  size_t at = 0;
  for (size_t k = 0; k < c->count; k++) {
    c->first[k] = at;
    for (size_t i = 0; i < edge_fit->row_count; i++)
      if (circle_of_row(edge_fit, &edge_fit->rows[i]) == k && counts(edge_fit, &edge_fit->rows[i]))
        c->row[at++] = i;
  }
  c->first[c->count] = c->rows = at;
}

static bool is_sure(const fg_circles *c, size_t circle, size_t i) {
  double s_mm = c->edge_fit->rows[c->row[i]].s_mm;
  return s_mm >= c->sure_mm[2 * circle] && s_mm <= c->sure_mm[2 * circle + 1];
}

/* Makes one column of a ring orthonormal to those before it. */
static void orthonormalise(const fg_circles *c, double *ring, int column, size_t from, size_t n) {
  double *own = ring + (size_t)column * c->rows + from, whole = fg_dot(own, own, n);
  for (int twice = 0; twice < 2; twice++)
    for (int b = 0; b < column; b++) {
      const double *other = ring + (size_t)b * c->rows + from;
      double along = fg_dot(own, other, n);
      for (size_t i = 0; i < n; i++)
        own[i] -= along * other[i];
    }
  double left = fg_dot(own, own, n), scale = left > IN_SPAN * whole ? 1 / sqrt(left) : 0;
  for (size_t i = 0; i < n; i++)
    own[i] *= scale;
}

/* A circle that moves and grows shifts its rows by 1 and by the components of their normals. */
static void fill_rings(const fg_circles *c, double *ring, bool sure) {
  for (size_t k = 0; k < c->count; k++) {
    size_t from = c->first[k], n = c->first[k + 1] - from;
    for (int a = 0; a < FOLLOWS; a++) {
      double *own = ring + (size_t)a * c->rows + from;
      for (size_t i = 0; i < n; i++) {
        const fg_point normal = c->edge_fit->rows[c->row[from + i]].normal;
        own[i] = a == 0 ? 1 : a == 1 ? normal.x : normal.y;
        if (sure && !is_sure(c, k, from + i)) own[i] = 0;
      }
      orthonormalise(c, ring, a, from, n);
    }
  }
}

static void remove_circle(const fg_circles *c, const double *ring, size_t circle, double *values) {
  size_t from = c->first[circle], n = c->first[circle + 1] - from;
  for (int a = 0; a < FOLLOWS; a++) {
    const double *own = ring + (size_t)a * c->rows + from;
    double along = fg_dot(own, values + from, n);
    for (size_t i = 0; i < n; i++)
      values[from + i] -= along * own[i];
  }
}

/* ---- ends ---- */

/* Angle that the strip turns by from a land to a bump: their normals look to opposite sides. */
static double turn_between(const fg_edge_fit_row *bump, const fg_edge_fit_row *land) {
  double along = -(bump->normal.x * land->normal.x + bump->normal.y * land->normal.y);
  return acos(fmax(-1, fmin(1, along)));
}

/* Distance of the outermost rows of two arcs that meet without a fillet: half a row each, and what
 * the search for an arc's end keeps clear of it for the blur (geometry/arcs.c). */
static double clear_mm(const fg_edge_fit_view *view) {
  const fg_strip *strip = &view->foil->strip;
  double blur_mm = 1e-3 * fg_strip_blur_um(strip);
  return FG_EDGE_FIT_BLOCK * strip->step_mm + 2 * (1.5 * blur_mm + strip->step_mm);
}

/* Length between a bump's outermost row and the next land's that is no fillet. */
static double missing_mm(const fg_circles *c, size_t lands, const fg_edge_fit_row *bump, int way) {
  const fg_edge_fit_row *land = NULL;
  for (size_t i = c->first[lands]; i < c->first[lands + 1]; i++) {
    const fg_edge_fit_row *row = &c->edge_fit->rows[c->row[i]];
    if (way * (row->s_mm - bump->s_mm) <= 0) continue;
    if (!land || way * (row->s_mm - land->s_mm) < 0) land = row;
  }
  if (!land) return 0;
  const fg_edge_fit_view *view = &c->edge_fit->views[bump->view];
  double fillet = fmax(0, view->measurement->design.bumps.fillet_radius_mm);
  return fabs(land->s_mm - bump->s_mm) - fillet * turn_between(bump, land) - clear_mm(view);
}

static const fg_edge_fit_row *outermost_row(const fg_circles *c, size_t circle, int way) {
  const fg_edge_fit_row *outermost = NULL;
  for (size_t i = c->first[circle]; i < c->first[circle + 1]; i++) {
    const fg_edge_fit_row *row = &c->edge_fit->rows[c->row[i]];
    if (!outermost || way * (row->s_mm - outermost->s_mm) > 0) outermost = row;
  }
  return outermost;
}

static void shorten_circle(fg_circles *c, size_t circle, double end_mm) {
  const fg_edge_fit_row *first = outermost_row(c, circle, -1), *last = outermost_row(c, circle, 1);
  if (!first) return;
  c->cut[circle] = end_mm > CUT_SHARE * (last->s_mm - first->s_mm);
  double end = fmin(fmax(END_MM, end_mm), END_SHARE * (last->s_mm - first->s_mm));
  c->sure_mm[2 * circle] = first->s_mm + end;
  c->sure_mm[2 * circle + 1] = last->s_mm - end;
}

/* A length that is missing may belong to the bump, or to the land. */
static void find_ends(fg_circles *c) {
  for (size_t part = 0; part < c->edge_fit->part_count; part++) {
    size_t lands = fg_circles_of_part(c->edge_fit, part),
           bumps = c->edge_fit->parts[part].bump_count;
    double longest = 0;
    for (size_t b = 1; b <= bumps; b++) {
      double end = 0;
      for (int way = -1; way <= 1; way += 2) {
        const fg_edge_fit_row *row = outermost_row(c, lands + b, way);
        if (row) end = fmax(end, missing_mm(c, lands, row, way));
      }
      shorten_circle(c, lands + b, end);
      longest = fmax(longest, end);
    }
    shorten_circle(c, lands, longest);
  }
}

fg_status fg_circles_open(fg_context *ctx, const fg_edge_fit *edge_fit, fg_circles *c) {
  fg_status status = FG_OK;
  *c = (fg_circles){.edge_fit = edge_fit,
                    .count = fg_circles_of_part(edge_fit, edge_fit->part_count)};
  FG_TRY_EXIT(fg_memory_allocate(ctx, c->count + 1, sizeof *c->first, (void **)&c->first));
  FG_TRY_EXIT(fg_memory_allocate(ctx, edge_fit->row_count, sizeof *c->row, (void **)&c->row));
  sort_by_circle(c);
  size_t numbers = FOLLOWS * c->rows + 1;
  FG_TRY_EXIT(fg_memory_allocate(ctx, numbers, sizeof *c->ring, (void **)&c->ring));
  FG_TRY_EXIT(fg_memory_allocate(ctx, numbers, sizeof *c->sure_ring, (void **)&c->sure_ring));
  FG_TRY_EXIT(fg_memory_allocate(ctx, 2 * c->count + 1, sizeof *c->sure_mm, (void **)&c->sure_mm));
  FG_TRY_EXIT(fg_memory_allocate(ctx, c->count + 1, sizeof *c->cut, (void **)&c->cut));
  find_ends(c);
  fill_rings(c, c->ring, false);
  fill_rings(c, c->sure_ring, true);
exit:
  if (status != FG_OK) fg_circles_close(c);
  return status;
}

void fg_circles_close(fg_circles *c) {
  free(c->first);
  free(c->row);
  free(c->ring);
  free(c->sure_mm);
  free(c->sure_ring);
  free(c->cut);
  *c = (fg_circles){.edge_fit = NULL};
}

void fg_circles_remove(const fg_circles *c, double *values) {
  for (size_t k = 0; k < c->count; k++)
    remove_circle(c, c->ring, k, values);
}

static double peak_to_valley(const fg_circles *c, size_t circle, const double *values, bool sure) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = c->first[circle]; i < c->first[circle + 1]; i++) {
    if (sure && !is_sure(c, circle, i)) continue;
    low = fmin(low, values[i]);
    high = fmax(high, values[i]);
  }
  return high >= low ? high - low : 0;
}

double fg_circles_peak_to_valley(const fg_circles *c, size_t circle, const double *values) {
  return peak_to_valley(c, circle, values, false);
}

double fg_circles_sure_peak_to_valley(const fg_circles *c, size_t circle, double *values) {
  remove_circle(c, c->sure_ring, circle, values);
  return peak_to_valley(c, circle, values, true);
}

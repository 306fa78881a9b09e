/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Residuals of the points from one geometry, their Jacobian, and the fit. */
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "rows/edge_fit.h"

enum { FIT_ROUNDS = 8 };
/* Step of Gauss-Newton that ends the fit, mm and rad; damping as a share of a diagonal, and
 * absolute; growth of the residual by rounding. */
#define STEP_END   1e-9
#define DAMP_SHARE 1e-12
#define DAMP       1e-12
#define ROUNDING   1e-9

/* Returns the first parameter of a part. Order: per part R0, then X, beta, R of every bump; per
 * view O.x, O.y, and a turn unless it is the part's first. */
static size_t first_of_part(const fg_edge_fit *edge_fit, size_t part) {
  size_t at = 0;
  for (size_t p = 0; p < part; p++)
    at += 1 + 3 * edge_fit->parts[p].bump_count;
  return at;
}

static bool is_first_view(const fg_edge_fit *edge_fit, size_t view) {
  for (size_t v = 0; v < view; v++)
    if (edge_fit->views[v].part == edge_fit->views[view].part) return false;
  return true;
}

static size_t first_of_view(const fg_edge_fit *edge_fit, size_t view) {
  size_t at = first_of_part(edge_fit, edge_fit->part_count);
  for (size_t v = 0; v < view; v++)
    at += is_first_view(edge_fit, v) ? 2 : 3;
  return at;
}

void fg_edge_fit_count_parameters(fg_edge_fit *edge_fit) {
  edge_fit->parameters = first_of_view(edge_fit, edge_fit->view_count);
}

void fg_edge_fit_places(const fg_edge_fit_row *row, fg_point middle,
                        fg_point at[FG_EDGE_FIT_PLACES]) {
  fg_point n = row->normal;
  for (int i = 0; i < FG_EDGE_FIT_PLACES; i++) {
    double across = i < 2 ? row->half_width_mm : -row->half_width_mm;
    double along = i % 2 ? row->spread_mm : -row->spread_mm;
    at[i] =
        (fg_point){middle.x + across * n.x - along * n.y, middle.y + across * n.y + along * n.x};
  }
}

/* Position of a row with the corrections in force. */
static fg_point corrected(const fg_edge_fit_row *row, const fg_edge_fit_correction *c) {
  fg_point p = row->at;
  if (c && c->fields && c->fields->count) {
    fg_point at[FG_EDGE_FIT_PLACES];
    fg_edge_fit_places(row, row->at, at);
    for (int i = 0; i < FG_EDGE_FIT_PLACES; i++) {
      fg_point d = fg_field_at(c->fields, at[i]);
      p.x += d.x / FG_EDGE_FIT_PLACES;
      p.y += d.y / FG_EDGE_FIT_PLACES;
    }
  }
  return p;
}

/* The circle of a row in its scan. */
static fg_circle circle_of(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row) {
  const fg_edge_fit_part *part = &edge_fit->parts[row->part];
  const fg_edge_fit_pose *pose = &edge_fit->poses[row->view];
  if (!row->bump) return (fg_circle){pose->origin_mm.x, pose->origin_mm.y, part->overall_radius_mm};
  const fg_edge_fit_bump *bump = &part->bumps[row->bump_index];
  double angle = bump->direction_rad + pose->turn_rad;
  return (fg_circle){pose->origin_mm.x + bump->distance_mm * cos(angle),
                     pose->origin_mm.y + bump->distance_mm * sin(angle), bump->radius_mm};
}

size_t fg_edge_fit_row_parameters(const fg_edge_fit *edge_fit, size_t i,
                                  size_t parameter[FG_EDGE_FIT_ROW_PARAMETERS]) {
  const fg_edge_fit_row *row = &edge_fit->rows[i];
  size_t n = 0, at = first_of_part(edge_fit, row->part), view = first_of_view(edge_fit, row->view);
  if (!row->bump) parameter[n++] = at;
  for (size_t k = 0; row->bump && k < 3; k++)
    parameter[n++] = at + 1 + 3 * row->bump_index + k;
  parameter[n++] = view;
  parameter[n++] = view + 1;
  if (row->bump && !is_first_view(edge_fit, row->view)) parameter[n++] = view + 2;
  return n;
}

/* Derivatives of |p - C| - R: -n by the centre, -1 by the radius. */
static void fill_jacobian(const fg_edge_fit *edge_fit, size_t i, double *jacobian) {
  const fg_edge_fit_row *row = &edge_fit->rows[i];
  size_t rows = edge_fit->row_count, at = first_of_part(edge_fit, row->part);
  size_t view = first_of_view(edge_fit, row->view);
  fg_point n = row->normal;
  jacobian[view * rows + i] = -n.x;
  jacobian[(view + 1) * rows + i] = -n.y;
  if (!row->bump) {
    jacobian[at * rows + i] = edge_fit->parts[row->part].radius_known ? 0 : -1;
    return;
  }
  const fg_edge_fit_bump *bump = &edge_fit->parts[row->part].bumps[row->bump_index];
  double angle = bump->direction_rad + edge_fit->poses[row->view].turn_rad;
  double along = -(n.x * cos(angle) + n.y * sin(angle));
  double across = -bump->distance_mm * (n.y * cos(angle) - n.x * sin(angle));
  size_t b = at + 1 + 3 * row->bump_index;
  jacobian[b * rows + i] = along;
  jacobian[(b + 1) * rows + i] = across;
  jacobian[(b + 2) * rows + i] = -1;
  if (!is_first_view(edge_fit, row->view)) jacobian[(view + 2) * rows + i] = across;
}

static void place_row(fg_edge_fit *edge_fit, fg_edge_fit_row *row, fg_point p) {
  const fg_edge_fit_part *part = &edge_fit->parts[row->part];
  const fg_edge_fit_pose *pose = &edge_fit->poses[row->view];
  double dx = p.x - pose->origin_mm.x, dy = p.y - pose->origin_mm.y, d = hypot(dx, dy);
  row->radial = (fg_point){dx / d, dy / d};
  double angle = atan2(dy, dx) - pose->turn_rad - part->middle_rad;
  row->psi = part->sense * (angle - 2 * M_PI * round(angle / (2 * M_PI)));
  if (!row->bump) return;
  /* The crown faces O; seen from C the numbers run against the angle. */
  const fg_edge_fit_bump *bump = &part->bumps[row->bump_index];
  double turn = row->normal_rad - (bump->direction_rad + pose->turn_rad + M_PI);
  turn -= 2 * M_PI * round(turn / (2 * M_PI));
  row->phi = -part->sense * turn / part->half_arc_rad;
}

void fg_edge_fit_residual(fg_edge_fit *edge_fit, const fg_edge_fit_correction *correction,
                          double *residual, double *jacobian) {
  if (jacobian) memset(jacobian, 0, edge_fit->parameters * edge_fit->row_count * sizeof *jacobian);
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    fg_edge_fit_row *row = &edge_fit->rows[i];
    fg_circle circle = circle_of(edge_fit, row);
    fg_point p = corrected(row, correction);
    double dx = p.x - circle.x, dy = p.y - circle.y, d = hypot(dx, dy);
    row->normal = (fg_point){dx / d, dy / d};
    row->normal_rad = atan2(dy, dx);
    residual[i] = d - circle.radius;
    row->ideal = (fg_point){circle.x + circle.radius * row->normal.x,
                            circle.y + circle.radius * row->normal.y};
    if (correction && correction->shift_mm) residual[i] -= correction->shift_mm[i];
    place_row(edge_fit, row, p);
    if (jacobian) fill_jacobian(edge_fit, i, jacobian);
  }
}

static void move_geometry(fg_edge_fit *edge_fit, const gsl_vector *step) {
  for (size_t p = 0; p < edge_fit->part_count; p++) {
    size_t at = first_of_part(edge_fit, p);
    fg_edge_fit_part *part = &edge_fit->parts[p];
    part->overall_radius_mm -= gsl_vector_get(step, at);
    for (size_t b = 0; b < part->bump_count; b++) {
      part->bumps[b].distance_mm -= gsl_vector_get(step, at + 1 + 3 * b);
      part->bumps[b].direction_rad -= gsl_vector_get(step, at + 2 + 3 * b);
      part->bumps[b].radius_mm -= gsl_vector_get(step, at + 3 + 3 * b);
    }
  }
  for (size_t v = 0; v < edge_fit->view_count; v++) {
    size_t at = first_of_view(edge_fit, v);
    edge_fit->poses[v].origin_mm.x -= gsl_vector_get(step, at);
    edge_fit->poses[v].origin_mm.y -= gsl_vector_get(step, at + 1);
    if (!is_first_view(edge_fit, v)) edge_fit->poses[v].turn_rad -= gsl_vector_get(step, at + 2);
  }
}

/* Solves the normal equations, slightly damped for parameters that no row determines (a bump
 * without rows). */
static fg_status solve_step(fg_context *ctx, const fg_edge_fit *edge_fit, const double *residual,
                            const double *jacobian, gsl_matrix *normal, gsl_vector *step) {
  size_t n = edge_fit->parameters, rows = edge_fit->row_count;
  gsl_matrix_set_zero(normal);
  gsl_vector_set_zero(step);
  for (size_t i = 0; i < rows; i++) {
    size_t own[FG_EDGE_FIT_ROW_PARAMETERS], count = fg_edge_fit_row_parameters(edge_fit, i, own);
    for (size_t a = 0; a < count; a++) {
      double weighted = edge_fit->rows[i].weight * jacobian[own[a] * rows + i];
      *gsl_vector_ptr(step, own[a]) += weighted * residual[i];
      for (size_t b = 0; b < count; b++)
        *gsl_matrix_ptr(normal, own[a], own[b]) += weighted * jacobian[own[b] * rows + i];
    }
  }
  for (size_t a = 0; a < n; a++)
    gsl_matrix_set(normal, a, a, gsl_matrix_get(normal, a, a) * (1 + DAMP_SHARE) + DAMP);
  if (gsl_linalg_cholesky_decomp1(normal) || gsl_linalg_cholesky_svx(normal, step))
    return fg_fail(ctx, FG_ERR_NUMERIC, "the geometry cannot be fitted to these scans");
  return FG_OK;
}

double fg_edge_fit_weighted_square(const fg_edge_fit *edge_fit, const double *residual) {
  double sum = 0;
  for (size_t i = 0; i < edge_fit->row_count; i++)
    sum += edge_fit->rows[i].weight * residual[i] * residual[i];
  return sum;
}

fg_status fg_edge_fit_fit(fg_context *ctx, fg_edge_fit *edge_fit,
                          const fg_edge_fit_correction *correction) {
  fg_status status = FG_OK;
  double *residual = NULL, *jacobian = NULL, *start = NULL, square = INFINITY;
  gsl_matrix *normal = NULL;
  gsl_vector *step = NULL;
  fg_numerics_start();
  size_t n = edge_fit->parameters, rows = edge_fit->row_count;
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, sizeof *residual, (void **)&residual));
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows * n, sizeof *jacobian, (void **)&jacobian));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, fg_edge_fit_geometry_size(edge_fit), sizeof *start, (void **)&start));
  fg_edge_fit_geometry_save(edge_fit, start);
  normal = gsl_matrix_alloc(n, n);
  step = gsl_vector_alloc(n);
  if (!normal || !step) {
    status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu parameters", n);
    goto exit;
  }
  for (int round = 0; round < FIT_ROUNDS; round++) {
    fg_edge_fit_residual(edge_fit, correction, residual, jacobian);
    if (round == 0) square = fg_edge_fit_weighted_square(edge_fit, residual);
    FG_TRY_EXIT(solve_step(ctx, edge_fit, residual, jacobian, normal, step));
    move_geometry(edge_fit, step);
    if (gsl_vector_max(step) < STEP_END && gsl_vector_min(step) > -STEP_END) break;
  }
  fg_edge_fit_residual(edge_fit, correction, residual, NULL);
  if (!(fg_edge_fit_weighted_square(edge_fit, residual) <=
        square * (1 + ROUNDING))) { /* rows too few to lead anywhere */
    fg_edge_fit_geometry_load(edge_fit, start);
    fg_edge_fit_residual(edge_fit, correction, residual, NULL);
  }
exit:
  free(start);
  free(residual);
  free(jacobian);
  gsl_matrix_free(normal);
  gsl_vector_free(step);
  return status;
}

size_t fg_edge_fit_geometry_size(const fg_edge_fit *edge_fit) {
  size_t size = 3 * edge_fit->view_count;
  for (size_t p = 0; p < edge_fit->part_count; p++)
    size += 1 + 3 * edge_fit->parts[p].bump_count;
  return size;
}

/* Visits every number of the geometry in one order. */
static void visit(fg_edge_fit *edge_fit, double *numbers, bool load) {
  size_t n = 0;
#define VISIT(value) (load ? (void)((value) = numbers[n]) : (void)(numbers[n] = (value)), n++)
  for (size_t p = 0; p < edge_fit->part_count; p++) {
    fg_edge_fit_part *part = &edge_fit->parts[p];
    VISIT(part->overall_radius_mm);
    for (size_t b = 0; b < part->bump_count; b++) {
      VISIT(part->bumps[b].distance_mm);
      VISIT(part->bumps[b].direction_rad);
      VISIT(part->bumps[b].radius_mm);
    }
  }
  for (size_t v = 0; v < edge_fit->view_count; v++) {
    VISIT(edge_fit->poses[v].origin_mm.x);
    VISIT(edge_fit->poses[v].origin_mm.y);
    VISIT(edge_fit->poses[v].turn_rad);
  }
#undef VISIT
}

void fg_edge_fit_geometry_save(const fg_edge_fit *edge_fit, double *numbers) {
  fg_edge_fit shallow = *edge_fit; /* only read */
  visit(&shallow, numbers, false);
}

void fg_edge_fit_geometry_load(fg_edge_fit *edge_fit, double *numbers) {
  visit(edge_fit, numbers, true);
}

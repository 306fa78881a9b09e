/* Residuals of the points from one geometry, their Jacobian, and the fit. */
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "rows/points.h"

enum { FIT_ROUNDS = 8 };
/* A step of Gauss-Newton that ends the fit, mm and rad; damping of a diagonal, and beside it;
 * growth of the residual that is rounding. */
#define STEP_END   1e-9
#define DAMP_SHARE 1e-12
#define DAMP       1e-12
#define ROUNDING   1e-9

/* Parameters: per part R0, then X, beta, R of every bump; per view O.x, O.y, and a turn where it
 * is not the part's first. */
static size_t first_of_part(const fg_points *points, size_t part) {
  size_t at = 0;
  for (size_t p = 0; p < part; p++)
    at += 1 + 3 * points->parts[p].bump_count;
  return at;
}

static bool is_first_view(const fg_points *points, size_t view) {
  for (size_t v = 0; v < view; v++)
    if (points->views[v].part == points->views[view].part) return false;
  return true;
}

static size_t first_of_view(const fg_points *points, size_t view) {
  size_t at = first_of_part(points, points->part_count);
  for (size_t v = 0; v < view; v++)
    at += is_first_view(points, v) ? 2 : 3;
  return at;
}

void fg_points_count_parameters(fg_points *points) {
  points->parameters = first_of_view(points, points->view_count);
}

void fg_points_parameter_name(const fg_points *points, size_t parameter, char *name) {
  for (size_t p = 0; p < points->part_count; p++) {
    size_t at = first_of_part(points, p), count = 1 + 3 * points->parts[p].bump_count;
    if (parameter < at || parameter >= at + count) continue;
    static const char *const names[3] = {"centre_to_centre_mm", "direction_rad", "radius_mm"};
    size_t k = parameter - at;
    if (k == 0)
      snprintf(name, 48, "foil %zu overall.radius_mm", p + 1);
    else
      snprintf(name, 48, "foil %zu bump %d %s", p + 1, points->parts[p].bumps[(k - 1) / 3].number,
               names[(k - 1) % 3]);
    return;
  }
  snprintf(name, 48, "pose %zu", parameter);
}

void fg_points_places(const fg_points_row *row, fg_point middle, fg_point at[FG_POINTS_PLACES]) {
  fg_point n = row->normal;
  for (int i = 0; i < FG_POINTS_PLACES; i++) {
    double across = i < 2 ? row->half_width_mm : -row->half_width_mm;
    double along = i % 2 ? row->spread_mm : -row->spread_mm;
    at[i] =
        (fg_point){middle.x + across * n.x - along * n.y, middle.y + across * n.y + along * n.x};
  }
}

/* Position of a row with the corrections in force. */
static fg_point corrected(const fg_points_row *row, const fg_points_correction *c) {
  fg_point p = row->at;
  if (c && c->fields && c->fields->count) {
    fg_point at[FG_POINTS_PLACES];
    fg_points_places(row, row->at, at);
    for (int i = 0; i < FG_POINTS_PLACES; i++) {
      fg_point d = fg_field_at(c->fields, at[i]);
      p.x += d.x / FG_POINTS_PLACES;
      p.y += d.y / FG_POINTS_PLACES;
    }
  }
  return p;
}

/* The circle of a row in its scan. */
static fg_circle circle_of(const fg_points *points, const fg_points_row *row) {
  const fg_points_part *part = &points->parts[row->part];
  const fg_points_pose *pose = &points->poses[row->view];
  if (!row->bump) return (fg_circle){pose->origin_mm.x, pose->origin_mm.y, part->overall_radius_mm};
  const fg_points_bump *bump = &part->bumps[row->bump_index];
  double angle = bump->direction_rad + pose->turn_rad;
  return (fg_circle){pose->origin_mm.x + bump->distance_mm * cos(angle),
                     pose->origin_mm.y + bump->distance_mm * sin(angle), bump->radius_mm};
}

size_t fg_points_row_parameters(const fg_points *points, size_t i,
                                size_t parameter[FG_POINTS_ROW_PARAMETERS]) {
  const fg_points_row *row = &points->rows[i];
  size_t n = 0, at = first_of_part(points, row->part), view = first_of_view(points, row->view);
  if (!row->bump) parameter[n++] = at;
  for (size_t k = 0; row->bump && k < 3; k++)
    parameter[n++] = at + 1 + 3 * row->bump_index + k;
  parameter[n++] = view;
  parameter[n++] = view + 1;
  if (row->bump && !is_first_view(points, row->view)) parameter[n++] = view + 2;
  return n;
}

/* Derivatives of |p - C| - R: -n by the centre, -1 by the radius. */
static void fill_jacobian(const fg_points *points, size_t i, double *jacobian) {
  const fg_points_row *row = &points->rows[i];
  size_t rows = points->row_count, at = first_of_part(points, row->part);
  size_t view = first_of_view(points, row->view);
  fg_point n = row->normal;
  jacobian[view * rows + i] = -n.x;
  jacobian[(view + 1) * rows + i] = -n.y;
  if (!row->bump) {
    jacobian[at * rows + i] = points->parts[row->part].radius_known ? 0 : -1;
    return;
  }
  const fg_points_bump *bump = &points->parts[row->part].bumps[row->bump_index];
  double angle = bump->direction_rad + points->poses[row->view].turn_rad;
  double along = -(n.x * cos(angle) + n.y * sin(angle));
  double across = -bump->distance_mm * (n.y * cos(angle) - n.x * sin(angle));
  size_t b = at + 1 + 3 * row->bump_index;
  jacobian[b * rows + i] = along;
  jacobian[(b + 1) * rows + i] = across;
  jacobian[(b + 2) * rows + i] = -1;
  if (!is_first_view(points, row->view)) jacobian[(view + 2) * rows + i] = across;
}

static void place_row(fg_points *points, fg_points_row *row, fg_point p) {
  const fg_points_part *part = &points->parts[row->part];
  const fg_points_pose *pose = &points->poses[row->view];
  double dx = p.x - pose->origin_mm.x, dy = p.y - pose->origin_mm.y, d = hypot(dx, dy);
  row->radial = (fg_point){dx / d, dy / d};
  double angle = atan2(dy, dx) - pose->turn_rad - part->middle_rad;
  row->psi = part->sense * (angle - 2 * M_PI * round(angle / (2 * M_PI)));
  if (!row->bump) return;
  /* The crown faces O; seen from C the numbers run against the angle. */
  const fg_points_bump *bump = &part->bumps[row->bump_index];
  double turn = row->normal_rad - (bump->direction_rad + pose->turn_rad + M_PI);
  turn -= 2 * M_PI * round(turn / (2 * M_PI));
  row->phi = -part->sense * turn / part->half_arc_rad;
}

void fg_points_residual(fg_points *points, const fg_points_correction *correction, double *residual,
                        double *jacobian) {
  if (jacobian) memset(jacobian, 0, points->parameters * points->row_count * sizeof *jacobian);
  for (size_t i = 0; i < points->row_count; i++) {
    fg_points_row *row = &points->rows[i];
    fg_circle circle = circle_of(points, row);
    fg_point p = corrected(row, correction);
    double dx = p.x - circle.x, dy = p.y - circle.y, d = hypot(dx, dy);
    row->normal = (fg_point){dx / d, dy / d};
    row->normal_rad = atan2(dy, dx);
    residual[i] = d - circle.radius;
    row->ideal = (fg_point){circle.x + circle.radius * row->normal.x,
                            circle.y + circle.radius * row->normal.y};
    if (correction && correction->shift_mm) residual[i] -= correction->shift_mm[i];
    place_row(points, row, p);
    if (jacobian) fill_jacobian(points, i, jacobian);
  }
}

static void move_geometry(fg_points *points, const gsl_vector *step) {
  for (size_t p = 0; p < points->part_count; p++) {
    size_t at = first_of_part(points, p);
    fg_points_part *part = &points->parts[p];
    part->overall_radius_mm -= gsl_vector_get(step, at);
    for (size_t b = 0; b < part->bump_count; b++) {
      part->bumps[b].distance_mm -= gsl_vector_get(step, at + 1 + 3 * b);
      part->bumps[b].direction_rad -= gsl_vector_get(step, at + 2 + 3 * b);
      part->bumps[b].radius_mm -= gsl_vector_get(step, at + 3 + 3 * b);
    }
  }
  for (size_t v = 0; v < points->view_count; v++) {
    size_t at = first_of_view(points, v);
    points->poses[v].origin_mm.x -= gsl_vector_get(step, at);
    points->poses[v].origin_mm.y -= gsl_vector_get(step, at + 1);
    if (!is_first_view(points, v)) points->poses[v].turn_rad -= gsl_vector_get(step, at + 2);
  }
}

/* Normal equations, with a trace of damping for what no row tells (a bump without points). */
static fg_status solve_step(fg_context *ctx, const fg_points *points, const double *residual,
                            const double *jacobian, gsl_matrix *normal, gsl_vector *step) {
  size_t n = points->parameters, rows = points->row_count;
  gsl_matrix_set_zero(normal);
  gsl_vector_set_zero(step);
  for (size_t i = 0; i < rows; i++) {
    size_t own[FG_POINTS_ROW_PARAMETERS], count = fg_points_row_parameters(points, i, own);
    for (size_t a = 0; a < count; a++) {
      double weighted = points->rows[i].weight * jacobian[own[a] * rows + i];
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

static double weighted_square(const fg_points *points, const double *residual) {
  double sum = 0;
  for (size_t i = 0; i < points->row_count; i++)
    sum += points->rows[i].weight * residual[i] * residual[i];
  return sum;
}

fg_status fg_points_fit(fg_context *ctx, fg_points *points,
                        const fg_points_correction *correction) {
  fg_status status = FG_OK;
  double *residual = NULL, *jacobian = NULL, *start = NULL, square = INFINITY;
  gsl_matrix *normal = NULL;
  gsl_vector *step = NULL;
  fg_numerics_start();
  size_t n = points->parameters, rows = points->row_count;
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, sizeof *residual, (void **)&residual));
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows * n, sizeof *jacobian, (void **)&jacobian));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, fg_points_geometry_size(points), sizeof *start, (void **)&start));
  fg_points_geometry_save(points, start);
  normal = gsl_matrix_alloc(n, n);
  step = gsl_vector_alloc(n);
  if (!normal || !step) {
    status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu parameters", n);
    goto exit;
  }
  for (int round = 0; round < FIT_ROUNDS; round++) {
    fg_points_residual(points, correction, residual, jacobian);
    if (round == 0) square = weighted_square(points, residual);
    FG_TRY_EXIT(solve_step(ctx, points, residual, jacobian, normal, step));
    move_geometry(points, step);
    if (gsl_vector_max(step) < STEP_END && gsl_vector_min(step) > -STEP_END) break;
  }
  fg_points_residual(points, correction, residual, NULL);
  if (!(weighted_square(points, residual) <=
        square * (1 + ROUNDING))) { /* rows too few to lead anywhere */
    fg_points_geometry_load(points, start);
    fg_points_residual(points, correction, residual, NULL);
  }
exit:
  free(start);
  free(residual);
  free(jacobian);
  gsl_matrix_free(normal);
  gsl_vector_free(step);
  return status;
}

size_t fg_points_geometry_size(const fg_points *points) {
  size_t size = 3 * points->view_count;
  for (size_t p = 0; p < points->part_count; p++)
    size += 1 + 3 * points->parts[p].bump_count;
  return size;
}

/* Visits every number of the geometry in one order. */
static void visit(fg_points *points, double *numbers, bool load) {
  size_t n = 0;
#define VISIT(value) (load ? (void)((value) = numbers[n]) : (void)(numbers[n] = (value)), n++)
  for (size_t p = 0; p < points->part_count; p++) {
    fg_points_part *part = &points->parts[p];
    VISIT(part->overall_radius_mm);
    for (size_t b = 0; b < part->bump_count; b++) {
      VISIT(part->bumps[b].distance_mm);
      VISIT(part->bumps[b].direction_rad);
      VISIT(part->bumps[b].radius_mm);
    }
  }
  for (size_t v = 0; v < points->view_count; v++) {
    VISIT(points->poses[v].origin_mm.x);
    VISIT(points->poses[v].origin_mm.y);
    VISIT(points->poses[v].turn_rad);
  }
#undef VISIT
}

void fg_points_geometry_save(const fg_points *points, double *numbers) {
  fg_points shallow = *points; /* only read */
  visit(&shallow, numbers, false);
}

void fg_points_geometry_load(fg_points *points, double *numbers) {
  visit(points, numbers, true);
}

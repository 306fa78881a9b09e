/* The engine's problem of points: groups' own geometry projected out. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "loop/points_effects.h"

/* Edges are correlated over 5 to 15 px; a row is the mean over 8 px. What reaches further is an
 * effect, not noise. */
#define RHO_MOST 0.6

static const char *const coordinate_names[FG_POINTS_COORDINATES] = {"scan.x", "scan.y", "foil.s",
                                                                    "bump.phi", "edge.normal"};

static double coordinate_of(const fg_points_row *row, size_t coordinate) {
  switch (coordinate) {
  case FG_POINTS_SCAN_X:
    return row->at.x;
  case FG_POINTS_SCAN_Y:
    return row->at.y;
  case FG_POINTS_FOIL_S:
    return row->s_mm;
  case FG_POINTS_BUMP_PHI:
    return row->phi;
  default:
    return row->normal_rad * 180 / M_PI;
  }
}

static fg_status fill_coordinates(fg_context *ctx, const fg_points *points,
                                  fg_loop_problem *problem) {
  FG_TRY(fg_memory_allocate(ctx, FG_POINTS_COORDINATES, sizeof *problem->coordinate,
                            (void **)&problem->coordinate));
  problem->coordinates = FG_POINTS_COORDINATES;
  for (size_t c = 0; c < FG_POINTS_COORDINATES; c++) {
    fg_loop_coordinate *to = &problem->coordinate[c];
    snprintf(to->name, sizeof to->name, "%s", coordinate_names[c]);
    FG_TRY(fg_memory_allocate(ctx, problem->rows, sizeof *to->value, (void **)&to->value));
    to->low = INFINITY;
    to->high = -INFINITY;
    to->distinct = problem->rows;
    for (size_t i = 0; i < problem->rows; i++) {
      to->value[i] = coordinate_of(&points->rows[i], c);
      to->low = fmin(to->low, to->value[i]);
      to->high = fmax(to->high, to->value[i]);
    }
  }
  return FG_OK;
}

/* Rows of every group. */
static fg_status list_groups(fg_context *ctx, const fg_points *points, fg_points_problem *p) {
  size_t groups = points->group_count, rows = points->row_count;
  FG_TRY(fg_memory_allocate(ctx, groups + 1, sizeof *p->group_first, (void **)&p->group_first));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *p->group_row, (void **)&p->group_row));
  size_t at = 0;
  for (size_t g = 0; g < groups; g++) {
    p->group_first[g] = at;
    for (size_t i = 0; i < rows; i++)
      if (points->rows[i].group == g) p->group_row[at++] = i;
  }
  p->group_first[groups] = at;
  return FG_OK;
}

/* Orthonormal columns of a group's own bump: X, beta and R of the part's Jacobian. */
static void span_group(const fg_points *points, const double *jacobian, size_t g,
                       fg_points_problem *p) {
  size_t first = p->group_first[g], last = p->group_first[g + 1], rows = points->row_count;
  const fg_points_row *sample = &points->rows[p->group_row[first]];
  p->own_count[g] = 0;
  p->scale[g] = 1;
  if (!sample->bump) return;
  size_t at = 0;
  for (size_t q = 0; q < sample->part; q++)
    at += 1 + 3 * points->parts[q].bump_count;
  at += 1 + 3 * sample->bump_index;
  for (size_t c = 0; c < 3; c++) {
    double square = 0, whole = 0;
    size_t k = p->own_count[g];
    for (size_t i = first; i < last; i++) {
      size_t row = p->group_row[i];
      p->own[3 * row + k] = jacobian[(at + c) * rows + row];
      whole += p->own[3 * row + k] * p->own[3 * row + k];
    }
    for (int twice = 0; twice < 2; twice++)
      for (size_t b = 0; b < k; b++) {
        double dot = 0;
        for (size_t i = first; i < last; i++)
          dot += p->own[3 * p->group_row[i] + b] * p->own[3 * p->group_row[i] + k];
        for (size_t i = first; i < last; i++)
          p->own[3 * p->group_row[i] + k] -= dot * p->own[3 * p->group_row[i] + b];
      }
    for (size_t i = first; i < last; i++) {
      double v = p->own[3 * p->group_row[i] + k];
      square += v * v;
    }
    if (!(square > 1e-16 * whole)) continue;
    for (size_t i = first; i < last; i++)
      p->own[3 * p->group_row[i] + k] /= sqrt(square);
    p->own_count[g]++;
  }
  double n = (double)(last - first), left = n - (double)p->own_count[g];
  p->scale[g] = left > 0 ? sqrt(n / left) : 0;
}

void fg_points_project(const fg_points_problem *p, double *v) {
  for (size_t g = 0; g < p->problem.groups; g++) {
    size_t first = p->group_first[g], last = p->group_first[g + 1];
    for (size_t c = 0; c < p->own_count[g]; c++) {
      double dot = 0;
      for (size_t k = first; k < last; k++)
        dot += p->own[3 * p->group_row[k] + c] * v[p->group_row[k]];
      for (size_t k = first; k < last; k++)
        v[p->group_row[k]] -= dot * p->own[3 * p->group_row[k] + c];
    }
    for (size_t k = first; k < last; k++)
      v[p->group_row[k]] *= p->scale[g];
  }
}

/* Whether a parameter of the geometry belongs to one bump. */
static bool is_own(const fg_points *points, size_t parameter) {
  size_t at = 0;
  for (size_t q = 0; q < points->part_count; q++) {
    size_t count = 1 + 3 * points->parts[q].bump_count;
    if (parameter >= at && parameter < at + count) return parameter > at;
    at += count;
  }
  return false;
}

/* Shared columns (R0, poses) and the extra ones, projected; names beside. */
static fg_status fill_parameters(fg_context *ctx, const fg_points *points, const double *jacobian,
                                 const double *extra, size_t extra_count, fg_points_problem *p) {
  fg_loop_problem *problem = &p->problem;
  size_t rows = problem->rows, most = points->parameters + extra_count;
  FG_TRY(
      fg_memory_allocate(ctx, most, rows * sizeof *problem->jacobian, (void **)&problem->jacobian));
  FG_TRY(fg_memory_allocate(ctx, most, sizeof *problem->parameter_name,
                            (void **)&problem->parameter_name));
  for (size_t a = 0; a < most; a++) {
    if (a < points->parameters && is_own(points, a)) continue;
    const double *from =
        a < points->parameters ? jacobian + a * rows : extra + (a - points->parameters) * rows;
    double *to = problem->jacobian + problem->parameters * rows;
    memcpy(to, from, rows * sizeof *to);
    fg_points_project(p, to);
    char *name;
    FG_TRY(fg_memory_allocate(ctx, 48, 1, (void **)&name));
    problem->parameter_name[problem->parameters++] = name;
    if (a < points->parameters)
      fg_points_parameter_name(points, a, name);
    else
      snprintf(name, 48, "accepted %zu", a - points->parameters + 1);
  }
  return FG_OK;
}

static fg_status fill_rows(fg_context *ctx, const fg_points *points, const double *residual,
                           fg_points_problem *p) {
  fg_loop_problem *problem = &p->problem;
  size_t rows = problem->rows;
  bool any_aside = false;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof(double), (void **)&problem->residual));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof(size_t), (void **)&problem->group));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof(size_t), (void **)&problem->series));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof(bool), (void **)&problem->aside));
  size_t series = 0;
  for (size_t i = 0; i < rows; i++) {
    const fg_points_row *row = &points->rows[i];
    problem->residual[i] = 1000 * residual[i];
    problem->group[i] = row->group;
    if (i > 0 && (row->view != row[-1].view || row->group != row[-1].group)) series++;
    problem->series[i] = series;
    problem->aside[i] = points->views[row->view].aside;
    any_aside |= problem->aside[i];
  }
  fg_points_project(p, problem->residual);
  if (!any_aside) {
    free(problem->aside);
    problem->aside = NULL;
  }
  return FG_OK;
}

fg_status fg_points_problem_build(fg_context *ctx, const fg_points *points, const double *residual,
                                  const double *jacobian, const double *extra, size_t extra_count,
                                  fg_points_problem *p) {
  memset(p, 0, sizeof *p);
  p->points = points;
  fg_loop_problem *problem = &p->problem;
  problem->level = "points";
  problem->rows = points->row_count;
  problem->groups = points->group_count;
  problem->correlated = true;
  problem->rho_most = RHO_MOST;
  problem->self = p;
  fg_status status = FG_OK;
  size_t rows = points->row_count, groups = points->group_count;
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, 3 * sizeof *p->own, (void **)&p->own));
  FG_TRY_EXIT(fg_memory_allocate(ctx, groups, sizeof *p->own_count, (void **)&p->own_count));
  FG_TRY_EXIT(fg_memory_allocate(ctx, groups, sizeof *p->scale, (void **)&p->scale));
  FG_TRY_EXIT(list_groups(ctx, points, p));
  for (size_t g = 0; g < groups; g++)
    span_group(points, jacobian, g, p);
  FG_TRY_EXIT(fill_rows(ctx, points, residual, p));
  FG_TRY_EXIT(fill_coordinates(ctx, points, problem));
  FG_TRY_EXIT(fill_parameters(ctx, points, jacobian, extra, extra_count, p));
exit:
  if (status != FG_OK) fg_points_problem_free(p);
  return status;
}

void fg_points_problem_free(fg_points_problem *p) {
  if (!p) return;
  fg_loop_problem *problem = &p->problem;
  for (size_t c = 0; problem->coordinate && c < problem->coordinates; c++)
    free(problem->coordinate[c].value);
  for (size_t a = 0; a < problem->parameters; a++)
    free(problem->parameter_name[a]);
  free(problem->parameter_name);
  free(problem->coordinate);
  free(problem->residual);
  free(problem->jacobian);
  free(problem->group);
  free(problem->series);
  free(problem->aside);
  free(p->own);
  free(p->own_count);
  free(p->scale);
  free(p->group_first);
  free(p->group_row);
  memset(p, 0, sizeof *p);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Film, foil and rotor as differential-algebraic equations F(tau, y, y') = 0, integrated by IDA
 * (SUNDIALS: backward differences of orders 1 to 5) with KLU.
 *
 *   y = (pressures and deflections, X, Y, U, V)
 *   R(P, w, X, Y) + T (P, w)' + D (X, Y)' + gamma / nu S w' = 0
 *   X' = U, Y' = V,  M U' = W_x - f_x,  M V' = W_y - f_y
 *
 * The bumps' loss factor is hysteretic, which has no equation in time: viscous bumps lose as much
 * at the ratio of whirl nu. IDA's matrix leaves out how T and D change with y: its Newton's method
 * takes a step more, the solution stays the same. */
#include "film/orbit.h"

#include <ida/ida.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <string.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

static const double pi = 3.14159265358979323846;
static const double tolerance_relative = 1e-7, tolerance_absolute = 1e-9;
enum { STEPS_MAX = 20000 }; /* between two points */

typedef struct orbit_problem {
  fg_context *ctx;
  fg_film *film;
  const fg_film_case *at;
  const fg_film_orbit_plan *plan;
  fg_film_state now;
  size_t unknowns;
} orbit_problem;

typedef struct orbit_solver {
  SUNContext context;
  N_Vector y, slope;
  SUNMatrix matrix;
  SUNLinearSolver linear;
  void *ida;
} orbit_solver;

static size_t deflection_of(const fg_film *film, size_t column) {
  return (size_t)film->base[column] + (film->edge[column] ? 0 : film->mesh.axial);
}

static void unpack_state(const fg_film *film, const double *y, fg_film_state *state) {
  for (size_t i = 0; i < film->columns; i++) {
    state->deflection[i] = y[deflection_of(film, i)];
    for (size_t j = 0; j < film->mesh.axial && !film->edge[i]; j++)
      state->pressure[i * film->nodes + j] = y[film->base[i] + (int)j];
  }
  memcpy(state->place, y + film->sparse.size, sizeof state->place);
}

static void pack_state(const fg_film *film, const fg_film_state *state, double *y) {
  for (size_t i = 0; i < film->columns; i++) {
    y[deflection_of(film, i)] = state->deflection[i];
    for (size_t j = 0; j < film->mesh.axial && !film->edge[i]; j++)
      y[film->base[i] + (int)j] = state->pressure[i * film->nodes + j];
  }
  memcpy(y + film->sparse.size, state->place, sizeof state->place);
  y[film->sparse.size + 2] = y[film->sparse.size + 3] = 0;
}

static double find_thinnest(const orbit_problem *p) {
  double thinnest = INFINITY;
  for (size_t i = 0; i < p->film->columns; i++)
    thinnest = fmin(thinnest, fg_film_thickness(p->film, p->at, &p->now, i));
  return thinnest;
}

/* Viscous bumps. */
static double viscous(const orbit_problem *p) {
  return p->at->loss / p->plan->loss_ratio;
}

static double load_at(const orbit_problem *p, double tau, int k) {
  double share = tau < 2 * pi ? p->plan->pulse * (1 - cos(tau)) / 2 : 0;
  return p->at->load[k] * (1 + share);
}

static int find_orbit_residual(realtype tau, N_Vector y, N_Vector slope, N_Vector residual,
                               void *user) {
  orbit_problem *p = user;
  const fg_film *film = p->film;
  const double *at = N_VGetArrayPointer(y), *by = N_VGetArrayPointer(slope);
  double *out = N_VGetArrayPointer(residual), force[2];
  size_t n = p->unknowns;
  unpack_state(film, at, &p->now);
  if (!(find_thinnest(p) > 0)) return 1;
  fg_film_assemble(p->ctx, p->film, p->at, &p->now);
  for (size_t r = 0; r < n; r++)
    out[r] =
        film->residual[r] + film->shift_time[0][r] * by[n] + film->shift_time[1][r] * by[n + 1];
  for (size_t c = 0; c < n; c++)
    for (int k = film->sparse.column[c]; k < film->sparse.column[c + 1]; k++)
      out[film->sparse.row[k]] += (film->time[k] + viscous(p) * film->lossy[k]) * by[c];
  fg_film_force(film, &p->now, force);
  for (size_t k = 0; k < 2; k++) {
    out[n + k] = by[n + k] - at[n + 2 + k];
    out[n + 2 + k] = p->plan->mass * by[n + 2 + k] - load_at(p, tau, (int)k) + force[k];
  }
  return 0;
}

/* Columns of the matrix: those of the film with two rows of forces, the place, the speed. */
static void put_film_columns(const orbit_problem *p, double by_slope, SUNMatrix matrix) {
  const fg_film *film = p->film;
  sunindextype *start = SM_INDEXPTRS_S(matrix), *row = SM_INDEXVALS_S(matrix), next = 0;
  double *value = SM_DATA_S(matrix);
  for (size_t c = 0; c < p->unknowns; c++) {
    start[c] = next;
    for (int k = film->sparse.column[c]; k < film->sparse.column[c + 1]; k++) {
      row[next] = film->sparse.row[k];
      value[next++] = film->matrix[k] + by_slope * (film->time[k] + viscous(p) * film->lossy[k]);
    }
    for (size_t k = 0; k < 2; k++) {
      row[next] = (sunindextype)(p->unknowns + 2 + k);
      value[next++] = 0;
    }
  }
  start[p->unknowns] = next;
}

static void put_forces(const orbit_problem *p, SUNMatrix matrix) {
  const fg_film *film = p->film;
  const sunindextype *start = SM_INDEXPTRS_S(matrix);
  double *value = SM_DATA_S(matrix);
  for (size_t i = 0; i < film->columns; i++)
    for (size_t j = 0; j < film->mesh.axial && !film->edge[i]; j++) {
      sunindextype end = start[film->base[i] + (int)j + 1];
      value[end - 2] = 2 * film->step * film->weight[j] * film->cosine[i];
      value[end - 1] = 2 * film->step * film->weight[j] * film->sine[i];
    }
}

static void put_rotor_columns(const orbit_problem *p, double by_slope, SUNMatrix matrix) {
  size_t n = p->unknowns;
  sunindextype *start = SM_INDEXPTRS_S(matrix), *row = SM_INDEXVALS_S(matrix), next = start[n];
  double *value = SM_DATA_S(matrix);
  for (size_t k = 0; k < 2; k++) {
    start[n + k] = next;
    for (size_t r = 0; r < n; r++) {
      row[next] = (sunindextype)r;
      value[next++] = p->film->shift[k][r] + by_slope * p->film->shift_time[k][r];
    }
    row[next] = (sunindextype)(n + k);
    value[next++] = by_slope;
  }
  for (size_t k = 0; k < 2; k++) {
    start[n + 2 + k] = next;
    row[next] = (sunindextype)(n + k);
    value[next++] = -1;
    row[next] = (sunindextype)(n + 2 + k);
    value[next++] = p->plan->mass * by_slope;
  }
  start[n + 4] = next;
}

static int find_orbit_matrix(realtype tau, realtype by_slope, N_Vector y, N_Vector slope,
                             N_Vector residual, SUNMatrix matrix, void *user, N_Vector a,
                             N_Vector b, N_Vector c) {
  orbit_problem *p = user;
  (void)tau, (void)slope, (void)residual, (void)a, (void)b, (void)c;
  unpack_state(p->film, N_VGetArrayPointer(y), &p->now);
  fg_film_assemble(p->ctx, p->film, p->at, &p->now);
  put_film_columns(p, by_slope, matrix);
  put_forces(p, matrix);
  put_rotor_columns(p, by_slope, matrix);
  return 0;
}

static fg_status fail_of_memory(fg_context *ctx) {
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the orbit's equations");
}

static fg_status open_solver(fg_context *ctx, orbit_problem *p, orbit_solver *s) {
  size_t size = p->unknowns + 4, entries = p->film->sparse.entries + 4 * p->unknowns + 6;
  sunindextype n = (sunindextype)size;
  if (SUNContext_Create(NULL, &s->context)) return fail_of_memory(ctx);
  s->y = N_VNew_Serial(n, s->context);
  s->slope = N_VNew_Serial(n, s->context);
  s->matrix = SUNSparseMatrix(n, n, (sunindextype)entries, CSC_MAT, s->context);
  s->ida = IDACreate(s->context);
  if (!s->y || !s->slope || !s->matrix || !s->ida) return fail_of_memory(ctx);
  s->linear = SUNLinSol_KLU(s->y, s->matrix, s->context);
  if (!s->linear) return fail_of_memory(ctx);
  N_VConst(0, s->slope);
  bool made = IDASetErrFile(s->ida, NULL) == 0 &&
              IDAInit(s->ida, find_orbit_residual, 0, s->y, s->slope) == 0 &&
              IDASStolerances(s->ida, tolerance_relative, tolerance_absolute) == 0 &&
              IDASetUserData(s->ida, p) == 0 && IDASetMaxNumSteps(s->ida, STEPS_MAX) == 0 &&
              IDASetLinearSolver(s->ida, s->linear, s->matrix) == 0 &&
              IDASetJacFn(s->ida, find_orbit_matrix) == 0;
  return made ? FG_OK : fail_of_memory(ctx);
}

static void close_solver(orbit_solver *s) {
  if (s->ida) IDAFree(&s->ida);
  if (s->linear) SUNLinSolFree(s->linear);
  if (s->matrix) SUNMatDestroy(s->matrix);
  if (s->y) N_VDestroy(s->y);
  if (s->slope) N_VDestroy(s->slope);
  if (s->context) SUNContext_Free(&s->context);
}

static void keep_point(orbit_problem *p, const double *y, double tau, fg_film_orbit_point *point) {
  unpack_state(p->film, y, &p->now);
  *point = (fg_film_orbit_point){.turn = tau / (2 * pi),
                                 .place = {p->now.place[0], p->now.place[1]},
                                 .thinnest = find_thinnest(p)};
}

static void follow_orbit(orbit_problem *p, orbit_solver *s, fg_film_orbit_point *points,
                         size_t *count) {
  const fg_film_orbit_plan *plan = p->plan;
  keep_point(p, N_VGetArrayPointer(s->y), 0, &points[0]);
  for (*count = 1; *count <= plan->turns * plan->points_per_turn; ++*count) {
    double target = 2 * pi * (double)*count / (double)plan->points_per_turn, reached;
    if (IDASolve(s->ida, target, &reached, s->y, s->slope, IDA_NORMAL) < 0) return;
    keep_point(p, N_VGetArrayPointer(s->y), reached, &points[*count]);
  }
}

fg_status fg_film_integrate_orbit(fg_context *ctx, fg_film *film, const fg_film_case *at,
                                  const fg_film_state *steady, const fg_film_orbit_plan *plan,
                                  fg_film_orbit_point *points, size_t *count) {
  orbit_problem p = {ctx, film, at, plan, {0}, (size_t)film->sparse.size};
  orbit_solver s = {.ida = NULL};
  *count = 0;
  FG_TRY(fg_film_state_open(ctx, film, &p.now));
  fg_film_state_copy(film, steady, &p.now);
  fg_film_assemble(ctx, film, at, &p.now);
  fg_status status = open_solver(ctx, &p, &s);
  if (status == FG_OK) {
    pack_state(film, steady, N_VGetArrayPointer(s.y));
    if (IDAReInit(s.ida, 0, s.y, s.slope) == 0) follow_orbit(&p, &s, points, count);
  }
  close_solver(&s);
  fg_film_state_close(&p.now);
  return status;
}

/* Distance from the steady place, which the first point has. */
static double find_distance(const fg_film_orbit_point *points, size_t i) {
  return hypot(points[i].place[0] - points[0].place[0], points[i].place[1] - points[0].place[1]);
}

/* Angle that the rotor advances about its steady place between two points. */
static double find_advance(const fg_film_orbit_point *points, size_t i) {
  double a[2], b[2];
  for (int k = 0; k < 2; k++) {
    a[k] = points[i - 1].place[k] - points[0].place[k];
    b[k] = points[i].place[k] - points[0].place[k];
  }
  return atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
}

/* Regression of the logarithm of the distance's maxima over their turns. */
fg_film_orbit_growth fg_film_measure_orbit(const fg_film_orbit_point *points, size_t count) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, advanced = 0;
  size_t from = count / 4 > 1 ? count / 4 : 1;
  for (size_t i = from; i + 1 < count; i++) {
    double here = find_distance(points, i), turn = points[i].turn;
    advanced += find_advance(points, i);
    if (!(here > find_distance(points, i - 1) && here >= find_distance(points, i + 1))) continue;
    n++, x += turn, y += log(here), xx += turn * turn, xy += turn * log(here);
  }
  if (n < 2) return (fg_film_orbit_growth){NAN, NAN};
  double turns = points[count - 2].turn - points[from - 1].turn;
  return (fg_film_orbit_growth){(n * xy - x * y) / (n * xx - x * x), advanced / (2 * pi * turns)};
}

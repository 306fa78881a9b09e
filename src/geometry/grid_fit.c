/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lattice of a grid's marks by least squares, and what follows from it. */
#include <math.h>
#include <stdlib.h>

#include "core/select.h"
#include "foilgauge/grid.h"

enum { ROUNDS = 6, AXES = 2 };
/* A mark farther from the lattice than this many robust standard deviations is an outlier, and at
 * least as many of its own. */
#define OUTLIER_SD         5.0
#define OUTLIER_U          10.0
#define DIFFERENCE         1e-7
#define MARKS_FOR_OUTLIERS 12

static const char *const words[FG_MARK_KINDS] = {"dots", "chessboard", "crosses", "lines"};

const char *fg_mark_kind_word(fg_mark_kind kind) {
  return words[kind];
}

void fg_grid_free(fg_grid *grid) {
  if (!grid) return;
  free(grid->marks);
  free(grid->picture);
  *grid = (fg_grid){0};
}

/* Sums of the normal equations: of 1, column, row, with the places. */
typedef struct lattice_sums {
  double n, c, r, cc, cr, rr;
  double p[AXES], cp[AXES], rp[AXES];
} lattice_sums;

/* Solution: origin, step along columns, along rows; inverse of the steps' normal matrix. */
typedef struct lattice_fit {
  double origin[AXES], column[AXES], row[AXES];
  double inverse[2][2];
} lattice_fit;

static lattice_sums add_marks(const fg_grid *grid) {
  lattice_sums s = {0};
  for (size_t i = 0; i < grid->count; i++) {
    const fg_mark *m = &grid->marks[i];
    if (!m->used) continue;
    const double at[AXES] = {m->at_mm.x, m->at_mm.y};
    double c = m->column, r = m->row;
    s.n++;
    s.c += c;
    s.r += r;
    s.cc += c * c;
    s.cr += c * r;
    s.rr += r * r;
    for (int k = 0; k < AXES; k++) {
      s.p[k] += at[k];
      s.cp[k] += c * at[k];
      s.rp[k] += r * at[k];
    }
  }
  return s;
}

static bool solve_sums(const lattice_sums *s, bool one_axis, lattice_fit *fit) {
  double cc = s->cc - s->c * s->c / s->n, rr = s->rr - s->r * s->r / s->n;
  double cr = s->cr - s->c * s->r / s->n;
  if (one_axis) rr = 1, cr = 0;
  double det = cc * rr - cr * cr;
  if (!(s->n >= 3 && det > 1e-6)) return false;
  fit->inverse[0][0] = rr / det;
  fit->inverse[1][1] = cc / det;
  fit->inverse[0][1] = fit->inverse[1][0] = -cr / det;
  for (int k = 0; k < AXES; k++) {
    double cp = s->cp[k] - s->c * s->p[k] / s->n;
    double rp = one_axis ? 0 : s->rp[k] - s->r * s->p[k] / s->n;
    fit->column[k] = (rr * cp - cr * rp) / det;
    fit->row[k] = (cc * rp - cr * cp) / det;
    fit->origin[k] = (s->p[k] - fit->column[k] * s->c - fit->row[k] * s->r) / s->n;
  }
  return true;
}

/* Residuals; of lines across the line, along the lattice's axis. */
static void find_residuals(fg_grid *grid, const lattice_fit *fit) {
  double length = hypot(fit->column[0], fit->column[1]);
  double nx = fit->column[0] / length, ny = fit->column[1] / length;
  for (size_t i = 0; i < grid->count; i++) {
    fg_mark *m = &grid->marks[i];
    double dx = m->at_mm.x - fit->origin[0] - m->column * fit->column[0] - m->row * fit->row[0];
    double dy = m->at_mm.y - fit->origin[1] - m->column * fit->column[1] - m->row * fit->row[1];
    if (grid->kind == FG_MARKS_LINES) {
      double across = dx * nx + dy * ny;
      dx = across * nx;
      dy = across * ny;
    }
    m->residual_mm = (fg_point){dx, dy};
  }
}

static int compare_lengths(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median_of_marks(double *values, size_t count) {
  if (!count) return NAN;
  fg_sort_items(values, count, sizeof *values, compare_lengths);
  return values[count / 2];
}

/* Returns whether the choice of used marks has changed. Without memory all stay. */
static bool drop_outliers_of_lattice(fg_grid *grid) {
  bool changed = false;
  double *lengths = malloc(grid->count * sizeof *lengths);
  if (!lengths || grid->count < MARKS_FOR_OUTLIERS) {
    free(lengths);
    return false;
  }
  for (size_t i = 0; i < grid->count; i++)
    lengths[i] = hypot(grid->marks[i].residual_mm.x, grid->marks[i].residual_mm.y);
  /* The median of a two-dimensional normal's length is 1.177 of its sd. */
  double limit = OUTLIER_SD * median_of_marks(lengths, grid->count) / 1.1774;
  free(lengths);
  for (size_t i = 0; i < grid->count; i++) {
    fg_mark *m = &grid->marks[i];
    double length = hypot(m->residual_mm.x, m->residual_mm.y);
    bool used = length <= fmax(limit, OUTLIER_U * m->u_mm);
    changed |= used != m->used;
    m->used = used;
  }
  return changed;
}

/* Numbers that follow from the steps a (columns) and b (rows): of M = [a b], M Mᵀ = step² S Sᵀ,
 * whatever the rotation. */
enum { STEP_X, STEP_Y, RATIO, SHEAR, TOLD };

static void tell_steps(const double steps[4], double told[TOLD]) {
  double ax = steps[0], ay = steps[1], bx = steps[2], by = steps[3];
  double yy = ay * ay + by * by, xy = ax * ay + bx * by, xx = ax * ax + bx * bx;
  told[STEP_Y] = sqrt(yy);
  told[STEP_X] = sqrt(xx - xy * xy / yy);
  told[RATIO] = told[STEP_X] / told[STEP_Y];
  told[SHEAR] = xy / yy;
}

static void tell_lattice(fg_grid *grid, const lattice_fit *fit, double sd, const double dpi[2]) {
  const double steps[4] = {fit->column[0], fit->column[1], fit->row[0], fit->row[1]};
  double told[TOLD], by[4][TOLD];
  tell_steps(steps, told);
  for (int k = 0; k < 4; k++) {
    double moved[4] = {steps[0], steps[1], steps[2], steps[3]}, step = DIFFERENCE * told[STEP_X];
    moved[k] += step;
    tell_steps(moved, by[k]);
    for (int i = 0; i < TOLD; i++)
      by[k][i] = (by[k][i] - told[i]) / step;
  }
  fg_grid_value *values[TOLD] = {&grid->step_mm[0], &grid->step_mm[1], &grid->axis_ratio,
                                 &grid->shear};
  for (int i = 0; i < TOLD; i++) {
    double variance = 0;
    for (int k = 0; k < AXES; k++) /* x and y have independent errors of one size */
      for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
          variance += by[2 * a + k][i] * fit->inverse[a][b] * by[2 * b + k][i];
    *values[i] = (fg_grid_value){told[i], sd * sqrt(variance)};
  }
  for (int k = 0; k < AXES; k++)
    grid->step_px[k] =
        (fg_grid_value){grid->step_mm[k].value * dpi[k] / 25.4, grid->step_mm[k].u * dpi[k] / 25.4};
}

/* A ruler's step along its own direction. */
static void tell_line(fg_grid *grid, const lattice_fit *fit, double sd, const double dpi[2]) {
  const fg_grid_value none = {NAN, NAN};
  int axis = fabs(fit->column[1]) > fabs(fit->column[0]);
  double length = hypot(fit->column[0], fit->column[1]);
  grid->step_mm[0] = grid->step_mm[1] = grid->step_px[0] = grid->step_px[1] = none;
  grid->axis_ratio = grid->shear = none;
  grid->step_mm[axis] = (fg_grid_value){length, sd * sqrt(fit->inverse[0][0])};
  double px = hypot(fit->column[0] * dpi[0], fit->column[1] * dpi[1]) / 25.4 / length;
  grid->step_px[axis] = (fg_grid_value){length * px, grid->step_mm[axis].u * px};
}

static void sum_up_marks(fg_grid *grid) {
  double square = 0, u = 0, *blurs = malloc((grid->count + 1) * sizeof *blurs);
  size_t blur_count = 0;
  grid->used = 0;
  grid->largest_um = 0;
  grid->columns = grid->rows = 0;
  for (size_t i = 0; i < grid->count; i++) {
    const fg_mark *m = &grid->marks[i];
    if (m->column >= grid->columns) grid->columns = m->column + 1;
    if (m->row >= grid->rows) grid->rows = m->row + 1;
    if (blurs && isfinite(m->blur_um)) blurs[blur_count++] = m->blur_um;
    if (!m->used) continue;
    double length = hypot(m->residual_mm.x, m->residual_mm.y);
    grid->used++;
    square += length * length;
    u += m->u_mm * m->u_mm;
    grid->largest_um = fmax(grid->largest_um, 1000 * length);
  }
  double components = grid->kind == FG_MARKS_LINES ? 1 : 2;
  grid->rms_um = 1000 * sqrt(square / components / (double)grid->used);
  grid->mark_u_um = 1000 * sqrt(u / (double)grid->used);
  grid->blur_um = median_of_marks(blurs, blur_count);
  grid->missing = (size_t)grid->columns * (size_t)grid->rows - grid->count;
  free(blurs);
}

/* sd of one component: of the residuals, and no less than the marks' own u. */
static double find_sd(const fg_grid *grid) {
  bool line = grid->kind == FG_MARKS_LINES;
  double used = (double)grid->used, numbers = line ? used : 2 * used, parameters = line ? 2 : 6;
  double dof = numbers - parameters;
  if (!(dof > 0)) return grid->mark_u_um / 1000;
  return fmax(grid->rms_um * sqrt(numbers / dof), grid->mark_u_um) / 1000;
}

bool fg_grid_fit(fg_grid *grid, const double dpi[2]) {
  lattice_fit fit;
  bool line = grid->kind == FG_MARKS_LINES;
  for (size_t i = 0; i < grid->count; i++)
    grid->marks[i].used = true;
  for (int round = 0; round < ROUNDS; round++) {
    lattice_sums sums = add_marks(grid);
    if (!solve_sums(&sums, line, &fit)) return false;
    find_residuals(grid, &fit);
    if (!drop_outliers_of_lattice(grid)) break;
  }
  sum_up_marks(grid);
  double sd = find_sd(grid);
  if (line)
    tell_line(grid, &fit, sd, dpi);
  else
    tell_lattice(grid, &fit, sd, dpi);
  grid->origin_mm = (fg_point){fit.origin[0], fit.origin[1]};
  for (int k = 0; k < AXES; k++) {
    grid->axis_mm[0][k] = fit.column[k];
    grid->axis_mm[1][k] = fit.row[k];
  }
  if (line) {
    grid->axis_mm[1][0] = -fit.column[1];
    grid->axis_mm[1][1] = fit.column[0];
  }
  grid->rotation_deg = atan2(fit.column[1], fit.column[0]) * 180 / M_PI;
  return true;
}

/* ---- uncertainty by what moves all marks ---- */

fg_grid_moves fg_grid_find_moves(const fg_grid *grid, const fg_grid *other) {
  fg_grid_moves moves = {.axis_ratio = other->axis_ratio.value - grid->axis_ratio.value,
                         .shear = other->shear.value - grid->shear.value};
  double square = 0, count = 0;
  for (int axis = 0; axis < AXES; axis++)
    moves.step_mm[axis] = other->step_mm[axis].value - grid->step_mm[axis].value;
  for (size_t i = 0; i < grid->count && i < other->count; i++) {
    const fg_mark *a = &grid->marks[i], *b = &other->marks[i];
    if (!a->used || !b->used) continue;
    double x = b->residual_mm.x - a->residual_mm.x, y = b->residual_mm.y - a->residual_mm.y;
    square += x * x + y * y;
    count += grid->kind == FG_MARKS_LINES ? 1 : 2;
  }
  moves.residual_mm2 = count > 0 ? square / count : 0;
  return moves;
}

static void widen_lattice_value(fg_grid_value *value, double move) {
  value->u = hypot(value->u, move);
}

void fg_grid_widen(fg_grid *grid, const fg_grid_moves *moves, double share) {
  for (int axis = 0; axis < AXES; axis++) {
    double move = share * moves->step_mm[axis];
    fg_grid_value *mm = &grid->step_mm[axis], *px = &grid->step_px[axis];
    widen_lattice_value(px, move * px->value / mm->value);
    widen_lattice_value(mm, move);
  }
  widen_lattice_value(&grid->axis_ratio, share * moves->axis_ratio);
  widen_lattice_value(&grid->shear, share * moves->shear);
  grid->u_model_um = hypot(grid->u_model_um, 1000 * share * sqrt(moves->residual_mm2));
}

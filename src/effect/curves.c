/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Free curves for the part that no listed effect explains: one row each. */
#include <limits.h>
#include <math.h>

#include "effect/effect.h"
#include "effect/midline.h"

/* Weight of a curve's coefficients. It is larger for harmonics of the edge's direction, which are
 * less distinct from the geometry (tuned on reports/loop_scans.md, tier curves). */
#define FREE_HOLD   1e-3
#define NORMAL_HOLD 4e-2
/* Minimum number of clean discs for a curve over the picture: with fewer it follows the form error
 * of each disc. For a curve over the direction of the edge, which all discs share, fewer suffice.
 */
enum { CURVE_DISCS = 8, NORMAL_DISCS = 3 };

#define A_CURVE                                                                                    \
  .sought = FG_EFFECT_CURVE, .numbers = FG_EFFECT_SHAPE, .equation = "a smooth curve, freely fitted"
/* A curve over one axis of the glass. */
#define OVER_GLASS(name, said, over, to, function)                                                 \
  {                                                                                                \
    .id = name, .words = said, A_CURVE, .coordinate = over, .moves = to,                           \
    .on_discs = FG_EFFECT_ON_CLEAN_DISCS, .discs_min = CURVE_DISCS, .columns = FG_FIELD_COLUMNS,   \
    .glass = function, .coarse = FG_EFFECT_SPLINES, .hold = FREE_HOLD                              \
  }

static void free_curve(const fg_field_frame *frame, int axis, double at,
                       double values[FG_FIELD_COLUMNS]) {
  fg_field_splines(frame->first_mm[axis], frame->last_mm[axis], frame->knots, at, values);
}

static void x_over_x(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  double values[FG_FIELD_COLUMNS];
  free_curve(frame, 0, at.x, values);
  for (int i = 0; i < FG_FIELD_COLUMNS; i++)
    d[i] = (fg_point){values[i], 0};
}

static void y_over_x(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  double values[FG_FIELD_COLUMNS];
  free_curve(frame, 0, at.x, values);
  for (int i = 0; i < FG_FIELD_COLUMNS; i++)
    d[i] = (fg_point){0, values[i]};
}

static void x_over_y(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  double values[FG_FIELD_COLUMNS];
  free_curve(frame, 1, at.y, values);
  for (int i = 0; i < FG_FIELD_COLUMNS; i++)
    d[i] = (fg_point){values[i], 0};
}

static void y_over_y(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  double values[FG_FIELD_COLUMNS];
  free_curve(frame, 1, at.y, values);
  for (int i = 0; i < FG_FIELD_COLUMNS; i++)
    d[i] = (fg_point){0, values[i]};
}

/* Products of Legendre polynomials of total degree 1 to 3; first all that move x. */
static void over_plane(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  enum { DEGREE = 3 };
  (void)shape;
  double u[2], p[2][DEGREE + 1];
  for (int axis = 0; axis < 2; axis++) {
    double low = frame->first_mm[axis], high = frame->last_mm[axis];
    u[axis] = (2 * (axis ? at.y : at.x) - low - high) / fmax(high - low, 1e-3);
    p[axis][0] = 1;
    p[axis][1] = u[axis];
    p[axis][2] = (3 * u[axis] * u[axis] - 1) / 2;
    p[axis][3] = u[axis] * (5 * u[axis] * u[axis] - 3) / 2;
  }
  size_t count = 0;
  for (int moved = 0; moved < 2; moved++)
    for (int i = 0; i <= DEGREE; i++)
      for (int k = 0; i + k <= DEGREE; k++) {
        double value = p[0][i] * p[1][k];
        if (i + k) d[count++] = moved ? (fg_point){0, value} : (fg_point){value, 0};
      }
}

static size_t phi(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, const double *shape,
                  double *values) {
  (void)shape;
  size_t count = fg_midline_legendre(row, 3, 1, 16, values);
  count += fg_midline_stretch(edge_fit, row, 3, values + count);
  return count + fg_midline_stretch(edge_fit, row, 4, values + count);
}

/* ---- over the number of the bump ---- */

enum { HALF = FG_FIELD_COLUMNS / 2 };

/* Finds the numbers of the first and the last bump of any part, whose bumps are in order. */
static void find_numbers(const fg_edge_fit *edge_fit, int *first, int *last) {
  *first = INT_MAX;
  *last = INT_MIN;
  for (size_t p = 0; p < edge_fit->part_count; p++) {
    const fg_edge_fit_part *part = &edge_fit->parts[p];
    if (!part->bump_count) continue;
    int ends[2] = {part->bumps[0].number, part->bumps[part->bump_count - 1].number};
    for (int e = 0; e < 2; e++) {
      if (ends[e] < *first) *first = ends[e];
      if (ends[e] > *last) *last = ends[e];
    }
  }
}

/* Returns column `column` at bump k, for more bumps than columns: patterns that repeat after some
 * bumps, and smooth ones of some half waves over all bumps, in the order of the columns. */
static double pattern(int column, int k, int count) {
  static const double periods[] = {2, 3, 4, 5, 6, 2.5, 3.5, 8, 10};
  static const int is_wave[FG_FIELD_COLUMNS] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0,
                                                0, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0};
  int waves = 0, smooth = 0;
  for (int c = 0; c < column; c++)
    *(is_wave[c] ? &waves : &smooth) += 1;
  if (!is_wave[column]) return cos(M_PI * (smooth + 1) * (k + 0.5) / count);
  double turn = 2 * M_PI * k / periods[waves / 2];
  return waves % 2 ? sin(turn) : cos(turn);
}

/* Deviations of single bumps beyond their circles. For few bumps: P4 (raised at the middle) and P3
 * (leaning) of each; for up to as many bumps as columns: P4 of each; for more: patterns of P4. The
 * set of all effects uses the first half of the columns. */
static size_t single_bumps(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                           const double *shape, double *values) {
  (void)shape;
  int first, last;
  for (int c = 0; c < FG_FIELD_COLUMNS; c++)
    values[c] = 0;
  if (!row->bump) return FG_FIELD_COLUMNS;
  find_numbers(edge_fit, &first, &last);
  double legendre[2];
  fg_midline_legendre(row, 3, 1, 2, legendre);
  int k = row->bump - first, count = last - first + 1;
  if (count <= HALF) {
    values[k] = legendre[1];
    values[HALF + k] = legendre[0];
  } else if (count <= FG_FIELD_COLUMNS) {
    values[k % 2 * HALF + k / 2] = legendre[1];
  } else {
    for (int c = 0; c < FG_FIELD_COLUMNS; c++)
      values[c] = pattern(c, k, count) * legendre[1];
  }
  return FG_FIELD_COLUMNS;
}

/* Over the foil. */
static size_t free_s(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, double share,
                     double *values) {
  fg_field_splines(edge_fit->psi_rad[0], edge_fit->psi_rad[1], edge_fit->frame.knots, row->psi,
                   values);
  for (int i = 0; i < FG_FIELD_COLUMNS; i++)
    values[i] *= share;
  return FG_FIELD_COLUMNS;
}

static size_t foil(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, const double *shape,
                   double *values) {
  (void)shape;
  return free_s(edge_fit, row, fg_midline_along_normal(row), values);
}

static size_t foil_radial(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                          const double *shape, double *values) {
  (void)shape;
  return free_s(edge_fit, row, fg_midline_along_radius(row), values);
}

/* Over the direction of the edge in the scan: error of the edge model. */
static size_t normal(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, const double *shape,
                     double *values) {
  (void)shape;
  enum {
    HARMONICS = 8,
    OF_DISCS = 6
  }; /* limit for discs, each of which has a form error of its own */
  for (int i = 0; i < HARMONICS; i++) {
    bool used = i < OF_DISCS || !edge_fit->discs;
    values[2 * i] = used ? cos((i + 2) * row->normal_rad) : 0;
    values[2 * i + 1] = used ? sin((i + 2) * row->normal_rad) : 0;
  }
  return 2 * HARMONICS;
}

const fg_effect fg_effects_curves[] = {
    OVER_GLASS("free.scan.x.dx", "a shift in x that varies over x", FG_EFFECT_X, "x", x_over_x),
    OVER_GLASS("free.scan.x.dy", "a shift in y that varies over x", FG_EFFECT_X, "y", y_over_x),
    OVER_GLASS("free.scan.y.dx", "a shift in x that varies over y", FG_EFFECT_Y, "x", x_over_y),
    OVER_GLASS("free.scan.y.dy", "a shift in y that varies over y", FG_EFFECT_Y, "y", y_over_y),
    {.id = "free.scan.xy",
     .words = "a shift that varies over the picture",
     A_CURVE,
     .coordinate = FG_EFFECT_Y,
     .moves = "x and y",
     .by_evidence = true,
     .loose = true,
     .columns = 18,
     .glass = over_plane,
     .coarse = FG_EFFECT_WHOLE,
     .hold = FREE_HOLD},
    {.id = "free.foil.s",
     .direction = "normal",
     .words = "a deviation along the foil",
     A_CURVE,
     .coordinate = FG_EFFECT_FOIL,
     .moves = "along the normal",
     .midline = foil,
     .coarse = FG_EFFECT_SPLINES,
     .hold = FREE_HOLD},
    {.id = "free.foil.s",
     .direction = "radial",
     .second = true,
     .words = "a deviation along the foil",
     A_CURVE,
     .coordinate = FG_EFFECT_FOIL,
     .moves = "along the radius",
     .midline = foil_radial,
     .coarse = FG_EFFECT_LEFT_OUT,
     .hold = FREE_HOLD},
    {.id = "free.bump.phi",
     .words = "a deviation of every bump from its circle",
     A_CURVE,
     .coordinate = FG_EFFECT_PHI,
     .moves = "along the normal",
     .midline = phi,
     .coarse = FG_EFFECT_SMOOTHER,
     .rough = {8, 16}, /* of sixteen polynomials */
     .hold = FREE_HOLD,
     .bends = true},
    {.id = "free.bump.index",
     .words = "deviations of single bumps from their circles",
     A_CURVE,
     .coordinate = FG_EFFECT_INDEX,
     .moves = "along the normal",
     .midline = single_bumps,
     .coarse = FG_EFFECT_SMOOTHER,
     .rough = {HALF, FG_FIELD_COLUMNS},
     .hold = FREE_HOLD,
     .bends = true},
    {.id = "free.edge.normal",
     .words = "a shift that depends on the edge's direction",
     A_CURVE,
     .coordinate = FG_EFFECT_NORMAL,
     .moves = "along the normal",
     .on_discs = FG_EFFECT_ON_CLEAN_DISCS,
     .discs_min = NORMAL_DISCS,
     .midline = normal,
     .coarse = FG_EFFECT_SMOOTHER,
     .rough = {12, FG_FIELD_COLUMNS},
     .hold = NORMAL_HOLD},
    {.id = NULL},
};

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect/columns.h"

#include <math.h>

#include "core/sincos.h"

enum { POWERS = 3 };

static void powers(double u, int axis, fg_point *d) {
  double power = u;
  for (int i = 0; i < POWERS; i++, power *= u)
    d[i] = axis ? (fg_point){0, power} : (fg_point){power, 0};
}

static void powers_x(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  powers((at.x - frame->centre_mm[0]) / FG_FIELD_HALF_MM, 0, d);
}

static void powers_y(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  powers((at.y - frame->centre_mm[1]) / FG_FIELD_HALF_MM, 1, d);
}

const fg_effect fg_effect_powers[2] = {
    {.id = "powers.x", .columns = POWERS, .glass = powers_x, .axis = 0},
    {.id = "powers.y", .columns = POWERS, .glass = powers_y, .axis = 1},
};

static size_t midline_columns(const fg_edge_fit *edge_fit, const fg_effect *effect,
                              const double *shape, double *columns) {
  double values[FG_FIELD_COLUMNS];
  size_t count = 0;
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    count = effect->midline(edge_fit, &edge_fit->rows[i], shape, values);
    for (size_t c = 0; c < count; c++)
      columns[c * edge_fit->row_count + i] = values[c];
  }
  return count;
}

/* Rows whose angles are taken together. */
enum { WAVE_ROWS = 64 };

/* Fills a wave's angles at the middles of rows, and those from there to a row's places, across and
 * along the strip. */
static void wave_angles(const fg_edge_fit_row *rows, size_t count, const fg_effect *effect,
                        double period_mm, double *angles) {
  const double turn = 2 * M_PI / period_mm;
  for (size_t i = 0; i < count; i++) {
    const fg_edge_fit_row *row = &rows[i];
    const fg_point tangent = {-row->normal.y, row->normal.x};
    angles[i] = turn * fg_point_along(row->ideal, effect->axis);
    angles[count + i] = turn * row->half_width_mm * fg_point_along(row->normal, effect->axis);
    angles[2 * count + i] = turn * row->spread_mm * fg_point_along(tangent, effect->axis);
  }
}

/* As for other effects, without a sine at every place: the mean of sin w(y ± a ± b) over the signs,
 * and so over a row's places, is sin(w y) cos(w a) cos(w b). */
static size_t wave_columns(const fg_edge_fit *edge_fit, const fg_effect *effect,
                           const double *shape, double *columns) {
  double angles[3 * WAVE_ROWS], sine[3 * WAVE_ROWS], cosine[3 * WAVE_ROWS];
  size_t rows = edge_fit->row_count;
  for (size_t from = 0; from < rows; from += WAVE_ROWS) {
    size_t count = rows - from < WAVE_ROWS ? rows - from : WAVE_ROWS;
    wave_angles(edge_fit->rows + from, count, effect, shape[0], angles);
    fg_sincos(3 * count, angles, sine, cosine);
    for (size_t i = 0; i < count; i++) {
      const fg_point n = edge_fit->rows[from + i].normal;
      double share = -(effect->wave.x * n.x + effect->wave.y * n.y);
      share *= cosine[count + i] * cosine[2 * count + i];
      columns[from + i] = share * sine[i];
      columns[rows + from + i] = share * cosine[i];
    }
  }
  return effect->columns;
}

static bool is_wave(const fg_effect *effect) {
  return effect->wave.x != 0 || effect->wave.y != 0;
}

/* The true position is d beyond the nominal one: along the normal the nominal lacks d. */
size_t fg_effect_columns(const fg_edge_fit *edge_fit, const fg_effect *effect, const double *shape,
                         double *columns) {
  if (effect->width) return 0;
  if (effect->midline) return midline_columns(edge_fit, effect, shape, columns);
  if (is_wave(effect)) return wave_columns(edge_fit, effect, shape, columns);
  fg_point at[FG_EDGE_FIT_PLACES], d[FG_FIELD_COLUMNS];
  size_t count = effect->columns, rows = edge_fit->row_count;
  for (size_t i = 0; i < rows; i++) {
    const fg_edge_fit_row *row = &edge_fit->rows[i];
    const fg_point share = {row->normal.x / FG_EDGE_FIT_PLACES, row->normal.y / FG_EDGE_FIT_PLACES};
    fg_edge_fit_places(row, row->ideal, at);
    for (size_t c = 0; c < count; c++)
      columns[c * rows + i] = 0;
    for (int k = 0; k < FG_EDGE_FIT_PLACES; k++) {
      effect->glass(&edge_fit->frame, shape, at[k], d);
      for (size_t c = 0; c < count; c++)
        columns[c * rows + i] -= d[c].x * share.x + d[c].y * share.y;
    }
  }
  return count;
}

size_t fg_effect_width_columns(const fg_edge_fit *edge_fit, const fg_effect *effect,
                               const double *shape, double *columns) {
  fg_point d[2][FG_FIELD_COLUMNS];
  size_t count = effect->columns, rows = edge_fit->row_count;
  for (size_t i = 0; effect->width && i < rows; i++)
    columns[i] = effect->width(edge_fit, &edge_fit->rows[i]);
  if (!effect->glass) return effect->width ? 1 : 0;
  for (size_t i = 0; i < rows; i++) {
    const fg_edge_fit_row *row = &edge_fit->rows[i];
    fg_point n = row->normal;
    for (int side = 0; side < 2; side++) {
      double w = side ? -row->half_width_mm : row->half_width_mm;
      fg_point at = {row->ideal.x + w * n.x, row->ideal.y + w * n.y};
      effect->glass(&edge_fit->frame, shape, at, d[side]);
    }
    for (size_t c = 0; c < count; c++)
      columns[c * rows + i] =
          -0.5 * ((d[0][c].x - d[1][c].x) * n.x + (d[0][c].y - d[1][c].y) * n.y);
  }
  return count;
}

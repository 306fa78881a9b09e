/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect/columns.h"

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

/* The true position is d beyond the nominal one: along the normal the nominal lacks d. */
size_t fg_effect_columns(const fg_edge_fit *edge_fit, const fg_effect *effect, const double *shape,
                         double *columns) {
  if (effect->width) return 0;
  if (effect->midline) return midline_columns(edge_fit, effect, shape, columns);
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

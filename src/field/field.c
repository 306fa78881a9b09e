/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "field/field.h"

#include <math.h>

/* Cubic B-spline of unit knots, centred at 0. */
static double bspline(double u) {
  double a = fabs(u);
  if (a >= 2) return 0;
  if (a >= 1) return (2 - a) * (2 - a) * (2 - a) / 6;
  return 2.0 / 3 - a * a + 0.5 * a * a * a;
}

void fg_field_splines(double low, double high, size_t knots, double at,
                      double values[FG_FIELD_COLUMNS]) {
  double spacing = (high - low) / (double)(knots - 1);
  double place = (fmax(low, fmin(high, at)) - low) / spacing;
  for (size_t i = 0; i < FG_FIELD_COLUMNS; i++)
    values[i] = 0;
  /* A spline is 0 from two knots on. */
  for (size_t i = place > 2 ? (size_t)(place - 1) : 0; i < knots && (double)i < place + 2; i++)
    values[i] = 1.5 * bspline(place - (double)i);
}

fg_point fg_field_at(const fg_field_list *list, fg_point nominal) {
  fg_point sum = {0, 0}, d[FG_FIELD_COLUMNS];
  for (size_t i = 0; i < list->count; i++) {
    const fg_field *field = &list->fields[i];
    field->basis(&list->frame, field->shape, nominal, d);
    for (size_t c = 0; c < field->columns; c++) {
      sum.x += field->amplitude_mm[c] * d[c].x;
      sum.y += field->amplitude_mm[c] * d[c].y;
    }
  }
  if (list->map) {
    fg_point smooth = fg_map_at(list->map, list->map_mm, nominal);
    sum = (fg_point){sum.x + smooth.x, sum.y + smooth.y};
  }
  return sum;
}

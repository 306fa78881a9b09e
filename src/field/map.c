/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "field/map.h"

#include <math.h>
#include <stdlib.h>

enum { SPAN = 4 };

/* First spline that reaches the place, and the values of the four that do. */
static size_t weigh_axis(double low, double high, size_t side, double at, double values[SPAN]) {
  double intervals = (double)(side - (SPAN - 1));
  double place = (fmax(low, fmin(high, at)) - low) / (high - low) * intervals;
  double first = fmin(floor(place), intervals - 1), t = place - first, s = 1 - t;
  values[0] = s * s * s / 6;
  values[1] = (3 * t * t * t - 6 * t * t + 4) / 6;
  values[2] = (3 * s * s * s - 6 * s * s + 4) / 6;
  values[3] = t * t * t / 6;
  return (size_t)first;
}

void fg_map_weigh(const fg_map_frame *frame, fg_point at, fg_map_weight weights[FG_MAP_WEIGHTS]) {
  double x[SPAN], y[SPAN];
  size_t i0 = weigh_axis(frame->low_mm[0], frame->high_mm[0], frame->side[0], at.x, x);
  size_t j0 = weigh_axis(frame->low_mm[1], frame->high_mm[1], frame->side[1], at.y, y);
  for (size_t j = 0; j < SPAN; j++)
    for (size_t i = 0; i < SPAN; i++)
      weights[SPAN * j + i] = (fg_map_weight){(j0 + j) * frame->side[0] + i0 + i, x[i] * y[j]};
}

fg_point fg_map_at(const fg_map_frame *frame, const double *mm, fg_point at) {
  fg_map_weight weights[FG_MAP_WEIGHTS];
  fg_point sum = {0, 0};
  size_t splines = fg_map_splines(frame);
  fg_map_weigh(frame, at, weights);
  for (size_t k = 0; k < FG_MAP_WEIGHTS; k++) {
    sum.x += weights[k].value * mm[weights[k].spline];
    sum.y += weights[k].value * mm[splines + weights[k].spline];
  }
  return sum;
}

void fg_field_map_free(fg_field_map *map) {
  if (!map) return;
  free(map->mm);
  for (size_t k = 0; k < map->mode_count; k++)
    free(map->modes[k]);
  *map = (fg_field_map){0};
}

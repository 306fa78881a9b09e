/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A free-form curve: the natural cubic spline through its knots, constant beyond them; with a
 * period the spline that closes on itself. */
#ifndef FG_RENDER_CURVE_H
#define FG_RENDER_CURVE_H

#include <stddef.h>

#include "render/members.h"

enum { FG_CURVE_KNOTS_MAX = 64 };

/* Range and unit of a curve's coordinate. */
typedef struct fg_curve_axis {
  const char *unit;
  double low, high;
  double period;         /* 0: none */
  double steepest_um_mm; /* steeper curves are refused; 0: any slope */
} fg_curve_axis;

typedef struct fg_curve {
  size_t count;
  double period;
  double at[FG_CURVE_KNOTS_MAX], value_um[FG_CURVE_KNOTS_MAX];
  double bend[FG_CURVE_KNOTS_MAX]; /* second derivative */
} fg_curve;

/* Reads [[coordinate, um], ...], 2 to 64 knots, ascending. */
fg_status fg_curve_parse(const fg_place *place, const cJSON *knots, const fg_curve_axis *axis,
                         fg_curve *curve);

double fg_curve_value_um(const fg_curve *curve, double at);
double fg_curve_slope_um(const fg_curve *curve, double at); /* per unit of the coordinate */
double fg_curve_largest_um(const fg_curve *curve);          /* magnitude */

#endif

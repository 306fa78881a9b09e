/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/circle_scaled.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"

static fg_status check_points(fg_context *ctx, const fg_point *points, const double *weights,
                              size_t count) {
  size_t used = 0;
  for (size_t i = 0; i < count; i++) {
    double weight = weights ? weights[i] : 1;
    if (!isfinite(points[i].x) || !isfinite(points[i].y))
      return fg_fail(ctx, FG_ERR_NUMERIC, "circle fit: point %zu is not finite", i);
    if (!isfinite(weight) || weight < 0)
      return fg_fail(ctx, FG_ERR_NUMERIC, "circle fit: weight %zu is negative or not finite", i);
    used += weight > 0;
  }
  if (used < 3)
    return fg_fail(ctx, FG_ERR_NUMERIC, "circle fit: %zu points; a circle needs 3", used);
  return FG_OK;
}

/* Weighted mean in two passes: the second removes the rounding of the first, which matters where
 * the points lie far from zero. */
static fg_point mean_point(const fg_circle_scaled *scaled, const fg_point *points) {
  fg_point mean = points[0];
  for (int pass = 0; pass < 2; pass++) {
    double x = 0, y = 0;
    for (size_t i = 0; i < scaled->count; i++) {
      x += scaled->weight[i] * (points[i].x - mean.x);
      y += scaled->weight[i] * (points[i].y - mean.y);
    }
    mean.x += x;
    mean.y += y;
  }
  return mean;
}

static void set_weights(fg_circle_scaled *scaled, const double *weights) {
  double sum = 0;
  for (size_t i = 0; i < scaled->count; i++)
    sum += weights ? weights[i] : 1;
  for (size_t i = 0; i < scaled->count; i++)
    scaled->weight[i] = (weights ? weights[i] : 1) / sum;
  scaled->weight_sum = sum;
}

/* Fills x and y centred, and sets scale and the long axis from their second moments. */
static void centre_and_measure(fg_circle_scaled *scaled, const fg_point *points) {
  double xx = 0, yy = 0, xy = 0;
  scaled->origin = mean_point(scaled, points);
  for (size_t i = 0; i < scaled->count; i++) {
    double x = scaled->x[i] = points[i].x - scaled->origin.x;
    double y = scaled->y[i] = points[i].y - scaled->origin.y;
    xx += scaled->weight[i] * x * x;
    yy += scaled->weight[i] * y * y;
    xy += scaled->weight[i] * x * y;
  }
  double angle_rad = 0.5 * atan2(2 * xy, xx - yy);
  scaled->axis_x = cos(angle_rad);
  scaled->axis_y = sin(angle_rad);
  scaled->scale = sqrt(xx + yy);
}

static void turn_and_scale(fg_circle_scaled *scaled) {
  double line_ms = 0;
  for (size_t i = 0; i < scaled->count; i++) {
    double x = scaled->x[i] / scaled->scale, y = scaled->y[i] / scaled->scale;
    scaled->x[i] = x * scaled->axis_x + y * scaled->axis_y;
    scaled->y[i] = y * scaled->axis_x - x * scaled->axis_y;
    line_ms += scaled->weight[i] * scaled->y[i] * scaled->y[i];
  }
  scaled->line_ms = line_ms;
}

static fg_status fill_scaled(fg_context *ctx, const fg_point *points, const double *weights,
                             fg_circle_scaled *scaled) {
  set_weights(scaled, weights);
  centre_and_measure(scaled, points);
  double far = fmax(fabs(scaled->origin.x), fabs(scaled->origin.y));
  if (!isfinite(scaled->weight_sum) || !isfinite(scaled->scale))
    return fg_fail(ctx, FG_ERR_NUMERIC, "circle fit: the coordinates or weights are too large");
  if (scaled->scale <= fmax(DBL_MIN, 8 * DBL_EPSILON * far))
    return fg_fail(ctx, FG_ERR_NUMERIC, "circle fit: all points lie in one place");
  turn_and_scale(scaled);
  double rounding = 4 * DBL_EPSILON * (1 + far / scaled->scale);
  if (!(sqrt(scaled->line_ms) > rounding))
    return fg_fail(ctx, FG_ERR_NUMERIC, "circle fit: all points lie on a line");
  return FG_OK;
}

fg_status fg_circle_scale_points(fg_context *ctx, const fg_point *points, const double *weights,
                                 size_t count, fg_circle_scaled *scaled) {
  void *block = NULL;
  *scaled = (fg_circle_scaled){.count = count};
  FG_TRY(check_points(ctx, points, weights, count));
  FG_TRY(fg_memory_allocate(ctx, count, 4 * sizeof(double), &block));
  scaled->x = block;
  scaled->y = scaled->x + count;
  scaled->weight = scaled->y + count;
  scaled->scratch = scaled->weight + count;
  fg_status status = fill_scaled(ctx, points, weights, scaled);
  if (status != FG_OK) fg_circle_scaled_free(scaled);
  return status;
}

void fg_circle_scaled_free(fg_circle_scaled *scaled) {
  free(scaled->x);
  scaled->x = scaled->y = scaled->weight = scaled->scratch = NULL;
}

fg_circle fg_circle_into_scaled(const fg_circle_scaled *scaled, const fg_circle *circle) {
  double x = (circle->x - scaled->origin.x) / scaled->scale;
  double y = (circle->y - scaled->origin.y) / scaled->scale;
  return (fg_circle){x * scaled->axis_x + y * scaled->axis_y,
                     y * scaled->axis_x - x * scaled->axis_y, circle->radius / scaled->scale};
}

fg_circle fg_circle_out_of_scaled(const fg_circle_scaled *scaled, const fg_circle *circle) {
  double x = circle->x * scaled->axis_x - circle->y * scaled->axis_y;
  double y = circle->x * scaled->axis_y + circle->y * scaled->axis_x;
  return (fg_circle){scaled->origin.x + scaled->scale * x, scaled->origin.y + scaled->scale * y,
                     scaled->scale * circle->radius};
}

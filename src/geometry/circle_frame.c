#include "geometry/circle_frame.h"

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

/* Weighted mean in two passes: the second takes out the rounding of the first, which matters where
 * the points lie far from zero. */
static fg_point mean_point(const fg_circle_frame *frame, const fg_point *points) {
  fg_point mean = points[0];
  for (int pass = 0; pass < 2; pass++) {
    double x = 0, y = 0;
    for (size_t i = 0; i < frame->count; i++) {
      x += frame->weight[i] * (points[i].x - mean.x);
      y += frame->weight[i] * (points[i].y - mean.y);
    }
    mean.x += x;
    mean.y += y;
  }
  return mean;
}

static void take_weights(fg_circle_frame *frame, const double *weights) {
  double sum = 0;
  for (size_t i = 0; i < frame->count; i++)
    sum += weights ? weights[i] : 1;
  for (size_t i = 0; i < frame->count; i++)
    frame->weight[i] = (weights ? weights[i] : 1) / sum;
  frame->weight_sum = sum;
}

/* Fills x and y centred, and sets scale and the long axis from their second moments. */
static void centre_and_measure(fg_circle_frame *frame, const fg_point *points) {
  double xx = 0, yy = 0, xy = 0;
  frame->origin = mean_point(frame, points);
  for (size_t i = 0; i < frame->count; i++) {
    double x = frame->x[i] = points[i].x - frame->origin.x;
    double y = frame->y[i] = points[i].y - frame->origin.y;
    xx += frame->weight[i] * x * x;
    yy += frame->weight[i] * y * y;
    xy += frame->weight[i] * x * y;
  }
  double angle_rad = 0.5 * atan2(2 * xy, xx - yy);
  frame->axis_x = cos(angle_rad);
  frame->axis_y = sin(angle_rad);
  frame->scale = sqrt(xx + yy);
}

static void turn_and_scale(fg_circle_frame *frame) {
  double line_ms = 0;
  for (size_t i = 0; i < frame->count; i++) {
    double x = frame->x[i] / frame->scale, y = frame->y[i] / frame->scale;
    frame->x[i] = x * frame->axis_x + y * frame->axis_y;
    frame->y[i] = y * frame->axis_x - x * frame->axis_y;
    line_ms += frame->weight[i] * frame->y[i] * frame->y[i];
  }
  frame->line_ms = line_ms;
}

static fg_status fill_frame(fg_context *ctx, const fg_point *points, const double *weights,
                            fg_circle_frame *frame) {
  take_weights(frame, weights);
  centre_and_measure(frame, points);
  double far = fmax(fabs(frame->origin.x), fabs(frame->origin.y));
  if (!isfinite(frame->weight_sum) || !isfinite(frame->scale))
    return fg_fail(ctx, FG_ERR_NUMERIC, "circle fit: the coordinates or weights are too large");
  if (frame->scale <= fmax(DBL_MIN, 8 * DBL_EPSILON * far))
    return fg_fail(ctx, FG_ERR_NUMERIC, "circle fit: all points lie in one place");
  turn_and_scale(frame);
  double rounding = 4 * DBL_EPSILON * (1 + far / frame->scale);
  if (!(sqrt(frame->line_ms) > rounding))
    return fg_fail(ctx, FG_ERR_NUMERIC, "circle fit: all points lie on a line");
  return FG_OK;
}

fg_status fg_circle_frame_make(fg_context *ctx, const fg_point *points, const double *weights,
                               size_t count, fg_circle_frame *frame) {
  void *block = NULL;
  *frame = (fg_circle_frame){.count = count};
  FG_TRY(check_points(ctx, points, weights, count));
  FG_TRY(fg_memory_allocate(ctx, count, 4 * sizeof(double), &block));
  frame->x = block;
  frame->y = frame->x + count;
  frame->weight = frame->y + count;
  frame->scratch = frame->weight + count;
  fg_status status = fill_frame(ctx, points, weights, frame);
  if (status != FG_OK) fg_circle_frame_free(frame);
  return status;
}

void fg_circle_frame_free(fg_circle_frame *frame) {
  free(frame->x);
  frame->x = frame->y = frame->weight = frame->scratch = NULL;
}

fg_circle fg_circle_into_frame(const fg_circle_frame *frame, const fg_circle *circle) {
  double x = (circle->x - frame->origin.x) / frame->scale;
  double y = (circle->y - frame->origin.y) / frame->scale;
  return (fg_circle){x * frame->axis_x + y * frame->axis_y, y * frame->axis_x - x * frame->axis_y,
                     circle->radius / frame->scale};
}

fg_circle fg_circle_out_of_frame(const fg_circle_frame *frame, const fg_circle *circle) {
  double x = circle->x * frame->axis_x - circle->y * frame->axis_y;
  double y = circle->x * frame->axis_y + circle->y * frame->axis_x;
  return (fg_circle){frame->origin.x + frame->scale * x, frame->origin.y + frame->scale * y,
                     frame->scale * circle->radius};
}

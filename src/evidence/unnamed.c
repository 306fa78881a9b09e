/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/unnamed.h"

#include <math.h>

/* Starts of the search for a shape: they are refined where an effect shows. Half a cycle over the
 * picture lies between two periods. */
enum { STARTS = 24, PERIODS = 48, BROKEN_NUMBERS = 3 };

static double start_along(const fg_field_frame *frame, int axis, size_t i, size_t count) {
  double low = frame->low_mm[axis], high = frame->high_mm[axis];
  return low + (high - low) * ((double)i + 1) / ((double)count + 1);
}

static double start_in_x(const fg_field_frame *frame, size_t i, size_t count) {
  return start_along(frame, 0, i, count);
}

static double start_in_y(const fg_field_frame *frame, size_t i, size_t count) {
  return start_along(frame, 1, i, count);
}

/* A slope, a jump, and another slope behind it. */
static void fill_broken_line(const fg_field_frame *frame, int axis, double place_mm, fg_point at,
                             double *values) {
  double along = fg_point_along(at, axis);
  values[0] = (along - frame->centre_mm[axis]) / FG_FIELD_HALF_MM;
  values[1] = along > place_mm ? 1 : 0;
  values[2] = along > place_mm ? (along - place_mm) / FG_FIELD_HALF_MM : 0;
}

#define BROKEN_LINE(name, over, moved_x, moved_y)                                                  \
  static void name(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {   \
    double values[BROKEN_NUMBERS];                                                                 \
    fill_broken_line(frame, over, shape[0], at, values);                                           \
    for (int c = 0; c < BROKEN_NUMBERS; c++)                                                       \
      d[c] = (fg_point){(moved_x)*values[c], (moved_y)*values[c]};                                 \
  }
BROKEN_LINE(x_broken_over_x, 0, 1, 0)
BROKEN_LINE(y_broken_over_x, 0, 0, 1)
BROKEN_LINE(x_broken_over_y, 1, 1, 0)
BROKEN_LINE(y_broken_over_y, 1, 0, 1)

/* ---- decays and waves, along the axes and of the things for which no effect has a name ---- */

static double span_along(const fg_field_frame *frame, int axis) {
  return frame->high_mm[axis] - frame->low_mm[axis];
}

/* Evenly in the logarithm. */
static double length_along(const fg_field_frame *frame, int axis, size_t i, size_t count) {
  double low = 0.5;
  return low * pow(span_along(frame, axis) / low, (double)i / (double)count);
}

/* Evenly in frequency, from one and a half cycles on. */
static double period_along(const fg_field_frame *frame, int axis, size_t i, size_t count) {
  (void)count;
  return span_along(frame, axis) / (1.5 + 0.5 * (double)i);
}

static double length_in_x(const fg_field_frame *frame, size_t i, size_t count) {
  return length_along(frame, 0, i, count);
}

static double length_in_y(const fg_field_frame *frame, size_t i, size_t count) {
  return length_along(frame, 1, i, count);
}

static double period_in_x(const fg_field_frame *frame, size_t i, size_t count) {
  return period_along(frame, 0, i, count);
}

static double period_in_y(const fg_field_frame *frame, size_t i, size_t count) {
  return period_along(frame, 1, i, count);
}

#define DECAY(name, over, moved_x, moved_y)                                                        \
  static void name(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {   \
    double value = exp(-(fg_point_along(at, over) - frame->low_mm[over]) / shape[0]);              \
    d[0] = (fg_point){(moved_x)*value, (moved_y)*value};                                           \
  }
DECAY(x_decays_over_x, 0, 1, 0)
DECAY(y_decays_over_x, 0, 0, 1)
DECAY(x_decays_over_y, 1, 1, 0)

#define WAVE(name, over, moved_x, moved_y)                                                         \
  static void name(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {   \
    double angle = 2 * M_PI * fg_point_along(at, over) / shape[0];                                 \
    (void)frame;                                                                                   \
    d[0] = (fg_point){(moved_x)*sin(angle), (moved_y)*sin(angle)};                                 \
    d[1] = (fg_point){(moved_x)*cos(angle), (moved_y)*cos(angle)};                                 \
  }
WAVE(x_waves_over_x, 0, 1, 0)
WAVE(y_waves_over_x, 0, 0, 1)
WAVE(x_waves_over_y, 1, 1, 0)

#define LENGTH_ROW(name, over, thing, basis, count, from, tried)                                   \
  {                                                                                                \
    .id = name, .sought = FG_EFFECT_PLACED, .coordinate = (over) ? FG_EFFECT_Y : FG_EFFECT_X,      \
    .moves = thing, .columns = count, .shapes = 1, .shape_is = {FG_EFFECT_LENGTH}, .glass = basis, \
    .axis = over, .start = from, .starts = tried, .size_from = "a pixel of 2400 dpi; assumed",     \
    .size_um = {                                                                                   \
      10                                                                                           \
    }                                                                                              \
  }

#define ROW(name, over, thing, basis, from)                                                        \
  {                                                                                                \
    .id = name, .sought = FG_EFFECT_PLACED, .coordinate = (over) ? FG_EFFECT_Y : FG_EFFECT_X,      \
    .moves = thing, .columns = BROKEN_NUMBERS, .shapes = 1, .glass = basis, .axis = over,          \
    .start = from, .starts = STARTS, .jumps = true, .size_from = "as of a lost row; assumed",      \
    .size_um = {                                                                                   \
      15                                                                                           \
    }                                                                                              \
  }

const fg_effect fg_unnamed_effects[FG_UNNAMED_EFFECTS + 1] = {
    ROW("scan.x.dx with a jump", 0, "x", x_broken_over_x, start_in_x),
    ROW("scan.x.dy with a jump", 0, "y", y_broken_over_x, start_in_x),
    ROW("scan.y.dx with a jump", 1, "x", x_broken_over_y, start_in_y),
    ROW("scan.y.dy with a jump", 1, "y", y_broken_over_y, start_in_y),
    LENGTH_ROW("scan.x.dx as a decay", 0, "x", x_decays_over_x, 1, length_in_x, STARTS),
    LENGTH_ROW("scan.x.dy as a decay", 0, "y", y_decays_over_x, 1, length_in_x, STARTS),
    LENGTH_ROW("scan.y.dx as a decay", 1, "x", x_decays_over_y, 1, length_in_y, STARTS),
    LENGTH_ROW("scan.x.dx as a wave", 0, "x", x_waves_over_x, 2, period_in_x, PERIODS),
    LENGTH_ROW("scan.x.dy as a wave", 0, "y", y_waves_over_x, 2, period_in_x, PERIODS),
    LENGTH_ROW("scan.y.dx as a wave", 1, "x", x_waves_over_y, 2, period_in_y, PERIODS),
    {.id = NULL},
};

bool fg_unnamed_shows(const fg_effect *effect, const fg_edge_fit *edge_fit) {
  return !edge_fit->discs || effect->columns != BROKEN_NUMBERS;
}

bool fg_effect_is_unnamed(const fg_effect *effect) {
  for (const fg_effect *one = fg_unnamed_effects; one->id; one++)
    if (one == effect) return true;
  return false;
}

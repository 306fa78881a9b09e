/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects of the scanner, one row each: the functions before the rows are their bases on the glass.
 */
#include <math.h>

#include "effect/effect.h"

/* Starts of the search for a shape: a ripple's periods lie closer than a step's places. */
enum { PERIOD_STARTS = 400, PLACE_STARTS = 200, LENGTH_STARTS = 60 };

static double from_middle(const fg_field_frame *frame, int axis, double at) {
  return (at - frame->centre_mm[axis]) / FG_FIELD_HALF_MM;
}

static void scale_y(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  d[0] = (fg_point){0, from_middle(frame, 1, at.y)};
}

static void shear(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  d[0] = (fg_point){from_middle(frame, 1, at.y), 0};
}

/* Both axes: only known lengths distinguish it from larger parts. */
static void scale(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)shape;
  d[0] = (fg_point){from_middle(frame, 0, at.x), from_middle(frame, 1, at.y)};
}

/* a sin(2 pi y / p + phi) as a sine and a cosine. */
static void ripple(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)frame;
  double angle = 2 * M_PI * at.y / shape[0];
  d[0] = (fg_point){0, sin(angle)};
  d[1] = (fg_point){0, cos(angle)};
}

static void row_step(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)frame;
  d[0] = (fg_point){0, at.y > shape[0] ? 1 : 0};
}

static void column_step(const fg_field_frame *frame, const double *shape, fg_point at,
                        fg_point *d) {
  (void)frame;
  d[0] = (fg_point){at.x > shape[0] ? 1 : 0, 0};
}

static void optical_quadratic(const fg_field_frame *frame, const double *shape, fg_point at,
                              fg_point *d) {
  (void)frame;
  double u = (at.x - shape[0]) / FG_FIELD_HALF_MM;
  d[0] = (fg_point){u * u, 0};
}

static void optical_cubic(const fg_field_frame *frame, const double *shape, fg_point at,
                          fg_point *d) {
  (void)frame;
  double u = (at.x - shape[0]) / FG_FIELD_HALF_MM;
  d[0] = (fg_point){u * u * u, 0};
}

static void carriage_quadratic(const fg_field_frame *frame, const double *shape, fg_point at,
                               fg_point *d) {
  (void)frame;
  double v = (at.y - shape[0]) / FG_FIELD_HALF_MM;
  d[0] = (fg_point){0, v * v};
}

/* The carriage accelerates from the picture's first row on. */
static void carriage_start(const fg_field_frame *frame, const double *shape, fg_point at,
                           fg_point *d) {
  d[0] = (fg_point){0, exp(-(at.y - frame->low_mm[1]) / shape[0])};
}

/* Evenly in the logarithm. */
static double length_start(const fg_field_frame *frame, size_t i, size_t count) {
  double low = 0.5, high = frame->high_mm[1] - frame->low_mm[1];
  return low * pow(high / low, (double)i / (double)count);
}

/* Evenly in frequency. */
static double period_start(const fg_field_frame *frame, size_t i, size_t count) {
  double span = frame->high_mm[1] - frame->low_mm[1];
  double low = 1.5 / span, high = 2.5;
  return 1 / (low + (high - low) * (double)i / (double)count);
}

static double place_start(const fg_field_frame *frame, int axis, size_t i, size_t count) {
  double low = frame->low_mm[axis], high = frame->high_mm[axis];
  return low + (high - low) * ((double)i + 1) / ((double)count + 1);
}

static double row_start(const fg_field_frame *frame, size_t i, size_t count) {
  return place_start(frame, 1, i, count);
}

static double column_start(const fg_field_frame *frame, size_t i, size_t count) {
  return place_start(frame, 0, i, count);
}

const fg_effect fg_effects_scanner[] = {
    {.id = "scan.scale_y",
     .words = "a wrong scale along the carriage's way",
     .equation = "d_y = q y",
     .numbers = FG_EFFECT_RATIO,
     .on_discs = FG_EFFECT_ON_DISCS,
     .columns = 1,
     .glass = scale_y,
     .of_carriage = true,
     .axis = 1,
     .polynomial = FG_EFFECT_LINEAR,
     .ring = FG_EFFECT_RING_OF_SCANNER},
    {.id = "scan.scale",
     .words = "a wrong scale of the whole picture",
     .equation = "d = q (x, y)",
     .numbers = FG_EFFECT_RATIO,
     .off_foils = true,
     .on_discs = FG_EFFECT_ON_KNOWN_DISCS,
     .columns = 1,
     .glass = scale,
     .scales = true},
    {.id = "scan.shear",
     .words = "a shear of the picture",
     .equation = "d_x = q y",
     .numbers = FG_EFFECT_RATIO,
     .on_discs = FG_EFFECT_ON_DISCS,
     .columns = 1,
     .glass = shear,
     .ring = FG_EFFECT_RING_OF_SCANNER},
    {.id = "scan.optical_quadratic",
     .words = "a quadratic distortion of the optics",
     .equation = "d_x = a ((x − c)/18 mm)²",
     .on_discs = FG_EFFECT_ON_DISCS,
     .columns = 1,
     .shapes = 1,
     .shape_name = {"centre_mm"},
     .shape_symbol = {"c"},
     .glass = optical_quadratic,
     .polynomial = FG_EFFECT_QUADRATIC},
    {.id = "scan.optical_cubic",
     .words = "a cubic distortion of the optics",
     .equation = "d_x = a ((x − c)/18 mm)³",
     .on_discs = FG_EFFECT_ON_DISCS,
     .columns = 1,
     .shapes = 1,
     .shape_name = {"centre_mm"},
     .shape_symbol = {"c"},
     .glass = optical_cubic,
     .polynomial = FG_EFFECT_CUBIC},
    {.id = "scan.carriage_quadratic",
     .words = "a carriage that becomes faster or slower",
     .equation = "d_y = a ((y − c)/18 mm)²",
     .on_discs = FG_EFFECT_ON_DISCS,
     .columns = 1,
     .shapes = 1,
     .shape_name = {"centre_mm"},
     .shape_symbol = {"c"},
     .glass = carriage_quadratic,
     .of_carriage = true,
     .axis = 1,
     .polynomial = FG_EFFECT_QUADRATIC},
    {.id = "scan.carriage_ripple",
     .words = "a ripple of the carriage",
     .equation = "d_y = a sin(2π y/p + φ)",
     .sought = FG_EFFECT_PLACED,
     .numbers = FG_EFFECT_WAVE,
     .on_discs = FG_EFFECT_ON_DISCS,
     .columns = 2,
     .shapes = 1,
     .shape_name = {"period_mm"},
     .shape_symbol = {"p"},
     .spans = true,
     .glass = ripple,
     .of_carriage = true,
     .axis = 1,
     .start = period_start,
     .starts = PERIOD_STARTS},
    {.id = "scan.row_step",
     .words = "a step of the carriage (rows lost or doubled)",
     .equation = "d_y = a where y > y0",
     .sought = FG_EFFECT_PLACED,
     .on_discs = FG_EFFECT_ON_DISCS,
     .columns = 1,
     .shapes = 1,
     .shape_name = {"y_mm"},
     .shape_symbol = {"y0"},
     .glass = row_step,
     .of_carriage = true,
     .axis = 1,
     .start = row_start,
     .starts = PLACE_STARTS,
     .jumps = true},
    {.id = "scan.column_step",
     .words = "a seam between two chips of the scanner's sensor",
     .equation = "d_x = a where x > x0",
     .sought = FG_EFFECT_PLACED,
     .on_discs = FG_EFFECT_ON_DISCS,
     .columns = 1,
     .shapes = 1,
     .shape_name = {"x_mm"},
     .shape_symbol = {"x0"},
     .glass = column_step,
     .start = column_start,
     .starts = PLACE_STARTS,
     .jumps = true},
    {.id = "scan.carriage_start",
     .words = "a carriage that takes up speed",
     .equation = "d_y = a exp(−y/l)",

     .on_discs = FG_EFFECT_ON_DISCS,
     .columns = 1,
     .shapes = 1,
     .shape_name = {"length_mm"},
     .shape_symbol = {"l"},
     .spans = true,
     .glass = carriage_start,
     .of_carriage = true,
     .axis = 1,
     .start = length_start,
     .starts = LENGTH_STARTS},
    {.id = NULL},
};

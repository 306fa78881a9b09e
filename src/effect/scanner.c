/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects of the scanner, one row each: the functions before the rows are their bases on the glass.
 */
#include <math.h>

#include "effect/effect.h"

/* Starts of the search for a shape: a ripple's periods lie closer than a step's places. Those of an
 * effect that evidence alone asks for are refined where it shows. */
enum { PERIOD_STARTS = 400, PLACE_STARTS = 200, LENGTH_STARTS = 60, YAW_STARTS = 64, MIDDLES = 9 };
/* Of two shapes: periods times growths, pitches times places of a seam. */
enum { GROWTHS = 2, GROWTH_PERIODS = 72, PITCHES = 16, SEAMS = 10 };

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

static void optical_quintic(const fg_field_frame *frame, const double *shape, fg_point at,
                            fg_point *d) {
  (void)frame;
  double u = (at.x - shape[0]) / FG_FIELD_HALF_MM;
  d[0] = (fg_point){u * u * u * u * u, 0};
}

/* q (x - x_c)(y - y_c): its middle lies anywhere on the glass, so it brings a shear and a scale. */
static void keystone(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  double u = from_middle(frame, 0, at.x), v = from_middle(frame, 1, at.y);
  (void)shape;
  d[0] = (fg_point){u * v, 0};
  d[1] = (fg_point){v, 0};
  d[2] = (fg_point){u, 0};
}

static void yaw(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)frame;
  double angle = 2 * M_PI * at.y / shape[0];
  d[0] = (fg_point){sin(angle), 0};
  d[1] = (fg_point){cos(angle), 0};
}

/* Growth over half the picture below which it is a ripple. */
#define GROWTH_MIN 0.3

/* A ripple of this amplitude in the middle of the picture. */
static void ripple_growth(const fg_field_frame *frame, const double *shape, fg_point at,
                          fg_point *d) {
  double angle = 2 * M_PI * at.y / shape[0], share = 1 + shape[1] * (at.y - frame->centre_mm[1]);
  if (fabs(shape[1]) * (frame->high_mm[1] - frame->low_mm[1]) < 2 * GROWTH_MIN) share = 0;
  d[0] = (fg_point){0, share * sin(angle)};
  d[1] = (fg_point){0, share * cos(angle)};
}

/* A sawtooth: every chip of the sensor is tilted alike. */
static void chip_tilt(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  (void)frame;
  double chips = (at.x - shape[0]) / shape[1];
  d[0] = (fg_point){0, chips - floor(chips) - 0.5};
}

static double chips_before(const double *shape, double x) {
  return floor((x - shape[0]) / shape[1]);
}

/* A staircase: behind every seam the picture is shifted by as much again. Two among the
 * edges are steps of columns: only three have a pitch. */
static void chip_gap(const fg_field_frame *frame, const double *shape, fg_point at, fg_point *d) {
  double seams = chips_before(shape, frame->last_mm[0]) - chips_before(shape, frame->first_mm[0]);
  d[0] = (fg_point){seams > 2 ? chips_before(shape, at.x) : 0, 0};
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

/* From seven tenths of a cycle on: less is a shear. */
static double yaw_start(const fg_field_frame *frame, size_t i, size_t count) {
  double span = frame->high_mm[1] - frame->low_mm[1], low = 0.7 / span, high = 1.0;
  return 1 / (low + (high - low) * (double)i / (double)count);
}

/* Of a lens, as far out as the picture's ends. */
static double middle_start(const fg_field_frame *frame, size_t i, size_t count) {
  double low = frame->low_mm[0], high = frame->high_mm[0];
  return low + (high - low) * (double)i / ((double)count - 1);
}

/* Ripples that vanish at either end of the picture, of periods evenly in frequency. */
static void growth_grid(const fg_edge_fit *edge_fit, size_t i, size_t count, double *shape,
                        double *reach) {
  const fg_field_frame *frame = &edge_fit->frame;
  double span = frame->high_mm[1] - frame->low_mm[1], low = 1.5 / span, high = 1.2;
  double step = (high - low) / ((double)count / GROWTHS);
  double frequency = low + step * (double)(i / GROWTHS);
  shape[0] = 1 / frequency;
  shape[1] = (i % GROWTHS ? -2 : 2) / span;
  reach[0] = step / (frequency * frequency) * 0.75;
  reach[1] = 1.5 / span;
}

/* Pitches evenly in the logarithm, up to one of which the rows may show two seams. */
static void chip_grid(const fg_edge_fit *edge_fit, size_t i, size_t count, double *shape,
                      double *reach) {
  const fg_field_frame *frame = &edge_fit->frame;
  double span = frame->last_mm[0] - frame->first_mm[0], low = 0.1 * span, high = 0.8 * span;
  double pitches = (double)count / SEAMS, factor = pow(high / low, 1 / (pitches - 1));
  shape[1] = low * pow(factor, (double)(i / SEAMS));
  shape[0] = 0.5 * (frame->first_mm[0] + frame->last_mm[0]) +
             shape[1] * ((double)(i % SEAMS) / SEAMS - 0.5);
  reach[0] = shape[1] / SEAMS;
  reach[1] = shape[1] * (factor - 1);
}

/* Sizes of scanner's effects, um at 18 mm from the middle: */
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
     .ring = FG_EFFECT_RING_OF_SCANNER,
     .size_um = {54},
     .size_from = "0.3 %: half of the largest difference of x and y measured on flatbeds"},
    {.id = "scan.scale",
     .words = "a wrong scale of the whole picture",
     .equation = "d = q (x, y)",
     .numbers = FG_EFFECT_RATIO,
     .off_foils = true,
     .on_discs = FG_EFFECT_ON_KNOWN_DISCS,
     .columns = 1,
     .glass = scale,
     .scales = true,
     .size_um = {54},
     .size_from = "0.3 %: half of the largest difference of x and y measured on flatbeds"},
    {.id = "scan.shear",
     .words = "a shear of the picture",
     .equation = "d_x = q y",
     .numbers = FG_EFFECT_RATIO,
     .on_discs = FG_EFFECT_ON_DISCS,
     .columns = 1,
     .glass = shear,
     .ring = FG_EFFECT_RING_OF_SCANNER,
     .size_um = {36},
     .size_from = "0.2 %: two thirds of a scale's; assumed"},
    {.id = "scan.optical_quadratic",
     .words = "a quadratic distortion of the optics",
     .equation = "d_x = a ((x − c)/18 mm)²",
     .on_discs = FG_EFFECT_ON_DISCS,
     .columns = 1,
     .shapes = 1,
     .shape_name = {"centre_mm"},
     .shape_symbol = {"c"},
     .glass = optical_quadratic,
     .polynomial = FG_EFFECT_QUADRATIC,
     .rival = "scan.xy of one map",
     .stretch = 4, /* x² moves x */
     .size_um = {13, 20},
     .size_from = "about a pixel of 2400 dpi over a foil; assumed"},
    {.id = "scan.optical_cubic",
     .words = "a cubic distortion of the optics",
     .equation = "d_x = a ((x − c)/18 mm)³",
     .on_discs = FG_EFFECT_ON_DISCS,
     .columns = 1,
     .shapes = 1,
     .shape_name = {"centre_mm"},
     .shape_symbol = {"c"},
     .glass = optical_cubic,
     .polynomial = FG_EFFECT_CUBIC,
     .rival = "scan.xy of one map",
     .stretch = 12, /* x³ moves x */
     .size_um = {7, 20},
     .size_from = "half a pixel of 2400 dpi over a foil; assumed"},
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
     .polynomial = FG_EFFECT_QUADRATIC,
     .rival = "scan.xy of one map",
     .stretch = 1, /* y² moves y */
     .size_um = {13, 20},
     .size_from = "about a pixel of 2400 dpi over a foil; assumed"},
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
     .shape_is = {FG_EFFECT_LENGTH},
     .glass = ripple,
     .wave = {0, 1},
     .of_carriage = true,
     .axis = 1,
     .start = period_start,
     .starts = PERIOD_STARTS,
     .size_um = {10},
     .size_from = "a pixel of 2400 dpi; assumed"},
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
     .jumps = true,
     .size_um = {15},
     .size_from = "a row lost or doubled: 10.6 um at 2400 dpi, 21.2 at 1200 (reports/real: three)"},
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
     .jumps = true,
     .size_um = {15},
     .size_from = "as of a lost row; assumed"},
    {.id = "scan.carriage_start",
     .words = "a carriage that takes up speed",
     .equation = "d_y = a exp(−y/l)",
     .on_discs = FG_EFFECT_ON_DISCS,
     .columns = 1,
     .shapes = 1,
     .shape_name = {"length_mm"},
     .shape_symbol = {"l"},
     .shape_is = {FG_EFFECT_LENGTH},
     .glass = carriage_start,
     .of_carriage = true,
     .axis = 1,
     .start = length_start,
     .starts = LENGTH_STARTS,
     .size_um = {20},
     .size_from = "two pixels of 2400 dpi; assumed"},
    {.id = "scan.optical_quintic",
     .words = "a distortion of the optics of fifth order",
     .equation = "d_x = a ((x − c)/18 mm)⁵",
     .by_evidence = true,
     .columns = 1,
     .shapes = 1,
     .shape_name = {"centre_mm"},
     .shape_symbol = {"c"},
     .glass = optical_quintic,
     .start = middle_start,
     .starts = MIDDLES,
     .size_um = {20},
     .size_from = "two pixels of 2400 dpi; assumed"},
    {.id = "scan.keystone",
     .words = "a picture that grows wider or narrower along the carriage's way",
     .equation = "d_x = a (x − x_c)(y − y_c)/(18 mm)²",
     .numbers = FG_EFFECT_LED,
     .by_evidence = true,
     .columns = 3,
     .glass = keystone,
     .extends = "scan.shear",
     .rival = "scan.xy of one map",
     .stretch = 2, /* x y moves x */
     .size_um = {20, 36, 54},
     .size_from =
         "two pixels of 2400 dpi; with a shear and a scale, which its middle makes; assumed"},
    {.id = "scan.yaw",
     .words = "a carriage that swings to and fro",
     .equation = "d_x = a sin(2π y/p + φ)",
     .sought = FG_EFFECT_PLACED,
     .numbers = FG_EFFECT_WAVE,
     .by_evidence = true,
     .columns = 2,
     .shapes = 1,
     .shape_name = {"period_mm"},
     .shape_symbol = {"p"},
     .shape_is = {FG_EFFECT_LENGTH},
     .glass = yaw,
     .wave = {1, 0},
     .axis = 1,
     .start = yaw_start,
     .starts = YAW_STARTS,
     .rival = "scan.y.dx as a wave",
     .size_um = {10},
     .size_from = "as of a ripple; assumed"},
    {.id = "scan.ripple_growth",
     .words = "a ripple of the carriage whose amplitude changes along its way",
     .equation = "d_y = a (1 + g (y − y_m)) sin(2π y/p + φ), y_m the picture's middle",
     .numbers = FG_EFFECT_WAVE,
     .by_evidence = true,
     .columns = 2,
     .shapes = 2,
     .shape_name = {"period_mm", "growth_per_mm"},
     .shape_symbol = {"p", "g"},
     .shape_is = {FG_EFFECT_LENGTH, FG_EFFECT_GROWTH},
     .glass = ripple_growth,
     .extends = "scan.carriage_ripple",
     .of_carriage = true,
     .axis = 1,
     .grid = growth_grid,
     .starts = GROWTHS * GROWTH_PERIODS,
     .size_um = {10},
     .size_from = "as of a ripple; assumed"},
    {.id = "scan.chip_tilt",
     .words = "chips of the scanner's sensor that are tilted",
     .equation = "d_y = a ((x − x0)/p mod 1 − 1/2)",
     .by_evidence = true,
     .columns = 1,
     .shapes = 2,
     .shape_name = {"x_mm", "pitch_mm"},
     .shape_symbol = {"x0", "p"},
     .shape_is = {FG_EFFECT_PLACE, FG_EFFECT_LENGTH},
     .glass = chip_tilt,
     .grid = chip_grid,
     .starts = PITCHES * SEAMS,
     .jumps = true,
     .size_um = {15},
     .size_from = "as of a seam; assumed"},
    {.id = "scan.chip_gap",
     .words = "gaps between the chips of the scanner's sensor",
     .equation = "d_x = a floor((x − x0)/p)",
     .by_evidence = true,
     .columns = 1,
     .shapes = 2,
     .shape_name = {"x_mm", "pitch_mm"},
     .shape_symbol = {"x0", "p"},
     .shape_is = {FG_EFFECT_PLACE, FG_EFFECT_LENGTH},
     .glass = chip_gap,
     .grid = chip_grid,
     .starts = PITCHES * SEAMS,
     .jumps = true,
     .size_um = {15},
     .size_from = "as of a seam; assumed"},
    {.id = NULL},
};

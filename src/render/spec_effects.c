/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/spec_effects.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Parameters arrive in the unit of their name: um are converted to mm here. */

static void scale_y(const double *p, double x, double y, double d[2]) {
  (void)x;
  d[1] += p[0] * y;
}

static void shear(const double *p, double x, double y, double d[2]) {
  (void)x;
  d[0] += p[0] * y;
}

static void carriage_ripple(const double *p, double x, double y, double d[2]) {
  (void)x;
  d[1] += 1e-3 * p[0] * sin(2 * pi * y / p[1] + p[2] * pi / 180);
}

static void row_step(const double *p, double x, double y, double d[2]) {
  (void)x;
  if (y > p[1]) d[1] += 1e-3 * p[0];
}

static void column_step(const double *p, double x, double y, double d[2]) {
  (void)y;
  if (x > p[1]) d[0] += 1e-3 * p[0];
}

static void optical_quadratic(const double *p, double x, double y, double d[2]) {
  (void)y;
  double u = (x - p[1]) / p[2];
  d[0] += 1e-3 * p[0] * u * u;
}

static void optical_cubic(const double *p, double x, double y, double d[2]) {
  (void)y;
  double u = (x - p[1]) / p[2];
  d[0] += 1e-3 * p[0] * u * u * u;
}

static void carriage_quadratic(const double *p, double x, double y, double d[2]) {
  (void)x;
  double u = (y - p[1]) / p[2];
  d[1] += 1e-3 * p[0] * u * u;
}

static void carriage_start(const double *p, double x, double y, double d[2]) {
  (void)x;
  d[1] += 1e-3 * p[0] * exp(-y / p[1]);
}

static void optical_quintic(const double *p, double x, double y, double d[2]) {
  (void)y;
  double u = (x - p[1]) / p[2];
  d[0] += 1e-3 * p[0] * u * u * u * u * u;
}

static void keystone(const double *p, double x, double y, double d[2]) {
  d[0] += 1e-3 * p[0] * (x - p[1]) / p[3] * (y - p[2]) / p[3];
}

static void yaw(const double *p, double x, double y, double d[2]) {
  (void)x;
  d[0] += 1e-3 * p[0] * sin(2 * pi * y / p[1] + p[2] * pi / 180);
}

static void ripple_growth(const double *p, double x, double y, double d[2]) {
  (void)x;
  d[1] += 1e-3 * p[0] * (1 + p[3] * (y - p[4])) * sin(2 * pi * y / p[1] + p[2] * pi / 180);
}

static void chip_tilt(const double *p, double x, double y, double d[2]) {
  (void)y;
  double chips = (x - p[1]) / p[2];
  d[1] += 1e-3 * p[0] * (chips - floor(chips) - 0.5);
}

static void chip_gap(const double *p, double x, double y, double d[2]) {
  (void)y;
  d[0] += 1e-3 * p[0] * floor((x - p[1]) / p[2]);
}

static double ovality(const double *p, double psi, double half_span) {
  (void)half_span;
  return 1e-3 * p[0] * cos(2 * (psi - p[1] * pi / 180));
}

static double lobes(const double *p, double psi, double half_span) {
  (void)half_span;
  return 1e-3 * p[0] * cos(p[2] * (psi - p[1] * pi / 180));
}

static double dent(const double *p, double psi, double half_span) {
  (void)half_span;
  double u = (psi * 180 / pi - p[1]) / p[2];
  return 1e-3 * p[0] * exp(-0.5 * u * u);
}

static double spiral(const double *p, double psi, double half_span) {
  double u = psi / half_span;
  return 1e-3 * p[0] * u * u * u;
}

/* Half of the taper to either edge, and half of that at either end of the foil. */
static double thickness_taper(const double *p, double psi, double half_span) {
  return 1e-3 * p[0] * 0.25 * psi / half_span;
}

/* Flat with zero slope at |u| = 1, so that arc and fillet stay joined. */
static double bump_crown(const double *p, double u, double unused) {
  (void)unused;
  double v = 1 - u * u;
  return 1e-3 * p[0] * v * v;
}

/* The crown times u, scaled so that its largest value, at u = 1/sqrt(5), is the amplitude. */
static double bump_skew(const double *p, double u, double unused) {
  (void)unused;
  double v = 1 - u * u;
  return 1e-3 * p[0] * u * v * v * sqrt(5.0) * 25 / 16;
}

static double lip_decay(const double *p, double index, double count) {
  (void)count;
  return 1 + p[0] * exp(-(index - 1) / p[1]);
}

static double stretch(const double *p, double beyond_mm, double unused) {
  (void)unused;
  return 1 + p[0] + p[1] * beyond_mm;
}

/* The inverse of a field is sought at the true position: the field must change slowly. */
static const fg_curve_axis along_mm = {"mm", -1000, 1000, 0, 100};
static const fg_curve_axis unit_axis = {"u", -1, 1, 0, 0};
static const fg_curve_axis direction = {"deg", 0, 360, 360, 0};

static const fg_render_effect_row rows[] = {
    {.id = "scan.scale_y",
     .target = FG_RENDER_EFFECT_SCANNER,
     .parameters = {{"value", NAN, -0.1, 0.1}},
     .field = scale_y},
    {.id = "scan.shear",
     .target = FG_RENDER_EFFECT_SCANNER,
     .parameters = {{"value", NAN, -0.1, 0.1}},
     .field = shear},
    {.id = "scan.carriage_ripple",
     .target = FG_RENDER_EFFECT_SCANNER,
     .parameters = {{"amplitude_um", NAN, -200, 200},
                    {"period_mm", NAN, 0.05, 1000},
                    {"phase_deg", 0, -360, 360}},
     .field = carriage_ripple},
    {.id = "scan.row_step",
     .target = FG_RENDER_EFFECT_STEP,
     .parameters = {{"amplitude_um", NAN, -500, 500}, {"y_mm", INFINITY, -1000, 1000}},
     .field = row_step,
     .axis = 1},
    {.id = "scan.column_step",
     .target = FG_RENDER_EFFECT_STEP,
     .parameters = {{"amplitude_um", NAN, -500, 500}, {"x_mm", INFINITY, -1000, 1000}},
     .field = column_step},
    {.id = "scan.optical_quadratic",
     .target = FG_RENDER_EFFECT_SCANNER,
     .parameters = {{"amplitude_um", NAN, -500, 500},
                    {"centre_mm", INFINITY, -1000, 1000},
                    {"half_width_mm", 18, 0.1, 1000}},
     .field = optical_quadratic},
    {.id = "scan.optical_cubic",
     .target = FG_RENDER_EFFECT_SCANNER,
     .parameters = {{"amplitude_um", NAN, -500, 500},
                    {"centre_mm", INFINITY, -1000, 1000},
                    {"half_width_mm", 18, 0.1, 1000}},
     .field = optical_cubic},
    {.id = "scan.carriage_quadratic",
     .target = FG_RENDER_EFFECT_SCANNER,
     .parameters = {{"amplitude_um", NAN, -500, 500},
                    {"centre_mm", INFINITY, -1000, 1000},
                    {"half_width_mm", 18, 0.1, 1000}},
     .field = carriage_quadratic,
     .axis = 1},
    {.id = "scan.carriage_start",
     .target = FG_RENDER_EFFECT_SCANNER,
     .parameters = {{"amplitude_um", NAN, -500, 500}, {"length_mm", NAN, 0.5, 1000}},
     .field = carriage_start,
     .axis = 1},
    {.id = "part.ovality",
     .target = FG_RENDER_EFFECT_PART,
     .parameters = {{"amplitude_um", NAN, -1000, 1000}, {"phase_deg", 0, -360, 360}},
     .shape = ovality},
    {.id = "part.spiral",
     .target = FG_RENDER_EFFECT_PART,
     .parameters = {{"amplitude_um", NAN, -1000, 1000}},
     .shape = spiral},
    {.id = "part.thickness_taper",
     .target = FG_RENDER_EFFECT_WIDTH,
     .parameters = {{"thickness_change_um", NAN, -100, 100}},
     .shape = thickness_taper},
    {.id = "part.bump_crown",
     .target = FG_RENDER_EFFECT_BUMP,
     .parameters = {{"amplitude_um", NAN, -50, 50}},
     .shape = bump_crown},
    {.id = "part.bump_skew",
     .target = FG_RENDER_EFFECT_BUMP,
     .parameters = {{"amplitude_um", NAN, -50, 50}},
     .shape = bump_skew},
    {.id = "part.lip_decay",
     .target = FG_RENDER_EFFECT_TABLE,
     .parameters = {{"amplitude_rel", NAN, -0.5, 0.5}, {"decay_bumps", 2, 0.1, 100}},
     .shape = lip_decay},
    {.id = "part.stretch",
     .target = FG_RENDER_EFFECT_STRETCH,
     .parameters = {{"value_rel", NAN, -0.3, 0.3}, {"slope_rel_per_mm", 0, -2, 2}},
     .shape = stretch},
    {.id = "scan.optical_quintic",
     .target = FG_RENDER_EFFECT_SCANNER,
     .parameters = {{"amplitude_um", NAN, -500, 500},
                    {"centre_mm", INFINITY, -1000, 1000},
                    {"half_width_mm", 18, 0.1, 1000}},
     .field = optical_quintic},
    {.id = "scan.keystone",
     .target = FG_RENDER_EFFECT_SCANNER,
     .parameters = {{"amplitude_um", NAN, -500, 500},
                    {"x_mm", INFINITY, -1000, 1000},
                    {"y_mm", -INFINITY, -1000, 1000},
                    {"half_width_mm", 18, 0.1, 1000}},
     .field = keystone},
    {.id = "scan.yaw",
     .target = FG_RENDER_EFFECT_SCANNER,
     .parameters = {{"amplitude_um", NAN, -200, 200},
                    {"period_mm", NAN, 0.05, 1000},
                    {"phase_deg", 0, -360, 360}},
     .field = yaw},
    {.id = "scan.ripple_growth",
     .target = FG_RENDER_EFFECT_SCANNER,
     .parameters = {{"amplitude_um", NAN, -200, 200},
                    {"period_mm", NAN, 0.05, 1000},
                    {"phase_deg", 0, -360, 360},
                    {"growth_per_mm", NAN, -1, 1},
                    {"y_mm", -INFINITY, -1000, 1000}},
     .field = ripple_growth},
    {.id = "scan.chip_tilt",
     .target = FG_RENDER_EFFECT_STEP,
     .parameters = {{"amplitude_um", NAN, -500, 500},
                    {"x_mm", INFINITY, -1000, 1000},
                    {"pitch_mm", NAN, 1, 1000}},
     .field = chip_tilt,
     .repeats = true},
    {.id = "scan.chip_gap",
     .target = FG_RENDER_EFFECT_STEP,
     .parameters = {{"amplitude_um", NAN, -500, 500},
                    {"x_mm", INFINITY, -1000, 1000},
                    {"pitch_mm", NAN, 1, 1000}},
     .field = chip_gap,
     .repeats = true},
    {.id = "part.lobes",
     .target = FG_RENDER_EFFECT_PART,
     .parameters = {{"amplitude_um", NAN, -1000, 1000},
                    {"phase_deg", 0, -360, 360},
                    {"lobes", NAN, 3, 12}},
     .shape = lobes},
    {.id = "part.dent",
     .target = FG_RENDER_EFFECT_PART,
     .parameters = {{"amplitude_um", NAN, -200, 200},
                    {"place_deg", NAN, -180, 180},
                    {"width_deg", NAN, 0.2, 90}},
     .shape = dent},
    {.id = "free.scan.x", .target = FG_RENDER_EFFECT_SCANNER, .curve = &along_mm},
    {.id = "free.scan.y", .target = FG_RENDER_EFFECT_SCANNER, .axis = 1, .curve = &along_mm},
    {.id = "free.foil.s", .target = FG_RENDER_EFFECT_PART, .curve = &unit_axis},
    {.id = "free.bump.phi", .target = FG_RENDER_EFFECT_BUMP, .curve = &unit_axis},
    {.id = "free.bump.index", .target = FG_RENDER_EFFECT_LIFT},
    {.id = "free.edge.normal", .target = FG_RENDER_EFFECT_EDGE, .curve = &direction},
    {.id = NULL},
};

const fg_render_effect_row *fg_render_effect_rows(void) {
  return rows;
}

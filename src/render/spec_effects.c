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

static double ovality(const double *p, double psi, double half_span) {
  (void)half_span;
  return 1e-3 * p[0] * cos(2 * (psi - p[1] * pi / 180));
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
    {"scan.scale_y", FG_RENDER_EFFECT_SCANNER, {{"value", NAN, -0.1, 0.1}}, scale_y, NULL, 0, NULL},
    {"scan.shear", FG_RENDER_EFFECT_SCANNER, {{"value", NAN, -0.1, 0.1}}, shear, NULL, 0, NULL},
    {"scan.carriage_ripple",
     FG_RENDER_EFFECT_SCANNER,
     {{"amplitude_um", NAN, -200, 200},
      {"period_mm", NAN, 0.05, 1000},
      {"phase_deg", 0, -360, 360}},
     carriage_ripple,
     NULL,
     0,
     NULL},
    {"scan.row_step",
     FG_RENDER_EFFECT_STEP,
     {{"amplitude_um", NAN, -500, 500}, {"y_mm", INFINITY, -1000, 1000}},
     row_step,
     NULL,
     1,
     NULL},
    {"scan.column_step",
     FG_RENDER_EFFECT_STEP,
     {{"amplitude_um", NAN, -500, 500}, {"x_mm", INFINITY, -1000, 1000}},
     column_step,
     NULL,
     0,
     NULL},
    {"scan.optical_quadratic",
     FG_RENDER_EFFECT_SCANNER,
     {{"amplitude_um", NAN, -500, 500},
      {"centre_mm", INFINITY, -1000, 1000},
      {"half_width_mm", 18, 0.1, 1000}},
     optical_quadratic,
     NULL,
     0,
     NULL},
    {"scan.optical_cubic",
     FG_RENDER_EFFECT_SCANNER,
     {{"amplitude_um", NAN, -500, 500},
      {"centre_mm", INFINITY, -1000, 1000},
      {"half_width_mm", 18, 0.1, 1000}},
     optical_cubic,
     NULL,
     0,
     NULL},
    {"scan.carriage_quadratic",
     FG_RENDER_EFFECT_SCANNER,
     {{"amplitude_um", NAN, -500, 500},
      {"centre_mm", INFINITY, -1000, 1000},
      {"half_width_mm", 18, 0.1, 1000}},
     carriage_quadratic,
     NULL,
     1,
     NULL},
    {"scan.carriage_start",
     FG_RENDER_EFFECT_SCANNER,
     {{"amplitude_um", NAN, -500, 500}, {"length_mm", NAN, 0.5, 1000}},
     carriage_start,
     NULL,
     1,
     NULL},
    {"part.ovality",
     FG_RENDER_EFFECT_PART,
     {{"amplitude_um", NAN, -1000, 1000}, {"phase_deg", 0, -360, 360}},
     NULL,
     ovality,
     0,
     NULL},
    {"part.spiral",
     FG_RENDER_EFFECT_PART,
     {{"amplitude_um", NAN, -1000, 1000}},
     NULL,
     spiral,
     0,
     NULL},
    {"part.thickness_taper",
     FG_RENDER_EFFECT_WIDTH,
     {{"thickness_change_um", NAN, -100, 100}},
     NULL,
     thickness_taper,
     0,
     NULL},
    {"part.bump_crown",
     FG_RENDER_EFFECT_BUMP,
     {{"amplitude_um", NAN, -50, 50}},
     NULL,
     bump_crown,
     0,
     NULL},
    {"part.bump_skew",
     FG_RENDER_EFFECT_BUMP,
     {{"amplitude_um", NAN, -50, 50}},
     NULL,
     bump_skew,
     0,
     NULL},
    {"part.lip_decay",
     FG_RENDER_EFFECT_TABLE,
     {{"amplitude_rel", NAN, -0.5, 0.5}, {"decay_bumps", 2, 0.1, 100}},
     NULL,
     lip_decay,
     0,
     NULL},
    {"part.stretch",
     FG_RENDER_EFFECT_STRETCH,
     {{"value_rel", NAN, -0.3, 0.3}, {"slope_rel_per_mm", 0, -2, 2}},
     NULL,
     stretch,
     0,
     NULL},
    {"free.scan.x", FG_RENDER_EFFECT_SCANNER, {{0}}, NULL, NULL, 0, &along_mm},
    {"free.scan.y", FG_RENDER_EFFECT_SCANNER, {{0}}, NULL, NULL, 1, &along_mm},
    {"free.foil.s", FG_RENDER_EFFECT_PART, {{0}}, NULL, NULL, 0, &unit_axis},
    {"free.bump.phi", FG_RENDER_EFFECT_BUMP, {{0}}, NULL, NULL, 0, &unit_axis},
    {"free.bump.index", FG_RENDER_EFFECT_LIFT, {{0}}, NULL, NULL, 0, NULL},
    {"free.edge.normal", FG_RENDER_EFFECT_EDGE, {{0}}, NULL, NULL, 0, &direction},
    {0},
};

const fg_render_effect_row *fg_render_effect_rows(void) {
  return rows;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/calibration.h"

#include <math.h>
#include <string.h>

/* Limits beyond which a value has another unit, or no foil's: no pitch is uncertain by 5 %, no
 * alloy expands by more than 1e-4 per K, and no scanner works below 0 or above 60 °C. */
static const double scale_max = 0.05;
static const double temperature_min_c = 0, temperature_max_c = 60, u_temperature_max_k = 20;
static const double expansion_max_per_k = 1e-4;

static fg_status check_u(fg_context *ctx, const char *member, double u, double max,
                         const char *hint) {
  if (u >= 0 && u <= max) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "calibration.%s: a standard uncertainty of %g; it must be from 0 to %g%s", member,
                 u, max, hint);
}

static fg_status check_temperature(fg_context *ctx, const fg_calibration *c) {
  if (!(c->temperature_c >= temperature_min_c && c->temperature_c <= temperature_max_c))
    return fg_fail(ctx, FG_ERR_DATA,
                   "calibration.temperature.value_C is %g; it must be from %g to %g °C",
                   c->temperature_c, temperature_min_c, temperature_max_c);
  FG_TRY(check_u(ctx, "temperature", c->u_temperature_k, u_temperature_max_k, " K"));
  if (!(fabs(c->expansion_per_k) <= expansion_max_per_k))
    return fg_fail(
        ctx, FG_ERR_DATA,
        "calibration.expansion.value_per_K is %g; it must be from %g to %g per kelvin, as "
        "1.2e-5",
        c->expansion_per_k, -expansion_max_per_k, expansion_max_per_k);
  return check_u(ctx, "expansion", c->u_expansion_per_k, expansion_max_per_k, " per kelvin");
}

/* Standard uncertainty of an unknown flatbed's pitch along either axis. */
#define FLATBED_U_SCALE 0.003

fg_calibration fg_calibration_of_flatbed(void) {
  return (fg_calibration){.stated = true,
                          .certificate = "the default for an unknown flatbed",
                          .per_axis = true,
                          .u_scale = {FLATBED_U_SCALE, FLATBED_U_SCALE}};
}

fg_status fg_calibration_check(fg_context *ctx, const fg_calibration *c) {
  static const char *const axes[] = {"scale.x", "scale.y"};
  if (!c->stated) return FG_OK;
  if (!c->scale_by_model && c->u_scale[0] == 0 && c->u_scale[1] == 0)
    return fg_fail(
        ctx, FG_ERR_DATA,
        "calibration.scale: an uncertainty of 0; no scale is known exactly: state it, as "
        "1e-4 for 0.01 %%, or leave the calibration out");
  for (int axis = 0; axis < 2; axis++)
    FG_TRY(check_u(ctx, c->per_axis ? axes[axis] : "scale", c->u_scale[axis], scale_max,
                   " of the length, as 1e-4 for 0.01 %"));
  return c->has_temperature ? check_temperature(ctx, c) : FG_OK;
}

double fg_calibration_factor(const fg_calibration *c) {
  return 1 - c->expansion_per_k * (c->temperature_c - FG_REFERENCE_TEMPERATURE_C);
}

/* Aluminium's, per K; the standard deviation of a rectangle is its half width over √3. */
#define BED_EXPANSION_PER_K 23e-6

double fg_calibration_bed(double kelvin, double u_kelvin) {
  return BED_EXPANSION_PER_K / sqrt(3) * hypot(kelvin, u_kelvin);
}

fg_calibration_budget fg_calibration_terms(const fg_calibration *c) {
  fg_calibration_budget terms = {
      .scale = {c->u_scale[0], c->u_scale[1]},
      .temperature = fabs(c->expansion_per_k) * c->u_temperature_k,
      .expansion = c->has_temperature
                       ? fabs(c->temperature_c - FG_REFERENCE_TEMPERATURE_C) * c->u_expansion_per_k
                       : 0,
      .bed = c->u_bed};
  for (int axis = 0; axis < 2; axis++)
    terms.length[axis] =
        hypot(hypot(terms.scale[axis], terms.bed), hypot(terms.temperature, terms.expansion));
  return terms;
}

/* Sources from the covariance of the stretches of x and y: [[x², c], [c, y²]], c their common part;
 * its Cholesky root, column by column. */
void fg_calibration_sources(const fg_calibration *c, double stretch[FG_CALIBRATION_SOURCES][2]) {
  fg_calibration_budget terms = fg_calibration_terms(c);
  double heat = hypot(hypot(terms.temperature, terms.expansion), terms.bed), x = terms.length[0];
  double common = c->per_axis ? heat * heat : x * x;
  memset(stretch, 0, sizeof(double[FG_CALIBRATION_SOURCES][2]));
  stretch[0][0] = x;
  stretch[0][1] = x > 0 ? common / x : 0;
  double rest = terms.length[1] * terms.length[1] - stretch[0][1] * stretch[0][1];
  if (c->per_axis) stretch[1][1] = sqrt(fmax(0, rest));
}

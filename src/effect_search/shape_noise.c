/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect_search/shape_noise.h"

#include <math.h>

#include "core/small_solve.h"

/* Reach of the fit beyond the edges, in blurs, and its steps a blur. */
#define REACH_BLURS 4.0
enum { STEPS_PER_BLUR = 8 };

enum { HALF_WIDTH, PLATEAU, LEVEL, SLOPE, BLUR, SHAPE_VALUES };

/* Derivatives of the light at x by the values of a strip with the edges at -+half, of unit contrast
 * and blur. */
static void fill_derivatives(double x, double half, double *row) {
  double right = half - x, left = half + x;
  double density[] = {exp(-0.5 * right * right) / sqrt(2 * M_PI),
                      exp(-0.5 * left * left) / sqrt(2 * M_PI)};
  double outside[] = {0.5 * erfc(right * M_SQRT1_2), 0.5 * erfc(left * M_SQRT1_2)};
  row[HALF_WIDTH] = density[0] + density[1];
  row[PLATEAU] = 1 - outside[0] - outside[1];
  row[LEVEL] = 1;
  row[SLOPE] = density[0] - right * outside[0] + density[1] - left * outside[1];
  row[BLUR] = -right * density[0] - left * density[1];
}

double fg_shape_noise_um2_mm(const fg_strip *strip, double px_mm) {
  double blur_um = 0.5 * (strip->blur_left_um + strip->blur_right_um);
  double half = 500 * strip->thickness_mm / blur_um, step = 1.0 / STEPS_PER_BLUR;
  double noise = fabs(strip->noise / strip->contrast), x[FG_SMALL_MAX];
  double inverse[FG_SMALL_MAX][FG_SMALL_MAX];
  fg_normal_equations system;
  if (!(blur_um > 0 && noise > 0 && isfinite(noise) && isfinite(half))) return 0;
  fg_normal_clear(&system, SHAPE_VALUES);
  for (double at = -half - REACH_BLURS; at <= half + REACH_BLURS; at += step) {
    double row[SHAPE_VALUES];
    fill_derivatives(at, half, row);
    fg_normal_add(&system, row, 0, step);
  }
  if (!fg_normal_solve(&system, 0, x, inverse)) return 0;
  /* In blurs², for a length of strip of one blur and a pixel's noise in an area of a blur². */
  double by_shape = inverse[HALF_WIDTH][HALF_WIDTH] - 1 / system.matrix[HALF_WIDTH][HALF_WIDTH];
  return by_shape * noise * noise * blur_um * px_mm * px_mm * 1000;
}

void fg_shape_functions(double normal_rad, const double place[2], double *values) {
  for (int k = 0; k < 2; k++) {
    values[2 * k] = cos((1 + k) * normal_rad);
    values[2 * k + 1] = sin((1 + k) * normal_rad);
    values[4 + k] = place[k];
  }
}

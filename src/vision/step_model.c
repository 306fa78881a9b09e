/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/step_model.h"

#include <string.h>

#include "core/small_solve.h"

enum { ITERATIONS_MAX = 40 };

/* Model and its derivatives at one place. */
static double model_at(const double *x, double across, double *row) {
  double s = x[FG_STEP_BLUR], d = across - x[FG_STEP_EDGE], t = d / s;
  double g = x[FG_STEP_SLOPE_IN], h = x[FG_STEP_SLOPE_OUT];
  double phi = exp(-0.5 * t * t) / sqrt(2 * M_PI), cum = 0.5 * erfc(-t * M_SQRT1_2);
  double step = x[FG_STEP_OUTSIDE] - x[FG_STEP_INSIDE];
  double light = (x[FG_STEP_INSIDE] + g * d) * (1 - cum) + (x[FG_STEP_OUTSIDE] + h * d) * cum +
                 (h - g) * s * phi;
  light = fmax(light, 1e-3);
  double gamma = x[FG_STEP_GAMMA], value = light, rate = 1;
  if (gamma != 1) {
    value = 255 * pow(light / 255, 1 / gamma);
    rate = value / (gamma * light);
  }
  /* In d/dd the terms of (h - g) t phi cancel, in d/ds those of t². */
  row[FG_STEP_EDGE] = -rate * (g * (1 - cum) + h * cum + step * phi / s);
  row[FG_STEP_INSIDE] = rate * (1 - cum);
  row[FG_STEP_OUTSIDE] = rate * cum;
  row[FG_STEP_SLOPE_IN] = rate * (d * (1 - cum) - s * phi);
  row[FG_STEP_SLOPE_OUT] = rate * (d * cum + s * phi);
  row[FG_STEP_BLUR] = rate * phi * ((h - g) - step * t / s);
  row[FG_STEP_GAMMA] = -value * log(light / 255) / (gamma * gamma);
  return value;
}

/* gamma changes at constant counts of the two levels (see edge_model.c). */
static void hold_counts(const double *x, double *row) {
  for (int i = FG_STEP_INSIDE; i <= FG_STEP_OUTSIDE; i++) {
    double light = fmax(x[i], 1e-3);
    row[FG_STEP_GAMMA] += row[i] * light * log(light / 255) / x[FG_STEP_GAMMA];
  }
}

static void build_step_equations(const fg_profile_bin *bins, size_t count, const double *x,
                                 unsigned held, fg_normal_equations *system) {
  double row[FG_STEP_VALUES];
  fg_normal_clear(system, FG_STEP_VALUES);
  for (size_t i = 0; i < count; i++) {
    if (bins[i].count <= 0) continue;
    double value = model_at(x, bins[i].across_px, row);
    if (value >= FG_COUNT_WHITE && bins[i].value >= FG_COUNT_WHITE) continue;
    hold_counts(x, row);
    for (int k = 0; k < FG_STEP_VALUES; k++)
      if (held >> k & 1) row[k] = 0;
    fg_normal_add(system, row, bins[i].value - value, bins[i].count);
  }
  for (int k = 0; k < FG_STEP_VALUES; k++)
    if (held >> k & 1) system->matrix[k][k] = 1;
}

static bool is_sensible(const double *x) {
  return x[FG_STEP_BLUR] > 0.2 && x[FG_STEP_BLUR] < 15 && x[FG_STEP_GAMMA] > 0.25 &&
         x[FG_STEP_GAMMA] < 5 && x[FG_STEP_INSIDE] > -30 && x[FG_STEP_INSIDE] < 600 &&
         x[FG_STEP_OUTSIDE] > -30 && x[FG_STEP_OUTSIDE] < 600;
}

static void advance_step_values(const double *x, const double *dx, double *moved) {
  double gamma = x[FG_STEP_GAMMA] + dx[FG_STEP_GAMMA];
  for (int i = 0; i < FG_STEP_VALUES; i++)
    moved[i] = x[i] + dx[i];
  if (dx[FG_STEP_GAMMA] == 0 || gamma < 0.1) return;
  for (int i = FG_STEP_INSIDE; i <= FG_STEP_OUTSIDE; i++)
    moved[i] = dx[i] + 255 * pow(fmax(x[i], 1e-3) / 255, gamma / x[FG_STEP_GAMMA]);
}

static void finish_step_fit(const fg_profile_bin *bins, size_t count,
                            const fg_normal_equations *system, fg_step_fit *fit) {
  double x[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX], used = 0;
  for (size_t i = 0; i < count; i++)
    used += bins[i].count > 0;
  fit->noise = used > FG_STEP_VALUES ? sqrt(system->sum_squares / (used - FG_STEP_VALUES)) : 0;
  fit->good = fit->good && fg_normal_solve(system, 0, x, inverse);
  for (int i = 0; i < FG_STEP_VALUES && fit->good; i++)
    fit->sd[i] = fit->held >> i & 1 ? 0 : fit->noise * sqrt(inverse[i][i]);
  fit->shape_ratio = fit->good ? inverse[0][0] * system->matrix[0][0] : 1;
}

void fg_step_fit_model(const fg_profile_bin *bins, size_t count, fg_step_fit *fit) {
  double x[FG_STEP_VALUES], trial[FG_STEP_VALUES], dx[FG_SMALL_MAX], damping = 1e-4;
  fg_normal_equations system, next;
  memcpy(x, fit->values, sizeof x);
  build_step_equations(bins, count, x, fit->held, &system);
  fit->good = false;
  for (int i = 0; i < ITERATIONS_MAX && damping < 1e6; i++) {
    bool solved = fg_normal_solve(&system, damping, dx, NULL);
    if (solved) advance_step_values(x, dx, trial);
    solved = solved && is_sensible(trial);
    if (solved) build_step_equations(bins, count, trial, fit->held, &next);
    if (!solved || !(next.sum_squares <= system.sum_squares)) {
      damping *= 10;
      continue;
    }
    double gain = system.sum_squares - next.sum_squares;
    memcpy(x, trial, sizeof x);
    system = next;
    damping *= 0.1;
    fit->good = true;
    if (gain <= 1e-6 * system.sum_squares) break;
  }
  memcpy(fit->values, x, sizeof x);
  finish_step_fit(bins, count, &system, fit);
}

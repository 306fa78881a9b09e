/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/edge_model.h"

#include <string.h>

#include "core/small_solve.h"

/* Order of unknowns in a profile fit. */
enum {
  EDGE_LEFT,
  EDGE_RIGHT,
  PLATEAU,
  LEVEL_L,
  LEVEL_R,
  SLOPE_L,
  SLOPE_R,
  BLUR_L,
  BLUR_R,
  GAMMA,
  UNKNOWNS
};

enum { ITERATIONS_MAX = 30 };

void fg_edge_tables_init(fg_edge_tables *tables, double gamma) {
  int count = 2 * FG_NORMAL_REACH * FG_NORMAL_STEPS + 2;
  for (int i = 0; i < count; i++) {
    double t = (double)i / FG_NORMAL_STEPS - FG_NORMAL_REACH;
    tables->density[i] = (float)(exp(-0.5 * t * t) / sqrt(2 * M_PI));
    tables->cumulative[i] = (float)(0.5 * erfc(-t * M_SQRT1_2));
  }
  tables->linear = gamma == 1;
  for (int i = 0; i < FG_TONE_STEPS + 2; i++)
    tables->tone[i] = (float)(255 * pow((double)i / FG_TONE_STEPS, 1 / gamma));
}

double fg_edge_count(double gamma, double light) {
  return 255 * pow(fmax(light, 0) / 255, 1 / gamma);
}

double fg_edge_light(double gamma, double count) {
  return 255 * pow(fmax(count, 0) / 255, gamma);
}

double fg_edge_count_between(double gamma, const double counts[2]) {
  double light = 0.5 * (fg_edge_light(gamma, counts[0]) + fg_edge_light(gamma, counts[1]));
  return 255 * pow(light / 255, 1 / gamma);
}

/* One blurred step T(d) and its derivatives by d, b (level), g (slope), s (blur). */
typedef struct step {
  double value, by_distance, by_level, by_slope, by_blur;
} step;

static step step_at(const fg_edge_tables *tables, double d, double level, double slope,
                    double plateau, double blur) {
  float density, cumulative;
  double t = d / blur;
  fg_edge_normal(tables, (float)t, &density, &cumulative);
  double phi = density, cum = cumulative;
  step s = {0};
  /* Beyond the table's reach the step is whole, or none. */
  if (phi == 0 && cum == 0) return s;
  if (phi == 0 && cum == 1)
    return (step){level + slope * d - plateau, .by_distance = slope, .by_level = 1, .by_slope = d};
  s.value = (level + slope * d - plateau) * cum + slope * blur * phi;
  s.by_distance = slope * cum + (level - plateau) * phi / blur;
  s.by_level = cum;
  s.by_slope = d * cum + blur * phi;
  /* d/ds of Phi(d/s) is -t phi / s; d/ds of s phi(d/s) is phi (1 + t²). */
  s.by_blur = -(level + slope * d - plateau) * t * phi / blur + slope * phi * (1 + t * t);
  return s;
}

static void pack_unknowns(const fg_profile_fit *fit, double *x) {
  const double values[UNKNOWNS] = {
      fit->edge_px[0],       fit->edge_px[1],     fit->shape.plateau,  fit->shape.level[0],
      fit->shape.level[1],   fit->shape.slope[0], fit->shape.slope[1], fit->shape.blur_px[0],
      fit->shape.blur_px[1], fit->gamma};
  memcpy(x, values, sizeof values);
}

static void unpack_unknowns(const double *x, fg_profile_fit *fit) {
  fit->edge_px[0] = x[EDGE_LEFT];
  fit->edge_px[1] = x[EDGE_RIGHT];
  fit->shape = (fg_edge_shape){.plateau = x[PLATEAU],
                               .level = {x[LEVEL_L], x[LEVEL_R]},
                               .slope = {x[SLOPE_L], x[SLOPE_R]},
                               .blur_px = {x[BLUR_L], x[BLUR_R]}};
  fit->gamma = x[GAMMA];
}

/* Model and its derivatives at one place. */
static double model_at(const fg_edge_tables *tables, const double *x, double across,
                       size_t unknowns, double *row) {
  step left = step_at(tables, x[EDGE_LEFT] - across, x[LEVEL_L], x[SLOPE_L], x[PLATEAU], x[BLUR_L]);
  step right =
      step_at(tables, across - x[EDGE_RIGHT], x[LEVEL_R], x[SLOPE_R], x[PLATEAU], x[BLUR_R]);
  double light = fmax(x[PLATEAU] + left.value + right.value, 1e-3);
  double gamma = x[GAMMA], value = light, rate = 1;
  if (gamma != 1) {
    value = 255 * pow(light / 255, 1 / gamma);
    rate = value / (gamma * light);
  }
  row[EDGE_LEFT] = rate * left.by_distance;
  row[EDGE_RIGHT] = -rate * right.by_distance;
  row[PLATEAU] = rate * (1 - left.by_level - right.by_level);
  row[LEVEL_L] = rate * left.by_level;
  row[LEVEL_R] = rate * right.by_level;
  row[SLOPE_L] = rate * left.by_slope;
  row[SLOPE_R] = rate * right.by_slope;
  row[BLUR_L] = rate * left.by_blur;
  row[BLUR_R] = rate * right.by_blur;
  if (unknowns > GAMMA) row[GAMMA] = -value * log(light / 255) / (gamma * gamma);
  return value;
}

/* Makes the derivative by gamma one at constant counts. Levels are in light, so a step in gamma
 * must carry them along: the fitted values are the counts at the plateau and the two backgrounds.
 * So the row loses the change that the levels' own change would cause. */
static void hold_counts(const double *x, double *row) {
  double gamma = x[GAMMA];
  const int levels[3] = {PLATEAU, LEVEL_L, LEVEL_R};
  for (int i = 0; i < 3; i++) {
    double light = fmax(x[levels[i]], 1e-3);
    row[GAMMA] += row[levels[i]] * light * log(light / 255) / gamma;
  }
}

static void build_profile_equations(const fg_edge_tables *tables, const fg_profile_bin *bins,
                                    size_t count, const double *x, size_t unknowns,
                                    fg_normal_equations *system) {
  enum { ROWS = 32 };
  fg_normal_row rows[ROWS];
  size_t held = 0;
  memset(rows, 0, sizeof rows);
  fg_normal_clear(system, unknowns);
  for (size_t i = 0; i < count; i++) {
    if (bins[i].count <= 0) continue;
    fg_normal_row *row = &rows[held++];
    row->right = bins[i].value - model_at(tables, x, bins[i].across_px, unknowns, row->values);
    row->weight = bins[i].count;
    if (unknowns > GAMMA) hold_counts(x, row->values);
    if (held < ROWS) continue;
    fg_normal_add_rows(system, rows, held);
    held = 0;
  }
  fg_normal_add_rows(system, rows, held);
}

static bool is_sensible(const double *x) {
  return x[EDGE_RIGHT] > x[EDGE_LEFT] && x[BLUR_L] > 0.2 && x[BLUR_R] > 0.2 && x[BLUR_L] < 12 &&
         x[BLUR_R] < 12 && x[GAMMA] > 0.25 && x[GAMMA] < 5 && x[PLATEAU] > -20 && x[PLATEAU] < 600;
}

/* Steps the unknowns; the levels follow gamma at constant counts. */
static void advance_unknowns(const double *x, const double *dx, size_t unknowns, double *moved) {
  memcpy(moved, x, UNKNOWNS * sizeof *x);
  double gamma = x[GAMMA] + (unknowns > GAMMA ? dx[GAMMA] : 0);
  const int levels[3] = {PLATEAU, LEVEL_L, LEVEL_R};
  if (gamma != x[GAMMA] && gamma > 0.1)
    for (int i = 0; i < 3; i++)
      moved[levels[i]] = 255 * pow(fmax(x[levels[i]], 1e-3) / 255, gamma / x[GAMMA]);
  for (size_t i = 0; i < unknowns; i++)
    if (i != GAMMA) moved[i] += dx[i];
  moved[GAMMA] = gamma;
}

static void finish_profile_fit(const fg_profile_bin *bins, size_t count, size_t unknowns,
                               const fg_normal_equations *system, fg_profile_fit *fit) {
  double x[UNKNOWNS], inverse[FG_SMALL_MAX][FG_SMALL_MAX];
  size_t used = 0;
  for (size_t i = 0; i < count; i++)
    used += bins[i].count > 0;
  fit->noise = used > unknowns ? sqrt(system->sum_squares / (double)(used - unknowns)) : 0;
  fit->good = fit->good && fg_normal_solve(system, 0, x, inverse);
  for (int i = 0; i < FG_EDGE_SHAPE_VALUES && fit->good; i++)
    fit->sd[i] = fit->noise * sqrt(inverse[PLATEAU + i][PLATEAU + i]);
  fit->u_gamma = fit->good && unknowns > GAMMA ? fit->noise * sqrt(inverse[GAMMA][GAMMA]) : 0;
}

void fg_profile_fit_model(const fg_edge_tables *tables, const fg_profile_bin *bins, size_t count,
                          int free_gamma, fg_profile_fit *fit) {
  size_t unknowns = free_gamma ? UNKNOWNS : GAMMA;
  double x[UNKNOWNS], trial[UNKNOWNS], dx[FG_SMALL_MAX], damping = 1e-4;
  fg_normal_equations systems[2], *system = &systems[0], *next = &systems[1];
  pack_unknowns(fit, x);
  build_profile_equations(tables, bins, count, x, unknowns, system);
  fit->good = 0;
  for (int i = 0; i < ITERATIONS_MAX && damping < 1e6; i++) {
    if (!fg_normal_solve(system, damping, dx, NULL)) {
      damping = fmax(damping * 10, 1e-6);
      continue;
    }
    advance_unknowns(x, dx, unknowns, trial);
    if (is_sensible(trial)) build_profile_equations(tables, bins, count, trial, unknowns, next);
    if (!is_sensible(trial) || !(next->sum_squares <= system->sum_squares)) {
      damping *= 10;
      continue;
    }
    double gain = system->sum_squares - next->sum_squares;
    fg_normal_equations *before = system;
    memcpy(x, trial, sizeof x);
    system = next;
    next = before;
    damping *= 0.1;
    fit->good = 1;
    if (gain <= 1e-5 * system->sum_squares) break;
  }
  unpack_unknowns(x, fit);
  finish_profile_fit(bins, count, unknowns, system, fit);
}

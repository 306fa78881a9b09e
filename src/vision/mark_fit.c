/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/mark_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/small_solve.h"

/* The first rounds see every third pixel of the window, the last ones all that an edge's blur
 * reaches. */
enum { COARSE_STEP = 3, COARSE_ROUNDS = 12, FINE_ROUNDS = 8, SAMPLES_MIN = 30 };
#define EDGE_BLURS  4.5
#define EDGE_BESIDE 2.0 /* px */
#define BLUR_MIN    0.3
#define BLUR_START  2.0
/* Steps are smaller by a tenth or more from round to round: what follows one of these is far below
 * the noise. The first rounds need only lay the band of the last ones. */
#define STEP_END_COARSE_PX 0.05
#define STEP_END_PX        2e-4
#define DAMPING_START      1e-3
/* A mark deviates from its model by less than this share of its contrast, rms. */
#define MISFIT_MAX 0.2
/* An end of a stroke leaves a thousandth of the contrast at this many blurs; arms are sought up to
 * this many windows' radii. */
#define END_BLURS   3.0
#define ARM_LONGEST 2.0
/* A pixel that is so far within a stroke's border has more than half of the contrast. */
#define INSIDE_PX 1.0
/* Lags at which the residual's correlation is summed. */
enum { LAGS = 4 };

typedef struct mark_sample {
  int32_t x, y;
  float value;
} mark_sample;

typedef struct mark_samples {
  mark_sample *list;
  size_t count, wanted;
} mark_samples;

static bool is_in_window(const fg_mark_fit *fit, fg_mark_kind kind, double dx, double dy) {
  if (kind != FG_MARKS_LINES) return dx * dx + dy * dy <= fit->reach_px * fit->reach_px;
  double angle = fit->p[FG_MARK_SHAPE];
  double across = dx * cos(angle) + dy * sin(angle), along = dy * cos(angle) - dx * sin(angle);
  return fabs(across) <= fit->reach_px && fabs(along) <= fit->along_px;
}

static fg_status gather_samples(fg_context *ctx, const fg_tiles *tiles, fg_mark_kind kind,
                                const fg_mark_fit *fit, bool fine, mark_samples *samples) {
  const fg_mark_model *model = fg_mark_model_of(kind);
  int64_t step = fine ? 1 : COARSE_STEP;
  double reach = kind == FG_MARKS_LINES ? hypot(fit->reach_px, fit->along_px) : fit->reach_px;
  int64_t x0 = llround(fit->p[FG_MARK_X] - reach), x1 = llround(fit->p[FG_MARK_X] + reach);
  int64_t y0 = llround(fit->p[FG_MARK_Y] - reach), y1 = llround(fit->p[FG_MARK_Y] + reach);
  double band = EDGE_BLURS * fit->p[FG_MARK_BLUR] + EDGE_BESIDE;
  fg_mark_shape shape = fg_mark_shape_of(model, fit->p);
  if (2 * reach < 48) step = 1;
  size_t side = (size_t)((x1 - x0) / step + 1), rows = (size_t)((y1 - y0) / step + 1);
  FG_TRY(fg_memory_allocate(ctx, side * rows, sizeof *samples->list, (void **)&samples->list));
  samples->count = samples->wanted = 0;
  for (int64_t y = y0; y <= y1; y += step)
    for (int64_t x = x0; x <= x1; x += step) {
      double dx = (double)x - fit->p[FG_MARK_X], dy = (double)y - fit->p[FG_MARK_Y];
      if (!is_in_window(fit, kind, dx, dy)) continue;
      if (fine && model->edge_distance(&shape, dx, dy) > band) continue;
      float value = fg_tiles_pixel(tiles, x, y);
      samples->wanted++;
      if (isfinite(value))
        samples->list[samples->count++] = (mark_sample){(int32_t)x, (int32_t)y, value};
    }
  return FG_OK;
}

/* Normal equations about p. */
static void linearise(const fg_mark_model *model, const mark_samples *samples, const double *p,
                      fg_normal_equations *system) {
  double gradient[FG_MARK_PARAMETERS_MAX];
  static const double along[FG_MARK_PARAMETERS_MAX] = {[FG_MARK_Y] = 1};
  fg_mark_shape shape = fg_mark_shape_of(model, p);
  fg_normal_clear(system, model->parameters);
  if (model->one_axis) fg_normal_add(system, along, 0, 1); /* no place along a line */
  for (size_t i = 0; i < samples->count; i++) {
    const mark_sample *s = &samples->list[i];
    double value = model->value(&shape, s->x - p[FG_MARK_X], s->y - p[FG_MARK_Y], gradient);
    fg_normal_add(system, gradient, (double)s->value - value, 1);
  }
}

static bool is_sane(const fg_mark_fit *fit, const double *p) {
  double moved = hypot(p[FG_MARK_X] - fit->p[FG_MARK_X], p[FG_MARK_Y] - fit->p[FG_MARK_Y]);
  return isfinite(p[FG_MARK_CONTRAST]) && p[FG_MARK_BLUR] >= BLUR_MIN &&
         p[FG_MARK_BLUR] < fit->reach_px && moved < 0.5 * fit->reach_px;
}

/* Splits a step across a line into x and y. */
static void split_across(double angle, double *step) {
  step[FG_MARK_Y] = step[FG_MARK_X] * sin(angle);
  step[FG_MARK_X] *= cos(angle);
}

/* Levenberg and Marquardt, until a step is shorter than `end`; returns false where it leads
 * nowhere. Most steps are taken, so each is linearised at once. */
static bool descend(const fg_mark_model *model, const mark_samples *samples, int rounds, double end,
                    fg_mark_fit *fit, fg_normal_equations *system) {
  double damping = DAMPING_START, p[FG_MARK_PARAMETERS_MAX], step[FG_SMALL_MAX];
  fg_normal_equations next;
  size_t n = model->parameters;
  linearise(model, samples, fit->p, system);
  for (int round = 0; round < rounds && damping <= 1e6; round++) {
    if (!fg_normal_solve(system, damping, step, NULL)) return false;
    if (model->one_axis) split_across(fit->p[FG_MARK_SHAPE], step);
    for (size_t k = 0; k < n; k++)
      p[k] = fit->p[k] + step[k];
    bool sane = is_sane(fit, p);
    if (sane) linearise(model, samples, p, &next);
    if (!sane || !(next.sum_squares <= system->sum_squares)) {
      damping = fmax(10 * damping, DAMPING_START);
      continue;
    }
    memcpy(fit->p, p, n * sizeof *p);
    *system = next;
    damping *= 0.05;
    if (hypot(step[FG_MARK_X], step[FG_MARK_Y]) < end) return true;
  }
  return true;
}

/* Sum of the residual's correlation over neighbours in a row, at least 1. */
static double residual_integral(const fg_mark_model *model, const mark_samples *samples,
                                const double *p) {
  double product[LAGS + 1] = {0}, pairs[LAGS + 1] = {0}, before[LAGS + 1] = {0};
  double gradient[FG_MARK_PARAMETERS_MAX], sum = 1;
  fg_mark_shape shape = fg_mark_shape_of(model, p);
  for (size_t i = 0; i < samples->count; i++) {
    const mark_sample *s = &samples->list[i];
    double off =
        (double)s->value - model->value(&shape, s->x - p[FG_MARK_X], s->y - p[FG_MARK_Y], gradient);
    before[i % (LAGS + 1)] = off;
    for (size_t lag = 0; lag <= LAGS && lag <= i; lag++) {
      const mark_sample *other = &samples->list[i - lag];
      if (other->y != s->y || other->x + (int32_t)lag != s->x) break;
      product[lag] += off * before[(i - lag) % (LAGS + 1)];
      pairs[lag]++;
    }
  }
  for (int lag = 1; lag <= LAGS && pairs[lag] > 0 && product[0] > 0; lag++) {
    double correlation = product[lag] / pairs[lag] / (product[0] / pairs[0]);
    if (correlation < 2 / sqrt(pairs[lag])) break;
    sum += 2 * correlation;
  }
  return sum;
}

static void find_uncertainty(const fg_mark_model *model, const mark_samples *samples,
                             const fg_normal_equations *system, fg_mark_fit *fit) {
  double inverse[FG_SMALL_MAX][FG_SMALL_MAX], step[FG_SMALL_MAX];
  double dof = (double)samples->count - (double)model->parameters;
  fit->residual = sqrt(system->sum_squares / dof);
  fit->u_px = INFINITY;
  if (!fg_normal_solve(system, 0, step, inverse)) return;
  double variance = inverse[FG_MARK_X][FG_MARK_X];
  if (!model->one_axis) variance = 0.5 * (variance + inverse[FG_MARK_Y][FG_MARK_Y]);
  /* Noise that neighbours share along a row, they share along a column, too. */
  fit->u_px = fit->residual * sqrt(variance) * residual_integral(model, samples, fit->p);
}

static fg_status fit_once(fg_context *ctx, const fg_tiles *tiles, fg_mark_kind kind, bool fine,
                          fg_mark_fit *fit, bool *found) {
  const fg_mark_model *model = fg_mark_model_of(kind);
  fg_normal_equations system;
  mark_samples samples = {0};
  FG_TRY(gather_samples(ctx, tiles, kind, fit, fine, &samples));
  fit->share = samples.wanted ? (double)samples.count / (double)samples.wanted : 0;
  *found = samples.count >= SAMPLES_MIN &&
           descend(model, &samples, fine ? FINE_ROUNDS : COARSE_ROUNDS,
                   fine ? STEP_END_PX : STEP_END_COARSE_PX, fit, &system);
  if (*found && fine) find_uncertainty(model, &samples, &system, fit);
  free(samples.list);
  return FG_OK;
}

/* Length of a cross's arm in a direction, to where its end has half of the contrast, `offset_px`
 * beside the arm's middle. */
static double find_arm_px(const fg_tiles *tiles, const fg_mark_fit *fit, double angle,
                          double offset_px) {
  double longest = ARM_LONGEST * fit->reach_px, half = 0.5 * fabs(fit->p[FG_MARK_CONTRAST]);
  double x = fit->p[FG_MARK_X] - offset_px * sin(angle),
         y = fit->p[FG_MARK_Y] + offset_px * cos(angle);
  for (double along = 0.5 * fit->reach_px; along < longest; along += 0.5) {
    double value =
        fg_tiles_pixel(tiles, llround(x + along * cos(angle)), llround(y + along * sin(angle)));
    if (!(fabs(value - fit->p[FG_MARK_LEVEL]) > half)) return along;
  }
  return 0; /* no end: an arm that meets the next mark's */
}

/* The model's strokes have no ends: the window may reach as far as no blur of an end does. A round
 * end begins at the stroke's borders. */
static void widen_cross(const fg_tiles *tiles, fg_mark_fit *fit) {
  double w = fit->p[FG_MARK_SHAPE + 2], shortest = INFINITY;
  for (int arm = 0; arm < 4; arm++) {
    double along = fit->p[FG_MARK_SHAPE + (arm & 1)] + M_PI_2 + (arm & 2 ? M_PI : 0);
    for (int side = -1; side <= 1; side++)
      shortest = fmin(shortest, find_arm_px(tiles, fit, along, side * fmax(0, w - INSIDE_PX)));
  }
  double end = shortest - END_BLURS * fit->p[FG_MARK_BLUR];
  /* At the border of the stroke a circle about the cross lies nearer to the end. */
  fit->reach_px = fmax(fit->reach_px, sqrt(fmax(0, end * end - w * w)));
}

fg_status fg_mark_fit_run(fg_context *ctx, const fg_tiles *tiles, fg_mark_kind kind,
                          fg_mark_fit *fit, bool *found) {
  if (!(fit->p[FG_MARK_BLUR] > 0)) fit->p[FG_MARK_BLUR] = BLUR_START;
  FG_TRY(fit_once(ctx, tiles, kind, false, fit, found));
  if (*found && kind == FG_MARKS_CROSSES) widen_cross(tiles, fit);
  if (*found) FG_TRY(fit_once(ctx, tiles, kind, true, fit, found));
  *found =
      *found && isfinite(fit->u_px) && fit->residual < MISFIT_MAX * fabs(fit->p[FG_MARK_CONTRAST]);
  return FG_OK;
}

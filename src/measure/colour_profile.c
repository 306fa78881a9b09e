/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/colour_profile.h"

#include <math.h>

#include "core/small_solve.h"

enum { LEVEL, CONTRAST, SHIFT, BLUR, VALUES, ROUNDS = 12, PIXELS_MIN = 12 };
#define BLUR_MIN_PX    0.35
#define BLUR_MAX_PX    8.0
#define STEP_MAX_PX    1.0
#define CONVERGED_PX   1e-4
#define BLUR_CONVERGED 0.005
#define OUTER_SHARE    0.8 /* share of the reach beyond which pixels belong to the surroundings */

/* The profile at v = n - shift, without level and contrast: its value and its derivatives by v and
 * by the blur. */
typedef struct profile_shape {
  double value, by_v, by_blur;
} profile_shape;

static profile_shape add_edge(const fg_edge_tables *tables, profile_shape sum, double sign,
                              double v, double blur) {
  float density, cumulative;
  double u = v / blur;
  fg_edge_normal(tables, (float)u, &density, &cumulative);
  double p = (double)density / blur;
  sum.value += sign * (double)cumulative;
  sum.by_v += sign * p;
  sum.by_blur -= sign * p * u;
  return sum;
}

static profile_shape profile_at(const fg_edge_tables *tables, const fg_colour_known *known,
                                double v, double blur) {
  profile_shape sum = {0};
  if (isinf(known->half_width_px)) {
    sum = add_edge(tables, sum, 1, -v, blur);
    sum.by_v = -sum.by_v;
    return sum;
  }
  sum = add_edge(tables, sum, 1, v + known->half_width_px, blur);
  return add_edge(tables, sum, -1, v - known->half_width_px, blur);
}

/* First estimates: level outside; contrast and place from the pixels' excess over it. A strip's
 * place is its centre of gravity, a single edge's the filled part of the reach. */
static bool estimate_start(const fg_colour_known *known, const fg_colour_pixel *pixels,
                           size_t count, int channel, double x[VALUES]) {
  bool outlier = isinf(known->half_width_px);
  double reach = 0, level = 0, outside = 0, inner = 0, inside = 0, sum = 0, moment = 0;
  for (size_t i = 0; i < count; i++)
    reach = fmax(reach, fabs((double)pixels[i].across_px));
  double out = OUTER_SHARE * reach, in = outlier ? -out : fmin(known->half_width_px, 0.5 * reach);
  for (size_t i = 0; i < count; i++) {
    double n = (double)pixels[i].across_px, value = (double)pixels[i].value[channel];
    bool is_out = outlier ? n > out : fabs(n) > out, is_in = outlier ? n < in : fabs(n) < in;
    outside += is_out;
    level += is_out ? value : 0;
    inside += is_in;
    inner += is_in ? value : 0;
  }
  if (outside < 1 || inside < 1) return false;
  x[LEVEL] = level / outside;
  x[CONTRAST] = inner / inside - x[LEVEL];
  for (size_t i = 0; i < count; i++) {
    double more = (double)pixels[i].value[channel] - x[LEVEL];
    sum += more;
    moment += more * (double)pixels[i].across_px;
  }
  if (x[CONTRAST] == 0 || sum == 0) return false;
  x[SHIFT] = outlier ? reach * (2 * sum / x[CONTRAST] / (double)count - 1) : moment / sum;
  x[SHIFT] = fmax(-0.5 * reach, fmin(0.5 * reach, x[SHIFT]));
  x[BLUR] = known->blur_px;
  return true;
}

/* Data of the fit. */
typedef struct profile {
  const fg_edge_tables *tables;
  const fg_colour_known *known;
  const fg_colour_pixel *pixels;
  size_t count;
  int channel;
} profile;

/* Normal equations of one round; returns the sum of squares. */
static double add_pixels(const profile *p, const double x[VALUES], fg_normal_equations *system) {
  double sum = 0;
  fg_normal_clear(system, VALUES);
  for (size_t i = 0; i < p->count; i++) {
    const fg_colour_pixel *pixel = &p->pixels[i];
    profile_shape at =
        profile_at(p->tables, p->known, (double)pixel->across_px - x[SHIFT], x[BLUR]);
    double row[VALUES] = {1, at.value, -x[CONTRAST] * at.by_v, x[CONTRAST] * at.by_blur};
    double residual = (double)pixel->value[p->channel] - x[LEVEL] - x[CONTRAST] * at.value;
    fg_normal_add(system, row, residual, 1);
    sum += residual * residual;
  }
  return sum;
}

static void add_step(double x[VALUES], const double step[VALUES]) {
  x[LEVEL] += step[LEVEL];
  x[CONTRAST] += step[CONTRAST];
  x[SHIFT] += fmax(-STEP_MAX_PX, fmin(STEP_MAX_PX, step[SHIFT]));
  double blur = x[BLUR] + fmax(-0.3 * x[BLUR], fmin(0.5 * x[BLUR], step[BLUR]));
  x[BLUR] = fmax(BLUR_MIN_PX, fmin(BLUR_MAX_PX, blur));
}

void fg_colour_profile_fit(const fg_edge_tables *tables, const fg_colour_known *known,
                           const fg_colour_pixel *pixels, size_t count, int channel,
                           fg_colour_place *place) {
  const profile p = {tables, known, pixels, count, channel};
  double x[VALUES], step[VALUES], inverse[FG_SMALL_MAX][FG_SMALL_MAX];
  fg_normal_equations system;
  *place = (fg_colour_place){0};
  if (count < PIXELS_MIN || !estimate_start(known, pixels, count, channel, x)) return;
  bool converged = false;
  double sum = 0;
  for (int round = 0; round < ROUNDS && !converged; round++) {
    sum = add_pixels(&p, x, &system);
    if (!fg_normal_solve(&system, 1e-9, step, inverse)) return;
    add_step(x, step);
    converged = fabs(step[SHIFT]) < CONVERGED_PX && fabs(step[BLUR]) < BLUR_CONVERGED * x[BLUR];
  }
  *place = (fg_colour_place){.shift_px = x[SHIFT],
                             .variance = inverse[SHIFT][SHIFT],
                             .contrast = x[CONTRAST],
                             .noise = sum / (double)(count - VALUES),
                             .good = converged};
}

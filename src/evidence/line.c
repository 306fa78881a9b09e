/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/line.h"

#include <math.h>

/* Domain over that of the rows. */
#define REACH 1.3

static double wave_number(const fg_line *l, size_t j) {
  return M_PI * (double)(j + 1) / (2 * REACH * l->half);
}

void fg_line_fill(const fg_line *l, double at, double *values) {
  double reach = REACH * l->half, u = fmax(-REACH, fmin(REACH, (at - l->middle) / l->half));
  double angle = wave_number(l, 0) * (u * l->half + reach), s = sin(angle), c2 = 2 * cos(angle);
  double before = 0, now = s, norm = 1 / sqrt(reach);
  for (size_t j = 0; j < FG_LINE_SINES; j++) {
    values[j] = norm * now;
    double next = c2 * now - before;
    before = now;
    now = next;
  }
  double *p = values + FG_LINE_SINES;
  p[0] = u;
  p[1] = (3 * u * u - 1) / 2;
  p[2] = u * (5 * u * u - 3) / 2;
  p[3] = ((35 * u * u - 30) * u * u + 3) / 8;
}

/* Spectrum of a Matérn process of order 3/2; polynomials vary less the shorter the length is. */
static void fill_line_variances(const fg_line *l, double length, double *variance) {
  static const double power[FG_LINE_LONG] = {0, 1, 2, 4},
                      size[FG_LINE_LONG] = {0.5, 0.25, 0.125, 0.06};
  double k = sqrt(3) / length;
  for (size_t j = 0; j < FG_LINE_SINES; j++) {
    double w = wave_number(l, j);
    variance[j] = 4 * k * k * k / ((k * k + w * w) * (k * k + w * w));
  }
  for (size_t j = 0; j < FG_LINE_LONG; j++)
    variance[FG_LINE_SINES + j] = size[j] * fmin(1, pow(length / l->half, power[j]));
}

fg_line fg_line_over(double low, double high) {
  return (fg_line){0.5 * (low + high), fmax(0.5005 * (high - low), 1e-3)};
}

bool fg_line_variances(const fg_line *l, double first, size_t i, double *variance) {
  if (i >= 5) return false;
  fill_line_variances(l, ldexp(first, (int)i), variance);
  return true;
}

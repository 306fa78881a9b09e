/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <float.h>
#include <math.h>
#include <string.h>

#include "geometry/circle_arc.h"

/* Parameters of a step from an arc: bend (dk), turn (dtheta) and shift along n, all zero at the arc
 * itself, which is re-based at every iteration. With g = n.v, t = m.v, m = (ny, -nx), n(theta) =
 * n cos theta + m sin theta and v = p - q - shift n:
 *
 *     P_k = |v|²/2   P_theta = -t   P_shift = 1 - k g
 *     P_k,shift = -g   P_theta,theta = g   P_shift,shift = k   (the others are 0)
 *
 * and from d = ((1 + 2 k P)^1/2 - 1) / k, S = 1 + k d:
 *
 *     d_P = 1/S   d_k = -d²/(2 S)   d_PP = -k/S³   d_Pk = -P/S³   d_kk = d³/(2 S²) + d² P/(2 S³) */
enum { BEND, TURN, SHIFT };

typedef struct normal_equations {
  double ms;            /* sum w d² */
  double gradient[3];   /* sum w d grad d */
  double hessian[3][3]; /* sum w (grad d grad d' + d hess d) */
  double gauss[3][3];   /* sum w grad d grad d' */
} normal_equations;

typedef struct distance {
  double value;
  double gradient[3];
  double hessian[3][3]; /* lower triangle */
} distance;

static void hessian_of_distance(const fg_circle_arc *arc, double p, double s, double g,
                                const double p_gradient[3], distance *d) {
  double k = arc->curvature, per_s3 = 1 / (s * s * s);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j <= i; j++)
      d->hessian[i][j] = -k * per_s3 * p_gradient[i] * p_gradient[j];
  d->hessian[SHIFT][BEND] += -g / s - p * per_s3 * p_gradient[SHIFT];
  d->hessian[TURN][BEND] += -p * per_s3 * p_gradient[TURN];
  d->hessian[TURN][TURN] += g / s;
  d->hessian[SHIFT][SHIFT] += k / s;
  d->hessian[BEND][BEND] +=
      -2 * p * per_s3 * p_gradient[BEND] + d->value * d->value * (d->value * s + p) * 0.5 * per_s3;
}

static void distance_of(const fg_circle_arc *arc, double x, double y, distance *d) {
  double vx = x - arc->qx, vy = y - arc->qy, k = arc->curvature;
  double g = arc->nx * vx + arc->ny * vy, t = arc->ny * vx - arc->nx * vy;
  double half_square = 0.5 * (vx * vx + vy * vy);
  double p = k * half_square - g;
  /* At the centre (S = 0) the distance has no derivative: kept off by a hair. */
  double s = sqrt(fmax(1 + 2 * k * p, 1e-12));
  double p_gradient[3] = {half_square, -t, 1 - k * g};
  d->value = 2 * p / (1 + s);
  for (int i = 0; i < 3; i++)
    d->gradient[i] = p_gradient[i] / s;
  d->gradient[BEND] -= d->value * d->value / (2 * s);
  hessian_of_distance(arc, p, s, g, p_gradient, d);
}

static void gather_equations(const fg_circle_scaled *scaled, const fg_circle_arc *arc,
                             normal_equations *sums) {
  memset(sums, 0, sizeof *sums);
  for (size_t n = 0; n < scaled->count; n++) {
    distance d;
    double w = scaled->weight[n];
    distance_of(arc, scaled->x[n], scaled->y[n], &d);
    sums->ms += w * d.value * d.value;
    for (int i = 0; i < 3; i++) {
      sums->gradient[i] += w * d.value * d.gradient[i];
      for (int j = 0; j <= i; j++) {
        double product = w * d.gradient[i] * d.gradient[j];
        sums->gauss[i][j] += product;
        sums->hessian[i][j] += product + w * d.value * d.hessian[i][j];
      }
    }
  }
}

/* Cholesky of the lower triangle scaled by `diagonal`^1/2 on both sides (the shift of 1 and the
 * bend of 1 differ by the square of the arc's length). False unless clearly positive definite. */
static bool factorise_scaled(double matrix[3][3], const double diagonal[3], double damping,
                             double factor[3][3]) {
  for (int i = 0; i < 3; i++) {
    if (!(diagonal[i] > 0)) return false;
    for (int j = 0; j <= i; j++) {
      double sum = matrix[i][j] / sqrt(diagonal[i] * diagonal[j]) + (i == j ? damping : 0);
      for (int k = 0; k < j; k++)
        sum -= factor[i][k] * factor[j][k];
      if (i == j && !(sum > 64 * DBL_EPSILON)) return false;
      factor[i][j] = i == j ? sqrt(sum) : sum / factor[j][j];
    }
  }
  return true;
}

static void solve_factored(double factor[3][3], const double diagonal[3], const double right[3],
                           double solution[3]) {
  for (int i = 0; i < 3; i++) {
    double sum = right[i] / sqrt(diagonal[i]);
    for (int k = 0; k < i; k++)
      sum -= factor[i][k] * solution[k];
    solution[i] = sum / factor[i][i];
  }
  for (int i = 2; i >= 0; i--) {
    for (int k = i + 1; k < 3; k++)
      solution[i] -= factor[k][i] * solution[k];
    solution[i] /= factor[i][i];
  }
  for (int i = 0; i < 3; i++)
    solution[i] /= sqrt(diagonal[i]);
}

/* Takes a step with the smallest damping (from *damping upwards) that does not increase the sum.
 * Returns its size relative to the arc, or a negative number when there is none. */
static double make_step(const fg_circle_scaled *scaled, normal_equations *sums, fg_circle_arc *arc,
                        double *damping) {
  const double diagonal[3] = {sums->gauss[0][0], sums->gauss[1][1], sums->gauss[2][2]};
  const double slack = 1e-13 * sums->ms + DBL_EPSILON * DBL_EPSILON;
  for (; *damping < 1e12; *damping = fmax(10 * *damping, 1e-4)) {
    double factor[3][3], step[3];
    if (!factorise_scaled(sums->hessian, diagonal, *damping, factor)) continue;
    solve_factored(factor, diagonal, sums->gradient, step);
    fg_circle_arc moved = fg_circle_arc_step(arc, -step[BEND], -step[TURN], -step[SHIFT]);
    if (!(fg_circle_arc_ms(scaled, &moved) <= sums->ms + slack)) continue;
    double scale = fmax(fabs(arc->curvature), FG_CIRCLE_FLAT);
    *arc = fg_circle_arc_rebase(&moved);
    return fmax(fmax(fabs(step[BEND]) / scale, fabs(step[TURN])), fabs(step[SHIFT]));
  }
  return -1;
}

/* Converged when a step is down to rounding, or when full Newton steps no longer shrink although
 * they are tiny: the remainder is the rounding of the sums. */
bool fg_circle_arc_polish(const fg_circle_scaled *scaled, fg_circle_arc *arc) {
  double damping = 0, before = INFINITY;
  *arc = fg_circle_arc_rebase(arc);
  for (int iteration = 0; iteration < 200; iteration++) {
    normal_equations sums;
    gather_equations(scaled, arc, &sums);
    double size = make_step(scaled, &sums, arc, &damping);
    if (size < 0) return before < 1e-8;
    if (size < 4 * DBL_EPSILON) return true;
    if (damping == 0 && size < 1e-9 && size >= 0.5 * before) return true;
    before = size;
    damping = damping < 1e-5 ? 0 : damping / 10;
  }
  return false;
}

/* Centre = q + shift n + n(theta) / k, R = 1 / k: their derivatives by bend, turn and shift, in the
 * points' axes. All in the scaled points' unit, which cancels: residuals are in it as well. */
static void derivatives_of_circle(const fg_circle_scaled *scaled, const fg_circle_arc *arc,
                                  double derivative[3][3]) {
  double radius = 1 / arc->curvature, square = radius * radius;
  double x[3] = {-square * arc->nx, radius * arc->ny, arc->nx};
  double y[3] = {-square * arc->ny, -radius * arc->nx, arc->ny};
  for (int i = 0; i < 3; i++) {
    derivative[0][i] = x[i] * scaled->axis_x - y[i] * scaled->axis_y;
    derivative[1][i] = x[i] * scaled->axis_y + y[i] * scaled->axis_x;
    derivative[2][i] = i == BEND ? -square : 0;
  }
}

bool fg_circle_arc_covariance(const fg_circle_scaled *scaled, const fg_circle_arc *arc,
                              double covariance[3][3]) {
  normal_equations sums;
  double factor[3][3], derivative[3][3];
  gather_equations(scaled, arc, &sums);
  const double diagonal[3] = {sums.gauss[0][0], sums.gauss[1][1], sums.gauss[2][2]};
  if (!factorise_scaled(sums.gauss, diagonal, 0, factor)) return false;
  derivatives_of_circle(scaled, arc, derivative);
  for (int j = 0; j < 3; j++) {
    double solution[3];
    solve_factored(factor, diagonal, derivative[j], solution);
    for (int i = 0; i < 3; i++) {
      covariance[i][j] = 0;
      for (int k = 0; k < 3; k++)
        covariance[i][j] += derivative[i][k] * solution[k];
      covariance[i][j] /= scaled->weight_sum;
    }
  }
  return true;
}

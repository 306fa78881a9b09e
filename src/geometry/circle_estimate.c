/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>

#include "geometry/circle_scaled.h"

/* The hyper fit (Al-Sharadqah and Chernov 2009) minimises the mean of
 * (A z + B x + C y + D)², z = x² + y², under A'NA = 1, where N removes the essential bias:
 *
 *     N = | 8<z> 4<x> 4<y> 2 |    M a = eta N a,  M the matrix of moments of (z, x, y, 1),
 *         | 4<x>  1    0   0 |    a = (A, B, C, D), eta the smallest value that is not negative.
 *         | 4<y>  0    1   0 |
 *         |  2    0    0   0 |
 *
 * Scaled, <x> = <y> = <xy> = 0. The last row gives D = A (2 eta - <z>), the middle rows
 * B = -A <xz> / (<xx> - eta) and C = -A <yz> / (<yy> - eta); the first row is then one equation,
 *
 *     g(eta) = var(z) - 4 eta <z> - 4 eta² - <xz>² / (<xx> - eta) - <yz>² / (<yy> - eta) = 0,
 *
 * which falls from g(0) >= 0 (a Schur complement) on 0 <= eta < <yy>: one root, easily bracketed.
 * Centre = -(B, C) / 2A, R² = |centre|² - D / A. */
typedef struct moments {
  double z, xx, yy, xz, yz, variance_z;
} moments;

static moments compute_moments(const fg_circle_scaled *scaled) {
  moments m = {0};
  for (size_t i = 0; i < scaled->count; i++) {
    double x = scaled->x[i], y = scaled->y[i], w = scaled->weight[i];
    m.xx += w * x * x;
    m.yy += w * y * y;
  }
  m.z = m.xx + m.yy;
  for (size_t i = 0; i < scaled->count; i++) {
    double x = scaled->x[i], y = scaled->y[i], w = scaled->weight[i];
    double z = x * x + y * y - m.z;
    m.xz += w * x * z;
    m.yz += w * y * z;
    m.variance_z += w * z * z;
  }
  return m;
}

static double characteristic_value(const moments *m, double eta, double *slope) {
  double p = m->xz / (m->xx - eta), q = m->yz / (m->yy - eta);
  *slope = -4 * m->z - 8 * eta - p * p - q * q;
  return m->variance_z - 4 * eta * (m->z + eta) - p * m->xz - q * m->yz;
}

/* Newton from the left, bisection wherever it leaves the bracket. */
static double smallest_eta(const moments *m) {
  double low = 0, high = m->yy, eta = 0;
  for (int i = 0; i < 100; i++) {
    double slope, value = characteristic_value(m, eta, &slope);
    if (value > 0)
      low = eta;
    else
      high = eta;
    double next = eta - value / slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (fabs(next - eta) <= 1e-16 * m->yy) break;
    eta = next;
  }
  return eta;
}

fg_status fg_circle_estimate_scaled(fg_context *ctx, const fg_circle_scaled *scaled,
                                    fg_circle *circle) {
  moments m = compute_moments(scaled);
  double eta = smallest_eta(&m);
  double x = m.xz / (2 * (m.xx - eta)), y = m.yz / (2 * (m.yy - eta));
  double radius = sqrt(x * x + y * y + m.z - 2 * eta);
  if (!(radius < 1 / FG_CIRCLE_FLAT) || !(radius > 0))
    return fg_fail(ctx, FG_ERR_NUMERIC, "circle fit: a line fits better than any circle");
  *circle = (fg_circle){x, y, radius};
  return FG_OK;
}

fg_status fg_circle_estimate(fg_context *ctx, const fg_point *points, const double *weights,
                             size_t count, fg_circle *circle) {
  fg_circle_scaled scaled;
  fg_circle local;
  FG_TRY(fg_circle_scale_points(ctx, points, weights, count, &scaled));
  fg_status status = fg_circle_estimate_scaled(ctx, &scaled, &local);
  if (status == FG_OK) *circle = fg_circle_out_of_scaled(&scaled, &local);
  fg_circle_scaled_free(&scaled);
  return status;
}

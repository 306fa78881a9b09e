/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clearance around a bearing; see foilgauge/bearing.h. */
#include <math.h>

#include "bearing/places.h"

static const double rad_per_deg = 3.14159265358979323846 / 180;

double fg_bearing_pitch_deg(const fg_bearing_layout *layout) {
  if (layout->pitch_deg > 0) return layout->pitch_deg;
  return 360 / (double)(layout->pads * layout->bumps_per_pad);
}

double fg_bearing_angle_deg(const fg_bearing_layout *layout, size_t pad, size_t bump) {
  return 360 * (double)pad / (double)layout->pads + (double)bump * fg_bearing_pitch_deg(layout);
}

bool fg_places_solve(double a[3][3], const double b[3], double x[3]) {
  double minor[3] = {a[1][1] * a[2][2] - a[1][2] * a[2][1], a[1][2] * a[2][0] - a[1][0] * a[2][2],
                     a[1][0] * a[2][1] - a[1][1] * a[2][0]};
  double determinant = a[0][0] * minor[0] + a[0][1] * minor[1] + a[0][2] * minor[2];
  if (fabs(determinant) < 1e-9) return false;
  for (int k = 0; k < 3; k++) {
    double m[3][3];
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        m[i][j] = j == k ? b[i] : a[i][j];
    x[k] = (m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
            m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
            m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])) /
           determinant;
  }
  return true;
}

/* By how much each of the results moves with the clearance of every known place. */
typedef struct gradients {
  double normal[3][3];                /* of the least-squares circle */
  size_t min, max, low, high;         /* extremes, of the clearances and about the circle */
  size_t touched[3];                  /* by the centred rotor */
  double slope[FG_BEARING_BUMPS_MAX]; /* of the one that is looked at */
} gradients;

/* Least squares of c = mean + a cos + b sin (the limaçon of roundness measurement). */
static void fit_circle(const fg_places *p, gradients *g, fg_bearing_clearance *result) {
  double right[3] = {0}, x[3];
  for (size_t i = 0; i < p->count; i++) {
    const double row[3] = {1, p->x[i], p->y[i]};
    for (int j = 0; j < 3; j++) {
      for (int k = 0; k < 3; k++)
        g->normal[j][k] += row[j] * row[k];
      right[j] += row[j] * p->clearance[i];
    }
  }
  result->circularity_mm = result->offset_mm[0] = result->offset_mm[1] = NAN;
  if (!fg_places_solve(g->normal, right, x)) return;
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < p->count; i++) {
    double left = fg_places_shifted(p, i, x[1], x[2]);
    if (left < low) g->low = i;
    if (left > high) g->high = i;
    low = fmin(low, left);
    high = fmax(high, left);
  }
  result->offset_mm[0] = x[1];
  result->offset_mm[1] = x[2];
  result->circularity_mm = high - low;
}

static void find_extremes(const fg_places *p, const double *angle_deg, gradients *g,
                          fg_bearing_clearance *result) {
  result->min_mm = INFINITY;
  result->max_mm = -INFINITY;
  for (size_t i = 0; i < p->count; i++) {
    result->mean_mm += p->clearance[i] / (double)p->count;
    if (p->clearance[i] < result->min_mm) g->min = i;
    if (p->clearance[i] > result->max_mm) g->max = i;
    result->min_mm = p->clearance[g->min];
    result->max_mm = p->clearance[g->max];
  }
  result->min_at_deg = angle_deg[p->given[g->min]];
}

/* High minus low about the circle: the circle moves with every clearance, too. */
static bool slope_of_circularity(const fg_places *p, gradients *g) {
  const double apart[3] = {0, p->x[g->high] - p->x[g->low], p->y[g->high] - p->y[g->low]};
  double y[3];
  if (!fg_places_solve(g->normal, apart, y)) return false;
  for (size_t i = 0; i < p->count; i++)
    g->slope[i] = -(y[0] + y[1] * p->x[i] + y[2] * p->y[i]);
  g->slope[g->high] += 1;
  g->slope[g->low] -= 1;
  return true;
}

static void slope_of_one(const fg_places *p, size_t at, gradients *g) {
  for (size_t i = 0; i < p->count; i++)
    g->slope[i] = i == at;
}

/* The weights of the three places that the rotor touches: they sum to 1, and balance. */
static bool slope_of_centred(const fg_places *p, gradients *g) {
  static const double axis[3] = {1, 0, 0};
  double a[3][3], w[3];
  for (int i = 0; i < 3; i++) {
    a[0][i] = 1;
    a[1][i] = p->x[g->touched[i]];
    a[2][i] = p->y[g->touched[i]];
  }
  if (!fg_places_solve(a, axis, w)) return false;
  for (size_t i = 0; i < p->count; i++)
    g->slope[i] = 0;
  for (int i = 0; i < 3; i++)
    g->slope[g->touched[i]] += w[i];
  return true;
}

static double propagate(const fg_places *p, const gradients *g,
                        const fg_bearing_uncertainty *uncertainty) {
  double shared = 0, apart = 0, together = 0, of_pad[FG_BEARING_BUMPS_MAX] = {0};
  for (size_t i = 0; i < p->count; i++) {
    size_t at = p->given[i];
    double own = g->slope[i] * uncertainty->own_mm[at];
    shared += g->slope[i] * uncertainty->shared_mm[at];
    apart += own * own;
    of_pad[uncertainty->pad[at]] += own;
  }
  for (size_t i = 0; i < FG_BEARING_BUMPS_MAX; i++)
    together += of_pad[i] * of_pad[i];
  return sqrt(shared * shared + fmax(apart, together));
}

static void find_all_uncertainties(const fg_places *p, gradients *g, bool centred,
                                   const fg_bearing_uncertainty *uncertainty,
                                   fg_bearing_clearance *result) {
  slope_of_one(p, g->min, g);
  result->u_min_mm = propagate(p, g, uncertainty);
  slope_of_one(p, g->max, g);
  result->u_max_mm = propagate(p, g, uncertainty);
  for (size_t i = 0; i < p->count; i++)
    g->slope[i] = 1 / (double)p->count;
  result->u_mean_mm = propagate(p, g, uncertainty);
  if (isfinite(result->circularity_mm) && slope_of_circularity(p, g))
    result->u_circularity_mm = propagate(p, g, uncertainty);
  if (centred && slope_of_centred(p, g)) result->u_centred_min_mm = propagate(p, g, uncertainty);
}

fg_status fg_bearing_assess_uncertainty(fg_context *ctx, const double *angle_deg,
                                        const double *clearance_mm, size_t count,
                                        const fg_bearing_uncertainty *uncertainty,
                                        fg_bearing_clearance *result) {
  fg_places p = {.count = 0};
  gradients g = {.min = 0};
  *result = (fg_bearing_clearance){.u_mean_mm = NAN,
                                   .u_min_mm = NAN,
                                   .u_max_mm = NAN,
                                   .u_circularity_mm = NAN,
                                   .u_centred_min_mm = NAN};
  if (count > FG_BEARING_BUMPS_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "%zu bumps around a bearing; at most %d", count,
                   FG_BEARING_BUMPS_MAX);
  for (size_t i = 0; i < count; i++) {
    if (!isfinite(clearance_mm[i])) continue;
    p.clearance[p.count] = clearance_mm[i];
    p.given[p.count] = i;
    p.x[p.count] = cos(angle_deg[i] * rad_per_deg);
    p.y[p.count++] = sin(angle_deg[i] * rad_per_deg);
  }
  if (p.count < 3)
    return fg_fail(ctx, FG_ERR_DATA, "%zu known clearances; a bearing needs three at least",
                   p.count);
  result->count = p.count;
  find_extremes(&p, angle_deg, &g, result);
  fit_circle(&p, &g, result);
  bool centred = fg_places_centre(&p, g.touched, result);
  if (uncertainty) find_all_uncertainties(&p, &g, centred, uncertainty, result);
  return FG_OK;
}

fg_status fg_bearing_assess(fg_context *ctx, const double *angle_deg, const double *clearance_mm,
                            size_t count, fg_bearing_clearance *result) {
  return fg_bearing_assess_uncertainty(ctx, angle_deg, clearance_mm, count, NULL, result);
}

/* Clearance around a bearing; see foilgauge/bearing.h. */
#include <math.h>

#include "foilgauge/bearing.h"

static const double rad_per_deg = 3.14159265358979323846 / 180;

/* Known places: clearance and direction. */
typedef struct places {
  double clearance[FG_BEARING_BUMPS_MAX];
  double x[FG_BEARING_BUMPS_MAX], y[FG_BEARING_BUMPS_MAX];
  size_t count;
} places;

double fg_bearing_pitch_deg(const fg_bearing_layout *layout) {
  if (layout->pitch_deg > 0) return layout->pitch_deg;
  return 360 / (double)(layout->pads * layout->bumps_per_pad);
}

double fg_bearing_angle_deg(const fg_bearing_layout *layout, size_t pad, size_t bump) {
  return 360 * (double)pad / (double)layout->pads + (double)bump * fg_bearing_pitch_deg(layout);
}

/* Solves three equations by Cramer's rule; false when they say too little. */
static bool solve_three(double a[3][3], const double b[3], double x[3]) {
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

static double shifted(const places *p, size_t i, double a, double b) {
  return p->clearance[i] - a * p->x[i] - b * p->y[i];
}

static double least_shifted(const places *p, double a, double b) {
  double least = INFINITY;
  for (size_t i = 0; i < p->count; i++)
    least = fmin(least, shifted(p, i, a, b));
  return least;
}

/* Least squares of c = mean + a cos + b sin (the limaçon of roundness measurement). */
static void fit_circle(const places *p, fg_bearing_clearance *result) {
  double normal[3][3] = {{0}}, right[3] = {0}, x[3];
  for (size_t i = 0; i < p->count; i++) {
    const double row[3] = {1, p->x[i], p->y[i]};
    for (int j = 0; j < 3; j++) {
      for (int k = 0; k < 3; k++)
        normal[j][k] += row[j] * row[k];
      right[j] += row[j] * p->clearance[i];
    }
  }
  result->circularity_mm = result->offset_mm[0] = result->offset_mm[1] = NAN;
  if (!solve_three(normal, right, x)) return;
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < p->count; i++) {
    double left = shifted(p, i, x[1], x[2]);
    low = fmin(low, left);
    high = fmax(high, left);
  }
  result->offset_mm[0] = x[1];
  result->offset_mm[1] = x[2];
  result->circularity_mm = high - low;
}

/* Whether every half plane holds a crown: else a rotor could move away without end. */
static bool surrounded(const places *p) {
  for (size_t i = 0; i < p->count; i++) {
    bool left = false, right = false;
    for (size_t j = 0; j < p->count; j++) {
      double cross = p->x[i] * p->y[j] - p->y[i] * p->x[j];
      left = left || cross > 1e-9;
      right = right || cross < -1e-9;
    }
    if (!left || !right) return false;
  }
  return true;
}

/* The largest m with m <= c_i - a x_i - b y_i for all i is reached where three of them are equal:
 * of the rotor positions that touch three crowns alike, the one with the most room. */
static bool touch_three(const places *p, const size_t index[3], double x[3]) {
  double a[3][3], b[3];
  for (int i = 0; i < 3; i++) {
    a[i][0] = 1;
    a[i][1] = p->x[index[i]];
    a[i][2] = p->y[index[i]];
    b[i] = p->clearance[index[i]];
  }
  return solve_three(a, b, x);
}

static void consider(const places *p, const size_t index[3], fg_bearing_clearance *result) {
  double x[3];
  if (!touch_three(p, index, x)) return;
  double least = least_shifted(p, x[1], x[2]);
  if (isfinite(result->centred_least_mm) && least <= result->centred_least_mm) return;
  result->centred_least_mm = least;
  result->centred_at_mm[0] = x[1];
  result->centred_at_mm[1] = x[2];
}

static void centre_rotor(const places *p, fg_bearing_clearance *result) {
  result->centred_least_mm = result->centred_at_mm[0] = result->centred_at_mm[1] = NAN;
  if (!surrounded(p)) return;
  for (size_t i = 0; i < p->count; i++)
    for (size_t j = i + 1; j < p->count; j++)
      for (size_t k = j + 1; k < p->count; k++)
        consider(p, (const size_t[]){i, j, k}, result);
}

static void find_extremes(const double *angle_deg, const double *clearance_mm, size_t count,
                          fg_bearing_clearance *result) {
  result->least_mm = INFINITY;
  result->most_mm = -INFINITY;
  for (size_t i = 0; i < count; i++) {
    if (!isfinite(clearance_mm[i])) continue;
    result->mean_mm += clearance_mm[i] / (double)result->count;
    result->most_mm = fmax(result->most_mm, clearance_mm[i]);
    if (!(clearance_mm[i] < result->least_mm)) continue;
    result->least_mm = clearance_mm[i];
    result->least_at_deg = angle_deg[i];
  }
}

fg_status fg_bearing_assess(fg_context *ctx, const double *angle_deg, const double *clearance_mm,
                            size_t count, fg_bearing_clearance *result) {
  places p = {.count = 0};
  *result = (fg_bearing_clearance){0};
  if (count > FG_BEARING_BUMPS_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "%zu bumps around a bearing; at most %d", count,
                   FG_BEARING_BUMPS_MAX);
  for (size_t i = 0; i < count; i++) {
    if (!isfinite(clearance_mm[i])) continue;
    p.clearance[p.count] = clearance_mm[i];
    p.x[p.count] = cos(angle_deg[i] * rad_per_deg);
    p.y[p.count++] = sin(angle_deg[i] * rad_per_deg);
  }
  if (p.count < 3)
    return fg_fail(ctx, FG_ERR_DATA, "%zu known clearances; a bearing needs three at least",
                   p.count);
  result->count = p.count;
  find_extremes(angle_deg, clearance_mm, count, result);
  fit_circle(&p, result);
  centre_rotor(&p, result);
  return FG_OK;
}

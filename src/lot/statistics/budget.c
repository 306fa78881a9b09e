/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Causes of the spread of a lot's stiffness. */
#include <math.h>

#include "lot/statistics/budget.h"

static const double rad_per_deg = 3.14159265358979323846 / 180;

double fg_bump_stiffness_variance(const fg_overall *overall, const fg_bump *bump,
                                  const fg_arch_sensitivity *sensitivity) {
  double x = bump->centre_to_centre_mm, r = bump->radius_mm, r0 = overall->radius_mm;
  double u_x = bump->u_centre_to_centre_mm, u_r = bump->u_radius_mm, u_h = bump->u_height_mm;
  double alpha = bump->bump_angle_deg * rad_per_deg, u_alpha = bump->u_bump_angle_deg * rad_per_deg;
  /* cos(alpha / 2) = (X² + R² - R0²) / (2 X R) */
  double outer = -2 / sin(alpha / 2);
  double by_x = outer * (x * x - r * r + r0 * r0) / (2 * x * x * r);
  double by_r = outer * (r * r - x * x + r0 * r0) / (2 * r * r * x);
  double with_x = (u_x * u_x + u_r * u_r - u_h * u_h) / 2;
  with_x = fmax(-u_x * u_r, fmin(u_x * u_r, with_x));
  double with_alpha = by_r * u_r * u_r + by_x * with_x;
  with_alpha = fmax(-u_r * u_alpha, fmin(u_r * u_alpha, with_alpha));
  double a = sensitivity->radius / r, b = sensitivity->angle / alpha;
  double variance = a * a * u_r * u_r + b * b * u_alpha * u_alpha + 2 * a * b * with_alpha;
  return variance < 0 ? 0 : variance;
}

typedef struct moments {
  double mean_x, mean_y, xx, yy, xy;
  size_t count;
} moments;

/* Moments of the pairs whose values are both known. */
static moments find_moments(const double *x, const double *y, size_t count) {
  moments m = {0};
  for (size_t i = 0; i < count; i++) {
    if (!isfinite(x[i]) || !isfinite(y[i])) continue;
    double dx = x[i] - m.mean_x, dy = y[i] - m.mean_y, n = (double)++m.count;
    m.mean_x += dx / n;
    m.mean_y += dy / n;
    m.xx += dx * (x[i] - m.mean_x);
    m.yy += dy * (y[i] - m.mean_y);
    m.xy += dx * (y[i] - m.mean_y);
  }
  return m;
}

static double relative_pct(double squares, size_t count, double mean) {
  return count > 1 ? 100 * sqrt(squares / (double)(count - 1)) / mean : NAN;
}

static double known_or_0(double value) {
  return isfinite(value) ? value : 0;
}

static double measurement_pct(const fg_bump_columns *columns) {
  moments m = find_moments(columns->measurement, columns->measurement, columns->count);
  return m.count ? 100 * sqrt(m.mean_x) : NAN;
}

enum { CAUSES = 3, SUBSETS = 1 << CAUSES };

/* Collinear cause: one that keeps less than this of its variance beside the others. */
static const double COLLINEAR = 1e-9;

/* Returns the share of y's variance that the causes of `subset` explain, by elimination on the
 * correlations `r`. The last row and column are y's; y is a combination of the causes. */
static double find_explained_share(const double r[CAUSES + 1][CAUSES + 1], int subset) {
  double m[CAUSES + 1][CAUSES + 1];
  for (int i = 0; i <= CAUSES; i++)
    for (int j = 0; j <= CAUSES; j++)
      m[i][j] = r[i][j];
  for (int k = 0; k < CAUSES; k++) {
    double pivot = m[k][k];
    if (!(subset >> k & 1) || !(pivot > COLLINEAR)) continue;
    for (int i = 0; i <= CAUSES; i++) {
      double factor = m[i][k] / pivot;
      for (int j = 0; j <= CAUSES && i != k; j++)
        m[i][j] -= factor * m[k][j];
    }
  }
  return fmin(1, fmax(0, 1 - m[CAUSES][CAUSES]));
}

/* Weights of a subset of `size` others that enters before: size! (CAUSES - 1 - size)! / CAUSES!. */
static const double order_weight[CAUSES] = {1.0 / 3, 1.0 / 6, 1.0 / 3};

static void find_shares(const fg_bump_columns *columns, bool thickness, fg_lot_budget *budget) {
  const double *const column[CAUSES + 1] = {columns->arch_radius, columns->arch_length,
                                            columns->thickness, columns->ratio[0]};
  fg_lot_budget_term *const term[CAUSES] = {&budget->radius, &budget->arc_length,
                                            &budget->thickness};
  double r[CAUSES + 1][CAUSES + 1], all = 0;
  for (int i = 0; i <= CAUSES; i++)
    for (int j = 0; j <= CAUSES; j++) {
      moments m = find_moments(column[i], column[j], columns->count);
      r[i][j] = m.xx > 0 && m.yy > 0 ? m.xy / sqrt(m.xx * m.yy) : 0;
    }
  for (int k = 0; k < CAUSES; k++) {
    term[k]->share_pct = 0;
    for (int subset = 0; subset < SUBSETS; subset++) {
      if (subset >> k & 1) continue;
      int size = (subset & 1) + (subset >> 1 & 1) + (subset >> 2 & 1);
      double gain = find_explained_share((const double(*)[CAUSES + 1]) r, subset | 1 << k) -
                    find_explained_share((const double(*)[CAUSES + 1]) r, subset);
      term[k]->share_pct += 100 * order_weight[size] * fmax(0, gain);
    }
    all += term[k]->share_pct;
  }
  budget->rest_share_pct = fmax(0, 100 - all);
  if (!thickness) budget->thickness.share_pct = NAN;
}

void fg_lot_analyse_budget(fg_lot_analysis *analysis, const fg_bump_columns *columns) {
  fg_lot_budget *budget = &analysis->stiffness.budget;
  const fg_arch_sensitivity *slope =
      &analysis->stiffness.cases[FG_LOT_CASE_MEAN].by_model[0].sensitivity;
  moments m = find_moments(columns->arch_radius, columns->arch_length, columns->count);
  moments t = find_moments(columns->strip, columns->strip, columns->count);
  budget->radius = (fg_lot_budget_term){relative_pct(m.xx, m.count, m.mean_x),
                                        slope->radius_at_arc_length, NAN, NAN};
  budget->arc_length =
      (fg_lot_budget_term){relative_pct(m.yy, m.count, m.mean_y), slope->angle, NAN, NAN};
  budget->thickness = (fg_lot_budget_term){
      analysis->thickness.foils > 1 ? relative_pct(t.xx, t.count, t.mean_x) : NAN, slope->thickness,
      NAN, NAN};
  fg_lot_budget_term *const terms[] = {&budget->radius, &budget->arc_length, &budget->thickness};
  for (size_t i = 0; i < sizeof terms / sizeof *terms; i++) {
    terms[i]->variance_pct2 = pow(terms[i]->sensitivity * terms[i]->spread_pct, 2);
    budget->sum_pct2 += known_or_0(terms[i]->variance_pct2);
  }
  budget->correlation = m.xy / sqrt(m.xx * m.yy);
  budget->together_pct2 = 2 * budget->correlation * budget->radius.spread_pct *
                          budget->radius.sensitivity * budget->arc_length.spread_pct *
                          budget->arc_length.sensitivity;
  budget->sum_pct2 += known_or_0(budget->together_pct2);
  budget->observed_pct = analysis->stiffness.measured.relative_sd_pct;
  budget->unexplained_pct2 = pow(budget->observed_pct, 2) - budget->sum_pct2;
  budget->measurement_pct = measurement_pct(columns);
  budget->parts_pct =
      sqrt(fmax(0, pow(budget->observed_pct, 2) - pow(known_or_0(budget->measurement_pct), 2)));
  find_shares(columns, analysis->thickness.foils > 1, budget);
  budget->known = true;
}

#include "station/check_fit.h"

#include <math.h>

#include "core/small_solve.h"
#include "core/text.h"

/* A disc is of a known diameter when it is this near to it: scanners are out by 0.6 % at most
 * (two that were measured), holes of a plate differ by more. */
#define SAME_DIAMETER  0.03
#define COVERAGE_LEAST 300.0 /* degrees: an arc says little of two axes */

enum { SCALE_X, SCALE_Y, SHEAR, CENTRE_X, CENTRE_Y, UNKNOWNS, OF_SCANNER = SHEAR + 1 };

/* What one disc says, and with what variance. */
typedef struct says {
  double value[OF_SCANNER], variance[OF_SCANNER];
} says;

static double known_diameter(const fg_design *design, const fg_disc *disc) {
  double best = NAN;
  for (size_t i = 0; i < design->diameter_count; i++) {
    double known = design->diameters_mm[i];
    bool nearer = isnan(best) || fabs(known - disc->diameter_mm) < fabs(best - disc->diameter_mm);
    if (nearer && fabs(known - disc->diameter_mm) < SAME_DIAMETER * known) best = known;
  }
  return best;
}

/* The edge points of one disc against its known radius; its centre is fitted along. */
static bool fit_disc(const fg_disc *disc, double radius_mm, says *result) {
  fg_normal_equations system;
  double x[UNKNOWNS], inverse[FG_SMALL_MAX][FG_SMALL_MAX], squares = 0;
  fg_normal_clear(&system, UNKNOWNS);
  for (size_t i = 0; i < disc->points; i++) {
    double dx = disc->edge[i].x - disc->centre_mm.x, dy = disc->edge[i].y - disc->centre_mm.y;
    double r = hypot(dx, dy), c = dx / r, s = dy / r;
    const double row[UNKNOWNS] = {radius_mm * c * c, radius_mm * s * s, radius_mm * s * c, c, s};
    fg_normal_add(&system, row, r - radius_mm, 1);
  }
  if (disc->points <= UNKNOWNS || !fg_normal_solve(&system, 0, x, inverse)) return false;
  squares = system.sum_squares;
  for (int k = 0; k < UNKNOWNS; k++)
    squares -= x[k] * system.right[k];
  double noise = fmax(squares, 0) / (double)(disc->points - UNKNOWNS);
  /* The edge's noise is correlated, and its level in doubt: what the disc's own fit says of that
   * is the least that is left. */
  double own = pow(disc->u_radius_mm / radius_mm, 2) + pow(disc->level_doubt_mm / radius_mm, 2);
  for (int k = 0; k < OF_SCANNER; k++) {
    result->value[k] = x[k];
    result->variance[k] = fmax(noise * inverse[k][k], own);
  }
  return true;
}

/* Weighted mean; where discs differ by more than they say, by that (Birge's ratio). */
static void combine(const says *discs, size_t count, int k, double *value, double *u) {
  double weights = 0, sum = 0, chi2 = 0;
  for (size_t i = 0; i < count; i++) {
    weights += 1 / discs[i].variance[k];
    sum += discs[i].value[k] / discs[i].variance[k];
  }
  *value = sum / weights;
  for (size_t i = 0; i < count; i++)
    chi2 += pow(discs[i].value[k] - *value, 2) / discs[i].variance[k];
  double birge = count > 1 ? fmax(1, chi2 / (double)(count - 1)) : 1;
  *u = sqrt(birge / weights);
}

fg_status fg_check_fit_plate(fg_context *ctx, const fg_design *design,
                             const fg_measurement *measurement, fg_check_fit *fit) {
  enum { DISCS_MAX = 256 };
  says discs[DISCS_MAX];
  *fit = (fg_check_fit){0};
  for (size_t i = 0; i < measurement->disc_count && fit->discs < DISCS_MAX; i++) {
    const fg_disc *disc = &measurement->discs[i];
    double diameter = known_diameter(design, disc);
    if (isnan(diameter) || disc->coverage_deg < COVERAGE_LEAST) continue;
    fit->discs += fit_disc(disc, diameter / 2, &discs[fit->discs]);
  }
  if (!fit->discs)
    return fg_fail(ctx, FG_ERR_NOT_MEASURED,
                   "none of %zu discs in the scan has one of the %zu known diameters",
                   measurement->disc_count, design->diameter_count);
  for (int k = 0; k < 2; k++)
    combine(discs, fit->discs, k, &fit->scale[k], &fit->u_scale[k]);
  combine(discs, fit->discs, SHEAR, &fit->shear, &fit->u_shear);
  return FG_OK;
}

void fg_check_fit_judge(fg_check_fit *fit, double scale_max_ppm, char *words, size_t size) {
  double worst = 0;
  for (int k = 0; k < 2; k++)
    worst = fmax(worst, 1e6 * (fabs(fit->scale[k]) + 2 * fit->u_scale[k]));
  worst = fmax(worst, 1e6 * (fabs(fit->shear) + 2 * fit->u_shear));
  fit->passes = worst <= scale_max_ppm;
  fg_text_clip(words, size,
               "scanner %s: %zu discs, x %+.0f ± %.0f ppm, y %+.0f ± %.0f ppm, shear %+.0f ± %.0f "
               "µrad; allowed %.0f",
               fit->passes ? "in order" : "out of order", fit->discs, 1e6 * fit->scale[0],
               2e6 * fit->u_scale[0], 1e6 * fit->scale[1], 2e6 * fit->u_scale[1], 1e6 * fit->shear,
               2e6 * fit->u_shear, scale_max_ppm);
}

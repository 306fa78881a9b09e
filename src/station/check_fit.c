/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/check_fit.h"

#include <math.h>
#include <string.h>

#include "core/small_solve.h"
#include "core/text.h"

/* A disc is of a known diameter when it is this near to it: scanners are out by 0.6 % at most
 * (two that were measured), holes of a plate differ by more. */
#define SAME_DIAMETER 0.03
#define COVERAGE_MIN  300.0 /* degrees: an arc says little of two axes */

/* Variance of 1/radius over its mean square: radii of 1 and 1.03 mm have 0.0002. */
#define LEVEL_SEPARATED 1e-3

/* Stretches of an edge, and the fewest points that are enough for as many. */
enum { BLOCKS = 24, POINTS_MIN = 4 * BLOCKS };
/* Scale of x and y as their mean and half their difference: around a whole circle the five are
 * independent of each other, and the level of the edge moves the mean alone. */
enum { MEAN, DIFFERENCE, SHEAR, CENTRE_X, CENTRE_Y, UNKNOWNS, OF_SCANNER = SHEAR + 1 };

/* Indications of one disc with the variance of its noise; the move of the mean scale with the
 * edges' level, per mm of the edge; and the uncertainty of that level in mm. */
typedef struct says {
  double value[OF_SCANNER], variance[OF_SCANNER], level, u_mm_of_level;
} says;

static double known_diameter(const fg_design *design, const fg_disc *disc) {
  double best = NAN;
  for (size_t i = 0; i < design->discs.count; i++) {
    double known = design->discs.diameters_mm[i];
    bool nearer = isnan(best) || fabs(known - disc->diameter_mm) < fabs(best - disc->diameter_mm);
    if (nearer && fabs(known - disc->diameter_mm) < SAME_DIAMETER * known) best = known;
  }
  return best;
}

/* The radius of an edge point less the known one is row · unknowns, in mm. */
static double fill_row(const fg_disc *disc, size_t i, double radius_mm, double row[UNKNOWNS]) {
  double dx = disc->edge[i].x - disc->centre_mm.x, dy = disc->edge[i].y - disc->centre_mm.y;
  double r = hypot(dx, dy), c = dx / r, s = dy / r;
  row[MEAN] = radius_mm;
  row[DIFFERENCE] = radius_mm * (c * c - s * s);
  row[SHEAR] = radius_mm * s * c;
  row[CENTRE_X] = c;
  row[CENTRE_Y] = s;
  return r - radius_mm;
}

/* Neighbouring points of an edge err together, and holes are not quite round: what counts is the
 * variance that means of whole stretches of the edge have, taken to a point. */
static double slow_variance(const fg_disc *disc, double radius_mm, const double *x) {
  double sums[BLOCKS] = {0}, counts[BLOCKS] = {0}, squares = 0, total = 0;
  for (size_t i = 0; i < disc->points; i++) {
    double row[UNKNOWNS], residual = fill_row(disc, i, radius_mm, row);
    size_t block = i * BLOCKS / disc->points;
    for (int k = 0; k < UNKNOWNS; k++)
      residual -= row[k] * x[k];
    squares += residual * residual;
    sums[block] += residual;
    counts[block]++;
  }
  for (int b = 0; b < BLOCKS; b++)
    total += sums[b] * sums[b] / counts[b];
  return fmax(squares / (double)(disc->points - UNKNOWNS), total / (BLOCKS - UNKNOWNS));
}

/* The edge points of one disc against its known radius; its centre is fitted along. */
static bool fit_disc(const fg_disc *disc, double radius_mm, says *result) {
  fg_normal_equations system;
  double row[UNKNOWNS], x[UNKNOWNS], inverse[FG_SMALL_MAX][FG_SMALL_MAX];
  if (disc->points < POINTS_MIN) return false;
  fg_normal_clear(&system, UNKNOWNS);
  for (size_t i = 0; i < disc->points; i++) {
    double value = fill_row(disc, i, radius_mm, row);
    fg_normal_add(&system, row, value, 1);
  }
  if (!fg_normal_solve(&system, 0, x, inverse)) return false;
  double variance = slow_variance(disc, radius_mm, x);
  for (int k = 0; k < OF_SCANNER; k++) {
    result->value[k] = x[k];
    result->variance[k] = variance * inverse[k][k];
  }
  result->level = (disc->bright ? 1 : -1) / radius_mm;
  result->u_mm_of_level = disc->level_u_mm;
  return true;
}

/* Discs that differ by more than their noise have their variances widened by Birge's ratio. */
static double birge(double chi2, size_t count) {
  return count > 1 ? fmax(1, chi2 / (double)(count - 1)) : 1;
}

static void combine(const says *discs, size_t count, int k, double *value, double *variance) {
  double weights = 0, sum = 0, chi2 = 0;
  for (size_t i = 0; i < count; i++) {
    weights += 1 / discs[i].variance[k];
    sum += discs[i].value[k] / discs[i].variance[k];
  }
  *value = sum / weights;
  for (size_t i = 0; i < count; i++)
    chi2 += pow(discs[i].value[k] - *value, 2) / discs[i].variance[k];
  *variance = birge(chi2, count) / weights;
}

/* The mean scale m, and with it the level's error c, which all discs of a scan share and which is 0
 * within its doubt: disc i says m + level_i c. Discs of different sizes tell the two apart; of a
 * single ring the doubt stays in m. */
static void combine_mean(const says *discs, size_t count, double *value, double *variance) {
  double uncertainty = 0, ww = 0, wl = 0, wv = 0, lv = 0, chi2;
  for (size_t i = 0; i < count; i++)
    uncertainty += discs[i].u_mm_of_level / (double)count;
  double prior = 1 / fmax(uncertainty * uncertainty, 1e-18), ll = prior;
  for (size_t i = 0; i < count; i++) {
    const says *disc = &discs[i];
    double weight = 1 / disc->variance[MEAN];
    ww += weight;
    wl += weight * disc->level;
    ll += weight * disc->level * disc->level;
    wv += weight * disc->value[MEAN];
    lv += weight * disc->level * disc->value[MEAN];
  }
  double determinant = ww * ll - wl * wl, level = (ww * lv - wl * wv) / determinant;
  *value = (ll * wv - wl * lv) / determinant;
  chi2 = level * level * prior;
  for (size_t i = 0; i < count; i++)
    chi2 +=
        pow(discs[i].value[MEAN] - *value - level * discs[i].level, 2) / discs[i].variance[MEAN];
  *variance = birge(chi2, count) * ll / determinant;
}

/* The level's error without a prior: the discs alone tell it from the scale, by their sizes. */
static void find_level(const says *discs, size_t count, double *level_um, double *u_um) {
  double ww = 0, wl = 0, ll = 0, wv = 0, lv = 0, chi2 = 0;
  for (size_t i = 0; i < count; i++) {
    const says *disc = &discs[i];
    double weight = 1 / disc->variance[MEAN];
    ww += weight;
    wl += weight * disc->level;
    ll += weight * disc->level * disc->level;
    wv += weight * disc->value[MEAN];
    lv += weight * disc->level * disc->value[MEAN];
  }
  double determinant = ww * ll - wl * wl;
  *level_um = *u_um = NAN;
  if (!(determinant > LEVEL_SEPARATED * ww * ll)) return;
  double level = (ww * lv - wl * wv) / determinant, mean = (ll * wv - wl * lv) / determinant;
  for (size_t i = 0; i < count; i++)
    chi2 += pow(discs[i].value[MEAN] - mean - level * discs[i].level, 2) / discs[i].variance[MEAN];
  *level_um = 1000 * level;
  *u_um = 1000 * sqrt(birge(chi2, count - 1) * ww / determinant);
}

static void conclude(const says *discs, fg_check_fit *fit) {
  double mean, difference, of_mean, of_difference, of_shear;
  combine_mean(discs, fit->discs, &mean, &of_mean);
  combine(discs, fit->discs, DIFFERENCE, &difference, &of_difference);
  combine(discs, fit->discs, SHEAR, &fit->shear, &of_shear);
  fit->scale[0] = mean + difference;
  fit->scale[1] = mean - difference;
  fit->u_scale[0] = fit->u_scale[1] = sqrt(of_mean + of_difference);
  fit->u_shear = sqrt(of_shear);
  find_level(discs, fit->discs, &fit->level_um, &fit->u_level_um);
}

fg_status fg_check_fit_plate(fg_context *ctx, const fg_design *design,
                             const fg_measurement *measurement, fg_check_fit *fit) {
  enum { DISCS_MAX = 256 };
  says discs[DISCS_MAX];
  *fit = (fg_check_fit){.largest_um = NAN, .u_largest_um = NAN, .blur_um = NAN, .u_blur_um = NAN};
  for (size_t i = 0; i < measurement->disc_count && fit->discs < DISCS_MAX; i++) {
    const fg_disc *disc = &measurement->discs[i];
    double diameter = known_diameter(design, disc);
    if (isnan(diameter) || disc->coverage_deg < COVERAGE_MIN) continue;
    fit->discs += fit_disc(disc, diameter / 2, &discs[fit->discs]);
  }
  if (!fit->discs)
    return fg_fail(ctx, FG_ERR_NOT_MEASURED,
                   "none of %zu discs in the scan has one of the %zu known diameters",
                   measurement->disc_count, design->discs.count);
  conclude(discs, fit);
  return FG_OK;
}

/* The lattice has scale and shear of the scan; the largest residual shows what neither explains. */
fg_status fg_check_fit_grid(fg_context *ctx, const fg_design *design,
                            const fg_measurement *measurement, fg_check_fit *fit) {
  const fg_grid *grid = measurement->grid;
  *fit = (fg_check_fit){.is_grid = true, .level_um = NAN, .u_level_um = NAN};
  if (!isfinite(grid->step_mm[0].value) || !isfinite(grid->step_mm[1].value))
    return fg_fail(ctx, FG_ERR_NOT_MEASURED,
                   "lines show one axis: a check needs dots, a chessboard or crosses");
  /* Corners of one polarity lie two squares apart. */
  double pitch = design->grid.pitch_mm * (grid->squares_per_step == 2 ? 2 : 1);
  double u_pitch = design->grid.u_pitch_mm / design->grid.pitch_mm;
  for (int axis = 0; axis < 2; axis++) {
    fit->scale[axis] = grid->step_mm[axis].value / pitch - 1;
    fit->u_scale[axis] = hypot(grid->step_mm[axis].u / pitch, u_pitch);
  }
  fit->discs = grid->used;
  fit->shear = grid->shear.value;
  fit->u_shear = hypot(grid->shear.u, u_pitch);
  fit->largest_um = grid->largest_um;
  fit->u_largest_um = grid->mark_u_um;
  fit->blur_um = grid->blur_um;
  fit->u_blur_um = 0;
  return FG_OK;
}

void fg_check_fit_judge(fg_check_fit *fit, double scale_max_ppm, char *words, size_t size) {
  double worst = 0;
  for (int k = 0; k < 2; k++)
    worst = fmax(worst, 1e6 * (fabs(fit->scale[k]) + 2 * fit->u_scale[k]));
  worst = fmax(worst, 1e6 * (fabs(fit->shear) + 2 * fit->u_shear));
  fit->passes = worst <= scale_max_ppm;
  size_t used;
  fg_text_clip(words, size,
               "%s: %zu %s%s, x %+.0f ± %.0f ppm, y %+.0f ± %.0f ppm, shear %+.0f ± %.0f "
               "µrad; allowed %.0f",
               fit->passes ? FG_CHECK_IN_ORDER : "scanner out of order", fit->discs,
               fit->is_grid ? "mark" : "disc", fg_plural(fit->discs), 1e6 * fit->scale[0],
               2e6 * fit->u_scale[0], 1e6 * fit->scale[1], 2e6 * fit->u_scale[1], 1e6 * fit->shear,
               2e6 * fit->u_shear, scale_max_ppm);
  used = strlen(words);
  if (fit->is_grid)
    fg_text_clip(words + used, size - used, "; largest residual of a mark %.1f µm",
                 fit->largest_um);
}

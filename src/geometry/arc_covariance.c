/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Covariance of a fitted circle: noise correlated along the strip, deviations of whole ranges, and
 * errors of the edge model by the half width. */
#include "geometry/arcs.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

#include "core/small_solve.h"

/* Row of the Jacobian of the radial residual by (x, y, R). */
static void jacobian_row(const fg_datum_line *line, const fg_arc *arc, size_t station,
                         double row[3]) {
  double dx = line->points[station].x - arc->circle.x, dy = line->points[station].y - arc->circle.y;
  double d = sqrt(dx * dx + dy * dy);
  row[0] = dx / d;
  row[1] = dy / d;
  row[2] = 1;
}

static bool normal_inverse(const fg_datum_line *line, const fg_arc *arc,
                           double inverse[FG_SMALL_MAX][FG_SMALL_MAX]) {
  fg_normal_equations system;
  fg_normal_clear(&system, 3);
  double row[3], x[FG_SMALL_MAX];
  for (size_t i = 0; i < arc->range_count; i++)
    for (size_t k = arc->ranges[i].first; k <= arc->ranges[i].last; k++) {
      if (!fg_arc_used(line, arc, k)) continue;
      jacobian_row(line, arc, k, row);
      fg_normal_add(&system, row, 0, 1);
    }
  return fg_normal_solve(&system, 0, x, inverse);
}

/* Rows of the Jacobian of a block of stations and of those within the noise's reach after it; 0
 * where a station is not used. */
enum { BLOCK_STATIONS = 256, BLOCK_ROWS = BLOCK_STATIONS + FG_NOISE_LAGS };
typedef struct jacobian_block {
  size_t count; /* of rows */
  double x[BLOCK_ROWS], y[BLOCK_ROWS], radius[BLOCK_ROWS];
} jacobian_block;

static void fill_block(const fg_datum_line *line, const fg_arc *arc, size_t first, size_t last,
                       jacobian_block *block) {
  block->count = last - first + 1 < BLOCK_ROWS ? last - first + 1 : BLOCK_ROWS;
  for (size_t i = 0; i < block->count; i++) {
    double row[3] = {0};
    if (fg_arc_used(line, arc, first + i)) jacobian_row(line, arc, first + i, row);
    block->x[i] = row[0];
    block->y[i] = row[1];
    block->radius[i] = row[2];
  }
}

/* middle += the sum over pairs of stations, c(lag) x_i x_j', of the block's i-th and those after
 * it.
 */
static void add_pairs(const jacobian_block *block, size_t i, const fg_noise_model *noise,
                      double middle[3][3]) {
  const double a[3] = {block->x[i], block->y[i], block->radius[i]};
  double half = 0.5 * noise->covariance[0], sum[3] = {half * a[0], half * a[1], half * a[2]};
  for (size_t lag = 1; lag < noise->lags && i + lag < block->count; lag++) {
    sum[0] += noise->covariance[lag] * block->x[i + lag];
    sum[1] += noise->covariance[lag] * block->y[i + lag];
    sum[2] += noise->covariance[lag] * block->radius[i + lag];
  }
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      middle[p][q] += a[p] * sum[q] + a[q] * sum[p];
}

/* middle = sum over pairs of stations of one range, c(lag) x_i x_j'. */
static void add_correlated(const fg_datum_line *line, const fg_arc *arc,
                           const fg_noise_model *noise, double middle[3][3]) {
  jacobian_block block;
  for (size_t r = 0; r < arc->range_count; r++)
    for (size_t from = arc->ranges[r].first; from <= arc->ranges[r].last; from += BLOCK_STATIONS) {
      fill_block(line, arc, from, arc->ranges[r].last, &block);
      for (size_t i = 0; i < BLOCK_STATIONS && i < block.count; i++)
        add_pairs(&block, i, noise, middle);
    }
}

/* out = inverse × middle × inverse. */
static void multiply_sandwich(double inverse[FG_SMALL_MAX][FG_SMALL_MAX], double middle[3][3],
                              double out[3][3]) {
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      double sum = 0;
      for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
          sum += inverse[p][a] * middle[a][b] * inverse[b][q];
      out[p][q] = sum;
    }
}

void fg_arc_covariance(const fg_datum_line *line, const fg_noise_model *noise, fg_arc *arc) {
  double inverse[FG_SMALL_MAX][FG_SMALL_MAX], middle[3][3] = {{0}};
  if (!normal_inverse(line, arc, inverse)) {
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++)
        arc->covariance[p][q] = NAN;
    return;
  }
  add_correlated(line, arc, noise, middle);
  multiply_sandwich(inverse, middle, arc->covariance);
  double white = noise->covariance[0] * fmax(1, noise->integral_stations);
  bool sound = true;
  for (int p = 0; p < 3; p++)
    sound &= arc->covariance[p][p] > 0.05 * noise->covariance[0] * inverse[p][p];
  for (int p = 0; p < 3 && !sound; p++)
    for (int q = 0; q < 3; q++)
      arc->covariance[p][q] = white * inverse[p][q];
}

double fg_arc_cluster_covariance(const fg_datum_line *line, double p_limit, fg_arc *arc) {
  double inverse[FG_SMALL_MAX][FG_SMALL_MAX], middle[3][3] = {{0}}, cluster[3][3];
  double n = (double)arc->range_count;
  if (n < 5 || !normal_inverse(line, arc, inverse)) return NAN;
  for (size_t r = 0; r < arc->range_count; r++) {
    double g[3] = {0}, row[3];
    for (size_t k = arc->ranges[r].first; k <= arc->ranges[r].last; k++) {
      if (!fg_arc_used(line, arc, k)) continue;
      jacobian_row(line, arc, k, row);
      double residual = fg_arc_residual(line, &arc->circle, k);
      for (int p = 0; p < 3; p++)
        g[p] += row[p] * residual;
    }
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++)
        middle[p][q] += g[p] * g[q] * n / (n - 3);
  }
  multiply_sandwich(inverse, middle, cluster);
  double ratio = cluster[2][2] / arc->covariance[2][2];
  if (ratio * (n - 3) > gsl_cdf_chisq_Qinv(p_limit, n - 3))
    memcpy(arc->covariance, cluster, sizeof cluster);
  return ratio;
}

bool fg_arc_half_width_shift(const fg_datum_line *line, const fg_arc *arc, double shift[3]) {
  fg_normal_equations system;
  fg_normal_clear(&system, 3);
  double row[3], x[FG_SMALL_MAX], mean = 0, n = 0;
  for (size_t i = 0; i < arc->range_count; i++)
    for (size_t k = arc->ranges[i].first; k <= arc->ranges[i].last; k++)
      if (fg_arc_used(line, arc, k)) {
        mean += line->half_width[k];
        n++;
      }
  mean = n > 0 ? mean / n : 0;
  for (size_t i = 0; i < arc->range_count; i++)
    for (size_t k = arc->ranges[i].first; k <= arc->ranges[i].last; k++) {
      if (!fg_arc_used(line, arc, k)) continue;
      jacobian_row(line, arc, k, row);
      fg_normal_add(&system, row, line->half_width[k] - mean, 1);
    }
  if (!fg_normal_solve(&system, 0, x, NULL)) return false;
  memcpy(shift, x, 3 * sizeof *shift);
  return true;
}

bool fg_arc_shift_by(const fg_datum_line *line, const fg_arc *arc,
                     double (*move)(const void *user, size_t station), const void *user,
                     double shift[3]) {
  fg_normal_equations system;
  double row[3], x[FG_SMALL_MAX];
  fg_normal_clear(&system, 3);
  for (size_t i = 0; i < arc->range_count; i++)
    for (size_t k = arc->ranges[i].first; k <= arc->ranges[i].last; k++) {
      if (!fg_arc_used(line, arc, k)) continue;
      const fg_point *normal = &line->strip->stations[k].normal;
      jacobian_row(line, arc, k, row);
      fg_normal_add(&system, row, (normal->x * row[0] + normal->y * row[1]) * move(user, k), 1);
    }
  if (!fg_normal_solve(&system, 0, x, NULL)) return false;
  memcpy(shift, x, 3 * sizeof *shift);
  return true;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainty of a plate's scale by the level of its edges.
 *
 * A wrong level moves every radius by the same length c, a scale by a share s of it: the error of
 * gauge g of known radius is x_g s + l_g c, with l_g = 1 for a light disc or hole and -1 for a dark
 * one. Gauges of different sizes separate s and c. The standard deviation of c beside s is the
 * uncertainty. A c that differs from 0 has biased the scale that was fitted without it, so it is
 * added. */
#include "effect_search/common_level.h"

#include <math.h>

/* Minimum number of gauges: two unknowns, and the remainder for their scatter. */
enum { GAUGES_MIN = 5 };

/* Sums over gauges of weight, scale (x), level (l), residual (r). */
typedef struct sums {
  double xx, xl, ll, xr, lr, rr, count;
} sums;

static double gauge_weight_at(const fg_edge_fit *edge_fit, size_t i) {
  const fg_edge_fit_row *row = &edge_fit->rows[i];
  return edge_fit->views[row->view].held_out ? 0 : row->weight / FG_EDGE_FIT_BLOCK;
}

static const fg_disc *disc_at(const fg_edge_fit *edge_fit, size_t i) {
  return edge_fit->views[edge_fit->rows[i].view].disc;
}

/* Rows of a view are neighbours; each gauge counts by the mean of its rows. */
static sums sum_up_gauges(const fg_edge_fit *edge_fit, const double *scale,
                          const double *residual_um) {
  sums sum = {0};
  for (size_t first = 0, last; first < edge_fit->row_count; first = last) {
    double weight = 0, x = 0, r = 0;
    for (last = first;
         last < edge_fit->row_count && edge_fit->rows[last].view == edge_fit->rows[first].view;
         last++) {
      double w = gauge_weight_at(edge_fit, last);
      weight += w;
      x += w * scale[last];
      r += w * residual_um[last];
    }
    if (!(weight > 0) || !edge_fit->parts[edge_fit->rows[first].part].radius_known) continue;
    double l = disc_at(edge_fit, first)->bright ? 1 : -1;
    x /= weight;
    r /= weight;
    sum.xx += weight * x * x;
    sum.xl += weight * x * l;
    sum.ll += weight;
    sum.xr += weight * x * r;
    sum.lr += weight * l * r;
    sum.rr += weight * r * r;
    sum.count++;
  }
  return sum;
}

static double stated_u_um(const fg_edge_fit *edge_fit) {
  double uncertainty = 0;
  for (size_t i = 0; i < edge_fit->row_count; i++)
    if (edge_fit->parts[edge_fit->rows[i].part].radius_known)
      uncertainty = fmax(uncertainty, 1000 * disc_at(edge_fit, i)->level_u_mm);
  return uncertainty;
}

double fg_common_level_uncertainty(const fg_edge_fit *edge_fit, const double *scale,
                                   const double *residual_um) {
  double stated = stated_u_um(edge_fit);
  sums s = sum_up_gauges(edge_fit, scale, residual_um);
  double determinant = s.xx * s.ll - s.xl * s.xl;
  if (s.count < GAUGES_MIN || !(determinant > 1e-9 * s.xx * s.ll)) return stated;
  double level = (s.xx * s.lr - s.xl * s.xr) / determinant;
  double of_scale = (s.ll * s.xr - s.xl * s.lr) / determinant;
  double left = fmax(0, s.rr - of_scale * s.xr - level * s.lr) / (s.count - 2);
  return fmin(stated, hypot(level, sqrt(left * s.xx / determinant)));
}

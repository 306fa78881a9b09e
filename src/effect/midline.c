/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect/midline.h"

double fg_midline_along_radius(const fg_edge_fit_row *row) {
  return row->radial.x * row->normal.x + row->radial.y * row->normal.y;
}

/* The rows' normals point out of their own arc: on a bump towards the shaft. */
double fg_midline_along_normal(const fg_edge_fit_row *row) {
  return fg_midline_along_radius(row) < 0 ? -1 : 1;
}

size_t fg_midline_legendre(const fg_edge_fit_row *row, int first, int step, int count,
                           double *values) {
  double before = 1, at = row->phi;
  for (int n = 1, k = 0; k < count; n++) {
    if (n == first + k * step) values[k++] = row->bump ? at : 0;
    double next = ((2 * n + 1) * row->phi * at - n * before) / (n + 1);
    before = at;
    at = next;
  }
  return (size_t)count;
}

size_t fg_midline_stretch(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row, int first,
                          double *values) {
  const fg_edge_fit_part *part = &edge_fit->parts[row->part];
  double u = row->phi, u2 = u * u, share = 0;
  if (row->bump) share = part->bumps[row->bump_index].radius_mm / part->mean_radius_mm - 1;
  values[0] = share * (first == 3 ? u * (15 * u2 - 3) / 2 : u2 * (35 * u2 - 15) / 2);
  values[1] = share * (first == 3 ? u * ((315 * u2 - 210) * u2 + 15) / 8
                                  : u2 * ((1386 * u2 - 1260) * u2 + 210) / 16);
  return 2;
}

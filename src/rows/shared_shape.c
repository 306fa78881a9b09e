/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shape common to all bumps, as a deviation from their circles: it is the part's, not the edge's
 * noise. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "rows/scatter.h"

/* Number of polynomials that the search can follow over a bump's arc (effect/curves.c), with the
 * two lowest. With fewer bumps than the minimum, the common shape would absorb too much of each. */
enum { POLYNOMIALS = 18, BUMPS_MIN = 4 };
/* Rounding limit: a polynomial lies in the span of those before it. */
#define REST_MIN 1e-9

static void remove_part(const double *unit, size_t n, double *from) {
  double along = fg_dot(unit, from, n);
  for (size_t i = 0; i < n; i++)
    from[i] -= along * unit[i];
}

/* Chebyshev's over every arc of a bump that counts, weighted; returns how many there are. */
static size_t fill_polynomials(const fg_edge_fit *edge_fit, const bool *left_out, double *basis) {
  size_t bumps = 0;
  for (size_t from = 0, to; from < edge_fit->row_count; from = to) {
    to = fg_edge_fit_arc_end(edge_fit, from);
    double low = edge_fit->rows[from].s_mm, length = edge_fit->rows[to - 1].s_mm - low;
    if (!edge_fit->rows[from].bump || length == 0 || left_out[from]) continue;
    bumps++;
    for (size_t i = from; i < to; i++) {
      const fg_edge_fit_row *row = &edge_fit->rows[i];
      double x = acos(fmax(-1, fmin(1, 2 * (row->s_mm - low) / length - 1)));
      for (size_t p = 0; p < POLYNOMIALS; p++)
        basis[p * edge_fit->row_count + i] = fg_edge_fit_root_weight(row) * cos((double)p * x);
    }
  }
  return bumps;
}

fg_status fg_edge_fit_remove_shared_shape(fg_context *ctx, const fg_edge_fit *edge_fit,
                                          const bool *left_out, double *weighted, size_t *numbers) {
  size_t n = edge_fit->row_count;
  double *basis = NULL;
  *numbers = 0;
  FG_TRY(fg_memory_allocate(ctx, n, POLYNOMIALS * sizeof *basis, (void **)&basis));
  size_t bumps = fill_polynomials(edge_fit, left_out, basis);
  for (size_t p = 0; bumps >= BUMPS_MIN && p < POLYNOMIALS; p++) {
    double *own = basis + p * n, before = sqrt(fg_dot(own, own, n));
    for (size_t q = 0; q < p; q++)
      remove_part(basis + q * n, n, own);
    double rest = sqrt(fg_dot(own, own, n));
    if (!(rest > REST_MIN * before)) {
      memset(own, 0, n * sizeof *own);
      continue;
    }
    for (size_t i = 0; i < n; i++)
      own[i] /= rest;
    remove_part(own, n, weighted);
    ++*numbers;
  }
  free(basis);
  return FG_OK;
}

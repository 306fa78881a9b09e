/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Noise of a row: the residual beside all effects at once. */
#include <gsl/gsl_cdf.h>
#include <math.h>

#include "core/numerics.h"
#include "effect_search/state.h"

/* Share of the noise beside a curve's smoother part, below which all of its columns are needed. */
#define FINER 0.9 /* tuned on reports/loop_scans.md, tier curves */
/* No row is better known, um: exact data are not of a scanner. */
#define NOISE_MIN_UM 1e-4
/* Minimum residual dof for estimating the noise. */
enum { DOF_MIN = 12 };

double fg_search_chance(const fg_search *s, double chi2, double numbers) {
  double known = s->columns.edge_fit->scatter.dof;
  if (!(numbers > 0)) return 1;
  return known > 0 ? gsl_cdf_fdist_Q(chi2 / numbers, numbers, known)
                   : gsl_cdf_chisq_Q(chi2, numbers);
}

double fg_search_chance_limit(const fg_search *s, double p, double numbers) {
  double known = s->columns.edge_fit->scatter.dof;
  if (!(numbers > 0)) return 0;
  return known > 0 ? numbers * gsl_cdf_fdist_Qinv(p, numbers, known)
                   : gsl_cdf_chisq_Qinv(p, numbers);
}

double fg_search_integral(const fg_search_columns *s) {
  return fg_edge_fit_integral(s->edge_fit, s->row, s->rows, s->left);
}

/* Returns the noise of a row. Whitening keeps the size of smooth values, so the whitened residual
 * is larger than the noise by the root of the correlation's integral. */
static double noise_of(const fg_search_columns *c, size_t rank) {
  double dof = fmax((double)c->rows - (double)rank, 1) * c->integral;
  return fmax(sqrt(fg_dot_in_lanes(c->left, c->left, c->rows) / dof), NOISE_MIN_UM);
}

fg_status fg_search_check_rows(fg_context *ctx, const fg_search *s) {
  size_t numbers = s->columns.geometry_rank + s->dof;
  if (s->columns.rows >= numbers + DOF_MIN) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%zu edge rows are too few to look for effects: %zu numbers would be fitted to "
                 "them; scan more bumps, or at a higher resolution",
                 s->columns.rows, numbers);
}

static void take_noise(fg_search *s, size_t rank) {
  s->full = fg_dot_in_lanes(s->columns.left, s->columns.left, s->columns.rows);
  s->dof = rank - s->columns.geometry_rank;
  s->out->noise_um = noise_of(&s->columns, rank);
  double swell = s->columns.edge_fit->scatter.swell;
  s->out->integral = s->columns.integral * fmax(swell, fg_search_integral(&s->columns));
}

size_t fg_search_noise(fg_search *s, bool listed_only) {
  size_t end = listed_only ? s->free_end : s->free_column;
  size_t rank = fg_search_columns_span(&s->columns, s->free_column, end);
  take_noise(s, rank);
  return rank;
}

/* Returns true when the set of all effects has fewer than all columns of the curve. */
static bool is_smoother(const fg_search_columns *c, const fg_candidate *curve) {
  for (size_t k = 0; k < curve->columns; k++)
    if (c->part[curve->column[k]] != FG_SEARCH_ITSELF) return true;
  return false;
}

void fg_search_refine_noise(fg_search *s) {
  const fg_candidate *best = NULL;
  size_t rank = fg_search_noise(s, false);
  double min = FINER * s->out->noise_um;
  for (size_t e = 0; e < s->out->candidate_count; e++) {
    const fg_candidate *curve = &s->out->candidates[e];
    if (!fg_effect_is_free(curve->kind) || !is_smoother(&s->columns, curve)) continue;
    size_t from = curve->column[0];
    size_t more = fg_search_columns_span_more(&s->columns, rank, from, from + curve->columns);
    double noise = noise_of(&s->columns, more);
    if (noise >= min) continue;
    min = noise;
    best = curve;
  }
  if (!best) return;
  size_t from = best->column[0];
  take_noise(s, fg_search_columns_span_more(&s->columns, rank, from, from + best->columns));
}

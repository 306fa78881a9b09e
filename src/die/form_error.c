/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "die/form_error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* Of an arc: enough for lengths of a twentieth of it, few enough to be quick. */
enum { BINS = 40, BINS_MIN = 8, PARAMETERS = 3 };

/* Correlation lengths tried, relative to the mean arc's length: the circle absorbs a wave longer
 * than half of the arc almost completely. */
static const double lengths[] = {0.015, 0.02, 0.03, 0.04, 0.055, 0.08, 0.13, 0.2};
static const double white_shares[] = {1, 0.7, 0.4, 0.2, 0.1, 0.03, 0.01, 0.003};
/* Minimum gain of correlated over white noise in deviance, for two more parameters: reached by
 * chance in 5 % (chi², 2 dof). A long wave claimed in error would widen every u. */
#define CORRELATED_GAIN 6.0
enum {
  LENGTHS = sizeof lengths / sizeof *lengths,
  SHARES = sizeof white_shares / sizeof *white_shares
};

/* One arc in bins. */
typedef struct binned {
  size_t count;
  double s[BINS], residual[BINS], weight[BINS]; /* weight: stations in it */
  double x[BINS][PARAMETERS];                   /* derivatives by (x, y, R) */
} binned;

static void bin_arc(const fg_datum_line *line, const fg_arc *arc, binned *out) {
  fg_range range = arc->ranges[0];
  const fg_station *stations = line->strip->stations;
  double from = stations[range.first].s_mm, whole = stations[range.last].s_mm - from;
  size_t last = BINS;
  memset(out, 0, sizeof *out);
  for (size_t k = range.first; k <= range.last; k++) {
    if (!fg_arc_used(line, arc, k)) continue;
    size_t bin = (size_t)(BINS * (stations[k].s_mm - from) / whole);
    if (bin >= BINS) bin = BINS - 1;
    if (bin != last) out->count++;
    last = bin;
    size_t i = out->count - 1;
    double dx = line->points[k].x - arc->circle.x, dy = line->points[k].y - arc->circle.y;
    double d = hypot(dx, dy);
    out->weight[i]++;
    out->s[i] += stations[k].s_mm;
    out->residual[i] += d - arc->circle.radius;
    out->x[i][0] += dx / d;
    out->x[i][1] += dy / d;
    out->x[i][2]++;
  }
  for (size_t i = 0; i < out->count; i++) {
    out->s[i] /= out->weight[i];
    out->residual[i] /= out->weight[i];
    for (int p = 0; p < PARAMETERS; p++)
      out->x[i][p] /= out->weight[i];
  }
}

/* Correlation of two bins' means. */
static double correlation(const binned *b, const fg_die_form_error *form_error, size_t i,
                          size_t k) {
  double d = fabs(b->s[i] - b->s[k]) / form_error->length_mm;
  return (1 - form_error->white_share) * exp(-d) * (form_error->smooth ? 1 + d + d * d / 3 : 1) +
         (i == k ? form_error->white_share : 0);
}

/* Lower Cholesky factor of a matrix of `n` rows, in place; its log determinant. */
static double factor(size_t n, double *matrix) {
  double log_determinant = 0;
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k <= i; k++) {
      double sum = matrix[i * n + k];
      for (size_t j = 0; j < k; j++)
        sum -= matrix[i * n + j] * matrix[k * n + j];
      if (i == k) log_determinant += log(fmax(sum, 1e-300));
      matrix[i * n + k] = i == k ? sqrt(fmax(sum, 1e-300)) : sum / matrix[k * n + k];
    }
  return log_determinant;
}

/* Solves L y = v in place. */
static void solve_lower(size_t n, const double *lower, double *v) {
  for (size_t i = 0; i < n; i++) {
    for (size_t k = 0; k < i; k++)
      v[i] -= lower[i * n + k] * v[k];
    v[i] /= lower[i * n + i];
  }
}

/* Contribution of one arc to the restricted likelihood: log determinants, and r'Pr. */
typedef struct part {
  double log_determinants, square, dof;
} part;

static part restricted(const binned *b, const fg_die_form_error *form_error) {
  double c[BINS * BINS], columns[PARAMETERS + 1][BINS], gram[PARAMETERS * PARAMETERS];
  double right[PARAMETERS], square = 0;
  size_t n = b->count;
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < n; k++)
      c[i * n + k] = correlation(b, form_error, i, k);
  part sum = {.dof = (double)n - PARAMETERS};
  sum.log_determinants = factor(n, c);
  for (size_t i = 0; i < n; i++) {
    for (int p = 0; p < PARAMETERS; p++)
      columns[p][i] = b->x[i][p];
    columns[PARAMETERS][i] = b->residual[i];
  }
  for (int p = 0; p <= PARAMETERS; p++)
    solve_lower(n, c, columns[p]);
  for (int p = 0; p < PARAMETERS; p++) {
    right[p] = 0;
    for (int q = 0; q < PARAMETERS; q++)
      gram[p * PARAMETERS + q] = 0;
    for (size_t i = 0; i < n; i++) {
      right[p] += columns[p][i] * columns[PARAMETERS][i];
      for (int q = 0; q < PARAMETERS; q++)
        gram[p * PARAMETERS + q] += columns[p][i] * columns[q][i];
    }
  }
  for (size_t i = 0; i < n; i++)
    square += columns[PARAMETERS][i] * columns[PARAMETERS][i];
  sum.log_determinants += factor(PARAMETERS, gram);
  solve_lower(PARAMETERS, gram, right);
  for (int p = 0; p < PARAMETERS; p++)
    square -= right[p] * right[p];
  sum.square = fmax(square, 0);
  return sum;
}

/* -2 log of the restricted likelihood, the sd at its best. */
static double deviance(const binned *arcs, size_t count, fg_die_form_error *form_error) {
  part sum = {0, 0, 0};
  for (size_t i = 0; i < count; i++) {
    if (arcs[i].count < BINS_MIN) continue;
    part one = restricted(&arcs[i], form_error);
    sum.log_determinants += one.log_determinants;
    sum.square += one.square;
    sum.dof += one.dof;
  }
  form_error->sd_mm = sum.dof > 0 ? sqrt(sum.square / sum.dof) : 0;
  return sum.log_determinants + sum.dof * log(fmax(sum.square, 1e-300));
}

static void find_form_error(const binned *arcs, size_t count, double arc_mm,
                            fg_die_form_error *best) {
  double min = INFINITY;
  for (int smooth = 0; smooth < 2; smooth++)
    for (size_t l = 0; l < LENGTHS; l++)
      for (size_t w = 0; w < SHARES; w++) {
        fg_die_form_error form_error = {0, lengths[l] * arc_mm, white_shares[w], smooth};
        if (white_shares[w] == 1 && (l > 0 || smooth)) continue; /* all the same */
        double d = deviance(arcs, count, &form_error) + (white_shares[w] < 1 ? CORRELATED_GAIN : 0);
        if (!(d < min)) continue;
        min = d;
        *best = form_error;
      }
}

/* Inverse of a symmetric 3 × 3 by its cofactors; false where it has none. */
static bool invert(double a[PARAMETERS][PARAMETERS], double out[PARAMETERS][PARAMETERS]) {
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      int i = (q + 1) % 3, j = (q + 2) % 3, k = (p + 1) % 3, l = (p + 2) % 3;
      out[p][q] = a[i][k] * a[j][l] - a[i][l] * a[j][k];
    }
  double determinant = a[0][0] * out[0][0] + a[0][1] * out[1][0] + a[0][2] * out[2][0];
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      out[p][q] /= determinant;
  return isfinite(1 / determinant);
}

/* Of the unweighted fit: G^-1 X'W C W X G^-1, G = X'W X. */
static void set_covariance(const binned *b, const fg_die_form_error *form_error, fg_arc *arc) {
  double gram[PARAMETERS][PARAMETERS] = {{0}}, inverse[PARAMETERS][PARAMETERS];
  double gain[PARAMETERS][BINS];
  for (size_t i = 0; i < b->count; i++)
    for (int p = 0; p < PARAMETERS; p++)
      for (int q = 0; q < PARAMETERS; q++)
        gram[p][q] += b->weight[i] * b->x[i][p] * b->x[i][q];
  if (b->count < BINS_MIN || !invert(gram, inverse)) return;
  for (int p = 0; p < PARAMETERS; p++)
    for (size_t i = 0; i < b->count; i++) {
      gain[p][i] = 0;
      for (int q = 0; q < PARAMETERS; q++)
        gain[p][i] += inverse[p][q] * b->weight[i] * b->x[i][q];
    }
  for (int p = 0; p < PARAMETERS; p++)
    for (int q = 0; q < PARAMETERS; q++) {
      double sum = 0;
      for (size_t i = 0; i < b->count; i++)
        for (size_t k = 0; k < b->count; k++)
          sum += gain[p][i] * correlation(b, form_error, i, k) * gain[q][k];
      arc->covariance[p][q] = form_error->sd_mm * form_error->sd_mm * sum;
    }
}

fg_status fg_die_form_error_find(fg_context *ctx, const fg_datum_line *line, fg_arc *const *arcs,
                                 size_t count, fg_die_form_error *form_error) {
  binned *bins = NULL;
  double arc_mm = 0;
  *form_error = (fg_die_form_error){0, 1, 1, false};
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *bins, (void **)&bins));
  for (size_t i = 0; i < count; i++) {
    fg_range range = arcs[i]->ranges[0];
    const fg_station *stations = line->strip->stations;
    bin_arc(line, arcs[i], &bins[i]);
    arc_mm += (stations[range.last].s_mm - stations[range.first].s_mm) / (double)count;
  }
  if (count) find_form_error(bins, count, arc_mm, form_error);
  for (size_t i = 0; i < count; i++)
    set_covariance(&bins[i], form_error, arcs[i]);
  free(bins);
  return FG_OK;
}

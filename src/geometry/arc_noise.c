/* Correlation of the residuals along the strip. */
#include "geometry/arcs.h"

#include <math.h>
#include <string.h>

/* One residual: of the datum line from its circle, or of the half width from its mean. */
static double value_at(const fg_datum_line *line, const fg_arc *arc, size_t k, int values,
                       double mean) {
  if (!fg_arc_used(line, arc, k)) return NAN;
  return values ? line->half_width[k] - mean : fg_arc_residual(line, &arc->circle, k);
}

static double mean_half_width(const fg_datum_line *line, const fg_arc *arc) {
  double sum = 0, n = 0;
  for (size_t r = 0; r < arc->range_count; r++)
    for (size_t k = arc->ranges[r].first; k <= arc->ranges[r].last; k++)
      if (fg_arc_used(line, arc, k)) {
        sum += line->half_width[k];
        n++;
      }
  return n > 0 ? sum / n : 0;
}

typedef struct lag_sums {
  double products[FG_NOISE_LAGS], pairs[FG_NOISE_LAGS];
} lag_sums;

static void add_arc(const fg_datum_line *line, const fg_arc *arc, int values, size_t lags,
                    lag_sums *sums) {
  double mean = values ? mean_half_width(line, arc) : 0;
  for (size_t r = 0; r < arc->range_count; r++)
    for (size_t i = arc->ranges[r].first; i <= arc->ranges[r].last; i++) {
      double a = value_at(line, arc, i, values, mean);
      if (!isfinite(a)) continue;
      for (size_t lag = 0; lag < lags && i + lag <= arc->ranges[r].last; lag++) {
        double b = value_at(line, arc, i + lag, values, mean);
        if (!isfinite(b)) continue;
        sums->products[lag] += a * b;
        sums->pairs[lag] += 1;
      }
    }
}

/* The first lag from which on three in a row lie within two standard errors of nothing. */
static size_t find_cut(const double *correlation, const double *pairs, size_t lags) {
  for (size_t lag = 1; lag + 3 < lags; lag++) {
    bool nothing = true;
    for (size_t i = lag; i < lag + 3; i++)
      nothing &= fabs(correlation[i]) < 2 / sqrt(fmax(pairs[i], 1));
    if (nothing) return lag;
  }
  return lags / 2;
}

void fg_noise_estimate(const fg_datum_line *line, const fg_arc *arcs, size_t count, int values,
                       fg_noise_model *noise) {
  memset(noise, 0, sizeof *noise);
  lag_sums sums = {0};
  double correlation[FG_NOISE_LAGS];
  /* White noise is the common case: look at few lags first. */
  size_t lags = 8, cut = 0;
  for (; lags <= FG_NOISE_LAGS; lags *= 4) {
    memset(&sums, 0, sizeof sums);
    for (size_t i = 0; i < count; i++) add_arc(line, &arcs[i], values, lags, &sums);
    if (!(sums.pairs[0] > 4) || !(sums.products[0] > 0)) break;
    double variance = sums.products[0] / sums.pairs[0];
    for (size_t lag = 0; lag < lags; lag++)
      correlation[lag] =
          sums.pairs[lag] > 0 ? sums.products[lag] / sums.pairs[lag] / variance : 0;
    cut = find_cut(correlation, sums.pairs, lags);
    if (cut < lags / 2) break;
  }
  if (lags > FG_NOISE_LAGS) lags = FG_NOISE_LAGS;
  /* Three parameters of every circle took their share of the variance. */
  double freedom = fmax(sums.pairs[0] - 3.0 * (double)count, 1);
  double variance = sums.pairs[0] > 0 ? sums.products[0] / freedom : 0;
  noise->covariance[0] = variance;
  noise->integral_stations = 1;
  noise->lags = 1;
  /* Flat top (Politis and Romano 1995): whole up to the cut, then down to nothing at twice it. */
  for (size_t lag = 1; cut > 1 && lag < 2 * cut && lag < lags; lag++) {
    double weight = lag < cut ? 1 : 2 - (double)lag / (double)cut;
    noise->covariance[lag] = weight * variance * correlation[lag];
    noise->integral_stations += 2 * weight * correlation[lag];
    noise->lags = lag + 1;
  }
  if (noise->integral_stations < 0.2) noise->integral_stations = 0.2;
}

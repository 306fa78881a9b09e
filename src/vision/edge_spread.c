/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/edge_spread.h"

#include <math.h>
#include <stdbool.h>

#define BIN_PX 0.25
/* Reach from the edge; beyond it lies another part, or shading. */
#define REACH_PX 10.0
enum { END_BINS = 6 };
/* Distance from a tenth to nine tenths of a Gaussian step, in standard deviations. */
#define TENTHS_SIGMAS 2.5631

void fg_edge_spread_add(fg_edge_spread *spread, double bright_px, double share, double weight) {
  double at = floor(bright_px / BIN_PX) + FG_SPREAD_BINS / 2;
  if (!(at >= 0 && at < FG_SPREAD_BINS && fabs(bright_px) < REACH_PX) || !isfinite(share)) return;
  spread->sum[(size_t)at] += weight * share;
  spread->weight[(size_t)at] += weight;
}

static double bin_mean(const fg_edge_spread *spread, size_t bin) {
  return spread->sum[bin] / spread->weight[bin];
}

/* Mean of the bins farthest out, on the dark side or the bright one. */
static double end_of(const fg_edge_spread *spread, bool bright) {
  double sum = 0, n = 0;
  for (size_t i = 0; i < FG_SPREAD_BINS && n < END_BINS; i++) {
    size_t bin = bright ? FG_SPREAD_BINS - 1 - i : i;
    if (!(spread->weight[bin] > 0)) continue;
    sum += bin_mean(spread, bin);
    n++;
  }
  return sum / n;
}

/* Returns the place where the profile crosses a value, px from the middle: the nearest crossing. */
static double crossing_px(const fg_edge_spread *spread, double value) {
  double best = NAN;
  size_t before = FG_SPREAD_BINS;
  for (size_t i = 0; i < FG_SPREAD_BINS; i++) {
    if (!(spread->weight[i] > 0)) continue;
    if (before < FG_SPREAD_BINS) {
      double last = bin_mean(spread, before), next = bin_mean(spread, i);
      double place = (double)before + (value - last) / (next - last) * (double)(i - before);
      double from_middle = (place + 0.5 - FG_SPREAD_BINS / 2) * BIN_PX;
      if (last < value && next >= value && !(fabs(from_middle) >= fabs(best))) best = from_middle;
    }
    before = i;
  }
  return best;
}

/* The levels of both sides come from the spread itself: those of a model that misses the tone curve
 * lie elsewhere. */
void fg_edge_spread_measure(const fg_edge_spread *spread, double *blur_px, double *asymmetry) {
  double dark = end_of(spread, false), contrast = end_of(spread, true) - dark;
  double low = crossing_px(spread, dark + 0.1 * contrast);
  double half = crossing_px(spread, dark + 0.5 * contrast);
  double high = crossing_px(spread, dark + 0.9 * contrast);
  *blur_px = (high - low) / TENTHS_SIGMAS;
  *asymmetry = ((high - half) - (half - low)) / (high - low);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gray levels in use, gaps between them, and values cut by the ends of the scale. */
#include <math.h>
#include <stdbool.h>

#include "vision/picture.h"

/* Distances of levels that move an edge: above this share of the contrast, and above so many sd of
 * the noise, which spreads a value over its neighbours. */
#define STEP_SHARE  0.02
#define STEP_SIGMAS 2.5
/* Numbers of pixels. A small disc has few; they suffice to show that levels are very few. */
enum { PIXELS_MIN = 4000, PIXELS_FEW = 400, LEVELS_FEW = 16 };
/* Share of the pixels beyond either end of the range in use. */
#define END_SHARE 0.002
/* Min expected count for a missing level, and the number of levels on either side that give the
 * expectation. */
#define EXPECTED_MIN 1.0
enum { AROUND = 12 };
/* Min size of a share, in its own deviations. */
#define GAPS_SIGMAS 4.0
/* Min gaps that count. A straight curve leaves equal gaps everywhere, and moves no edge. */
#define GAPS_SHARE      0.03
#define GAPS_DIFFERENCE 0.1
enum { PARTS = 6 };
/* Pixels are cut when more than this share has the last value, and twice as many as the next. */
#define PILE_SHARE 0.05

void fg_value_counts_clear(fg_value_counts *counts) {
  *counts = (fg_value_counts){.total = 0};
}

/* Returns the outermost count on one side, but for END_SHARE of the pixels. */
static int find_end(const fg_value_counts *counts, int from, int step) {
  double seen = 0, limit = END_SHARE * (double)counts->total;
  int at = from;
  while (at + step >= 0 && at + step <= 255 && seen + (double)counts->of[at] <= limit) {
    seen += (double)counts->of[at];
    at += step;
  }
  return at;
}

/* Mean count of the levels beside one, on one side. */
static double mean_beside(const fg_value_counts *counts, int at, int step, int low, int high) {
  double sum = 0;
  int n = 0;
  for (int i = at + step; i > low && i < high && n < AROUND; i += step, n++)
    sum += (double)counts->of[i];
  return n ? sum / n : 0;
}

/* Returns the lower mean of both sides: levels beside a plateau are few, whatever its number of
 * pixels. */
static double expected_at(const fg_value_counts *counts, int at, int low, int high) {
  return fmin(mean_beside(counts, at, -1, low, high), mean_beside(counts, at, 1, low, high));
}

/* Share of levels, and its standard deviation. */
typedef struct level_share {
  double share, sd;
} level_share;

/* Share of the levels between two that are missing, beyond those missing by chance: with λ
 * expected, exp(-λ) of the levels. NaN with too few levels. */
static level_share missing_between(const fg_value_counts *counts, int low, int high) {
  double known = 0, missing = 0, variance = 0;
  for (int i = low + 1; i < high; i++) {
    double expected = expected_at(counts, i, low, high), chance = exp(-expected);
    if (expected < EXPECTED_MIN) continue;
    known++;
    missing += (counts->of[i] == 0) - chance;
    variance += chance * (1 - chance);
  }
  if (known <= 3) return (level_share){NAN, NAN};
  return (level_share){missing / known, sqrt(variance) / known};
}

static void inspect_gaps(const fg_value_counts *counts, int low, int high,
                         fg_picture_state *state) {
  level_share min = {INFINITY, 0}, max = {-INFINITY, 0};
  const level_share all = missing_between(counts, low, high);
  state->missing_levels = fmax(all.share, 0);
  if (isnan(all.share)) state->missing_levels = NAN;
  for (int k = 0; k < PARTS; k++) {
    const level_share part = missing_between(counts, low + (high - low) * k / PARTS,
                                             low + (high - low) * (k + 1) / PARTS);
    if (part.share < min.share) min = part;
    if (part.share > max.share) max = part;
  }
  double difference = max.share - min.share;
  if (all.share > fmax(GAPS_SHARE, GAPS_SIGMAS * all.sd) &&
      difference > fmax(GAPS_DIFFERENCE, GAPS_SIGMAS * hypot(min.sd, max.sd)))
    state->findings |= FG_PICTURE_LEVEL_GAPS;
}

/* Number of values of a count: up to 256 of a file of 16 bits, one of 8 bits. */
static int values_of(const fg_value_counts *counts, int count) {
  int values = 0;
  for (int k = 0; k < 4; k++)
    values += __builtin_popcountll(counts->low[count][k]);
  return values;
}

/* Finds the mean distance of the levels in use between the two sides of the edge. */
static void inspect_steps(const fg_value_counts *counts, const double levels[2],
                          fg_picture_state *state) {
  int low = (int)lround(fmin(levels[0], levels[1])), high = (int)lround(fmax(levels[0], levels[1]));
  double contrast = high - low, noise = isnan(state->noise) ? 0 : state->noise;
  int used = 0;
  for (int i = low + 1; i < high && i < 256; i++) {
    if (i < 0) continue;
    used += values_of(counts, i);
  }
  double step = contrast / (used + 1);
  bool enough = counts->total > PIXELS_MIN || (used < LEVELS_FEW && counts->total > PIXELS_FEW);
  /* Noise from a fit's misfit includes the steps of two levels: any other noise would have put more
   * levels between them. */
  bool two = state->gray_levels <= 2;
  if (step > STEP_SHARE * contrast && (two || step > STEP_SIGMAS * noise) && enough)
    state->findings |= FG_PICTURE_FEW_LEVELS;
}

/* Share of the pixels with the last value on one side, where that is the end of the scale or has
 * more pixels than noise explains. */
static double share_cut(const fg_value_counts *counts, int end, int step) {
  double share = (double)counts->of[end] / (double)counts->total;
  if (end == 0 || end == 255) return share;
  bool piled = share > PILE_SHARE && counts->of[end] > 2 * counts->of[end + step];
  return piled ? share : 0;
}

void fg_picture_inspect_levels(const fg_value_counts *counts, const double levels[2],
                               fg_picture_state *state) {
  if (!counts->total) return;
  int low = find_end(counts, 0, 1), high = find_end(counts, 255, -1);
  state->gray_levels = 0;
  for (int i = 0; i < 256; i++)
    state->gray_levels += counts->of[i] > 0;
  if (high <= low) return;
  state->clipped_low = share_cut(counts, low, 1);
  state->clipped_high = share_cut(counts, high, -1);
  inspect_steps(counts, levels, state);
  inspect_gaps(counts, low, high, state);
}

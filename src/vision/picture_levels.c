/* Gray levels in use, gaps between them, and values that the ends of the scale have cut. */
#include <math.h>

#include "vision/picture.h"

/* Levels further apart than this share of the contrast, and than so many sd of the noise, which
 * spreads a value over its neighbours, move the place of an edge. */
#define STEP_SHARE  0.02
#define STEP_SIGMAS 2.5
enum { PIXELS_LEAST = 4000 };
/* The ends of what is in use: but for this share of the pixels. */
#define END_SHARE 0.002
/* A level is missing when so many pixels were to be expected there. */
#define EXPECTED_LEAST 12.0
enum { AROUND = 24 };
/* A curve that is straight leaves gaps that are alike everywhere, and moves no edge. */
#define GAPS_SHARE      0.03
#define GAPS_DIFFERENCE 0.1
/* Pixels are cut when more than this share has the last value, and twice as many as the next. */
#define PILE_SHARE 0.05

void fg_value_counts_clear(fg_value_counts *counts) {
  *counts = (fg_value_counts){.total = 0};
  for (int i = 0; i < 256; i++)
    counts->low_byte[i] = -1;
}

/* The outermost count on one side, but for END_SHARE of the pixels. */
static int find_end(const fg_value_counts *counts, int from, int step) {
  double seen = 0, limit = END_SHARE * (double)counts->total;
  int at = from;
  while (at + step >= 0 && at + step <= 255 && seen + (double)counts->of[at] <= limit) {
    seen += (double)counts->of[at];
    at += step;
  }
  return at;
}

static double expected_at(const fg_value_counts *counts, int at, int low, int high) {
  double sum = 0;
  int n = 0;
  for (int i = at - AROUND; i <= at + AROUND; i++)
    if (i > low && i < high) {
      sum += (double)counts->of[i];
      n++;
    }
  return n ? sum / n : 0;
}

/* Share of the levels between two that are missing; NaN where too few pixels tell. */
static double missing_between(const fg_value_counts *counts, int low, int high) {
  int known = 0, missing = 0;
  for (int i = low + 1; i < high; i++) {
    if (expected_at(counts, i, low, high) < EXPECTED_LEAST) continue;
    known++;
    missing += !counts->of[i];
  }
  return known > 3 ? (double)missing / known : NAN;
}

static void inspect_gaps(const fg_value_counts *counts, int low, int high,
                         fg_picture_state *state) {
  double least = INFINITY, most = -INFINITY;
  state->missing_levels = missing_between(counts, low, high);
  for (int k = 0; k < 3; k++) {
    double share =
        missing_between(counts, low + (high - low) * k / 3, low + (high - low) * (k + 1) / 3);
    least = fmin(least, share);
    most = fmax(most, share);
  }
  if (state->missing_levels > GAPS_SHARE && most - least > GAPS_DIFFERENCE)
    state->findings |= FG_PICTURE_LEVEL_GAPS;
}

/* Levels in use between the two sides of the edge: their mean distance. */
static void inspect_steps(const fg_value_counts *counts, const double levels[2],
                          fg_picture_state *state) {
  int low = (int)lround(fmin(levels[0], levels[1])), high = (int)lround(fmax(levels[0], levels[1]));
  double contrast = high - low, noise = isnan(state->noise) ? 0 : state->noise;
  int used = 0;
  for (int i = low + 1; i < high && i < 256; i++) {
    if (i < 0) continue;
    used += counts->of[i] > 0;
  }
  double step = contrast / (used + 1);
  if (step > STEP_SHARE * contrast && step > STEP_SIGMAS * noise && counts->total > PIXELS_LEAST)
    state->findings |= FG_PICTURE_FEW_LEVELS;
}

/* Share of the pixels that have the last value of all on one side, where it is the end of the scale
 * or more have it than noise explains. */
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

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Isolated wrong readings of a record: a loose plug, a lost reflection. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "load_test/analysis.h"

/* Limits for an isolated reading: its distance from every line through its neighbours exceeds this
 * many medians of all readings' distances (some eight standard deviations of white noise), and this
 * share of the column's range. */
static const double medians = 12, range_share = 0.02;

/* Minimum ratio of that distance to the distance between its neighbours: a rotor that jumps through
 * its gap leaves them apart. */
static const double apart = 3;

enum { RUN_MAX = 2, COLUMNS = 2 };

static double *reading_at(fg_load_sample *sample, int column) {
  return column ? &sample->force_n : &sample->x_mm;
}

/* Returns the distance of a run's reading from the line between its neighbours, and from the
 * extrapolations of each side's last two: at a turn of the stroke one of these fits. */
static double distance_from_lines(fg_load_sample *s, size_t run, size_t k, int column) {
  double before[2] = {*reading_at(s - 2, column), *reading_at(s - 1, column)};
  double after[2] = {*reading_at(s + run, column), *reading_at(s + run + 1, column)};
  double here = *reading_at(s + k, column), at = (double)(k + 1), back = (double)(run - k);
  double between = before[1] + (after[0] - before[1]) * at / (double)(run + 1);
  double from_left = before[1] + at * (before[1] - before[0]);
  double from_right = after[0] + back * (after[0] - after[1]);
  double d = fmin(fabs(here - between), fabs(here - from_left));
  return fmin(d, fabs(here - from_right));
}

static bool is_isolated(fg_load_sample *s, size_t run, int column, double limit) {
  double gap = fabs(*reading_at(s + run, column) - *reading_at(s - 1, column));
  for (size_t k = 0; k < run; k++) {
    double d = distance_from_lines(s, run, k, column);
    if (!(d > limit && d > apart * gap)) return false;
  }
  return true;
}

static void bridge(fg_load_sample *s, size_t run, int column) {
  double from = *reading_at(s - 1, column), to = *reading_at(s + run, column);
  for (size_t k = 0; k < run; k++)
    *reading_at(s + k, column) = from + (to - from) * (double)(k + 1) / (double)(run + 1);
}

static double find_limit(fg_load_sample *s, size_t count, int column, double *room) {
  size_t n = 0;
  for (size_t i = 2; i + 2 < count; i++)
    room[n++] = distance_from_lines(s + i, 1, 0, column);
  double median = fg_select(room, n, n / 2);
  for (size_t i = 0; i < count; i++)
    room[i] = *reading_at(s + i, column);
  /* Quantiles, because wrong readings must not widen the range that they are compared with. */
  double low = fg_select(room, count, count / 20);
  double high = fg_select(room, count, count - 1 - count / 20);
  return fmax(medians * median, range_share * (high - low));
}

fg_status fg_load_bridge_outliers(fg_context *ctx, fg_load_test *test, fg_load_direction *d) {
  enum { COUNT_MIN = 20 };
  fg_load_sample *s = test->samples + d->first;
  double *room = NULL;
  if (d->count < COUNT_MIN) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, d->count, sizeof *room, (void **)&room));
  for (int column = 0; column < COLUMNS; column++) {
    double limit = find_limit(s, d->count, column, room);
    for (size_t run = 1; run <= RUN_MAX; run++)
      for (size_t i = 2; i + run + 1 < d->count; i++) {
        if (!is_isolated(s + i, run, column, limit)) continue;
        bridge(s + i, run, column);
        d->flags |= FG_LOAD_OUTLIERS;
      }
  }
  free(room);
  return FG_OK;
}

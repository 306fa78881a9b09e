/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "load_test/usable.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"

/* ---- the ends of the instruments' ranges ---- */

/* Minimum number of samples with one reading, and minimum travel of the other column meanwhile: as
 * a multiple of its travel during other readings, and as a share of its range, of the displacement
 * and of the force. A force that is held while the foil creeps stays below that. */
enum { RUN_MIN = 3 };
static const double usual_max = 3, travel_share = 0.02, force_share = 0.1;

/* Forces below this share of the extreme are not compared: in the gap the rotor moves freely. */
static const double loaded_share = 0.5;

typedef enum column { FORCE, DISPLACEMENT } column;

static double read_column(const fg_load_sample *s, column of) {
  return of == FORCE ? s->force_n : s->x_mm;
}

/* Returns what the other column moves on during the run of equal readings from `first`: the
 * displacement either way, the force away from the gap only, as friction reverses at every turn. */
static double move_on(const fg_load_sample *s, size_t first, size_t end, column of, int side) {
  column other = of == FORCE ? DISPLACEMENT : FORCE;
  double low = INFINITY, high = -INFINITY, start = side * read_column(&s[first], other);
  for (size_t i = first; i < end; i++) {
    double value = side * read_column(&s[i], other);
    low = fmin(low, value), high = fmax(high, value);
  }
  return of == FORCE ? high - low : high - start;
}

static size_t find_run_end(const fg_load_sample *s, size_t first, size_t count, column of) {
  double reading = read_column(&s[first], of);
  size_t end = first + 1;
  while (end < count && !(read_column(&s[end], of) != reading))
    end++;
  return end;
}

static double find_extreme(const fg_load_sample *s, size_t count, column of, int side) {
  double extreme = -INFINITY;
  for (size_t i = 0; i < count; i++)
    extreme = fmax(extreme, side * read_column(&s[i], of));
  return side * extreme;
}

static bool is_saturated(const fg_load_sample *s, size_t count, column of, int side,
                         double extreme) {
  double at_extreme = 0, usual = 0, range;
  column other = of == FORCE ? DISPLACEMENT : FORCE;
  if (of == FORCE && !(side * extreme > 0)) return false;
  for (size_t i = 0, end; i < count; i = end) {
    double reading = read_column(&s[i], of);
    end = find_run_end(s, i, count, of);
    double moved = move_on(s, i, end, of, side);
    if (!(fabs(reading - extreme) > 0)) {
      if (end - i >= RUN_MIN) at_extreme = fmax(at_extreme, moved);
    } else if (of == DISPLACEMENT || side * reading > loaded_share * side * extreme) {
      usual = fmax(usual, moved);
    }
  }
  range = find_extreme(s, count, other, 1) - find_extreme(s, count, other, -1);
  return at_extreme > usual_max * usual &&
         at_extreme > (of == FORCE ? travel_share : force_share) * range;
}

void fg_load_mark_saturated(const fg_load_test *test, fg_load_direction *d, bool *left_out) {
  const fg_load_sample *s = test->samples + d->first;
  for (int side = -1; side <= 1; side += 2)
    for (column of = FORCE; of <= DISPLACEMENT; of++) {
      double extreme = find_extreme(s, d->count, of, side);
      if (!is_saturated(s, d->count, of, side, extreme)) continue;
      d->flags |= FG_LOAD_SATURATED;
      for (size_t i = 0; i < d->count; i++)
        if (!(fabs(read_column(&s[i], of) - extreme) > 0)) left_out[i] = true;
    }
}

/* ---- loops on the way ---- */

/* Minimum depth of a loop as a share of the travel, in standard deviations of white noise of the
 * displacement, and in its steps. */
static const double depth_share = 0.005, depth_noise = 8, depth_steps = 4;

/* Median of |x_-1 - 2 x + x_+1| of white noise over its standard deviation. */
static const double second_difference = 0.6745 * 2.449489743;

fg_status fg_load_find_depth(fg_context *ctx, const fg_load_test *test, const fg_load_direction *d,
                             double *depth_mm) {
  const fg_load_sample *s = test->samples + d->first;
  double *bend = NULL, noise = 0;
  if (d->count > 2) {
    FG_TRY(fg_memory_allocate(ctx, d->count, sizeof *bend, (void **)&bend));
    for (size_t i = 1; i + 1 < d->count; i++)
      bend[i - 1] = fabs(s[i - 1].x_mm - 2 * s[i].x_mm + s[i + 1].x_mm);
    noise = fg_select(bend, d->count - 2, (d->count - 2) / 2) / second_difference;
    free(bend);
  }
  *depth_mm = fmax(depth_share * d->travel_mm, fmax(depth_noise * noise, depth_steps * d->step_mm));
  return FG_OK;
}

bool fg_load_mark_loops(const fg_load_sample *samples, size_t first, size_t last, int sense,
                        double depth_mm, bool *left_out) {
  size_t farthest = first;
  double back = 0; /* the way back since then */
  bool found = false;
  for (size_t i = first + 1; i <= last; i++) {
    double ahead = sense * (samples[i].x_mm - samples[farthest].x_mm);
    back = fmax(back, -ahead);
    if (ahead < 0) continue;
    for (size_t k = farthest + 1; back > depth_mm && k < i; k++)
      left_out[k] = found = true;
    farthest = i, back = 0;
  }
  return found;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stiffness over the displacement, and its largest value up to just before the turn. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "load_test/analysis.h"
#include "load_test/local_fit.h"

/* A stroke that ends nearer to the record's end than this share of the travel reaches it. */
static const double reach_share = 0.05;

/* Share of the travel left out before a turn, where samples lie within the noise of the
 * displacement. */
static const double turn_left_out = 0.01;

/* Multiple of the displacement's noise left out as well. At a distance d from the place where
 * samples crowd, as those of a sine do, a sample's place has a mean bias of s² / (2 d), whose slope
 * is s² / (2 d²): at 10 s half a percent, and so is the error of the slope. */
static const double noise_left_out = 10;

bool fg_load_stroke_reaches(const fg_load_stroke *stroke, const fg_load_direction *direction,
                            double low, double high, int side) {
  double way = reach_share * direction->travel_mm;
  return side == FG_LOAD_PUSH ? stroke->x[stroke->count - 1] > high - way
                              : stroke->x[0] < low + way;
}

enum { WHOLE, ODD, EVEN, PARTS };

/* Loading strokes of one side: all merged, and two halves without common samples (every second
 * stroke, or every second sample of a single one). */
typedef struct side {
  const fg_load_stroke **stroke;
  size_t count;
  fg_load_stroke part[PARTS];
  double x[FG_LOAD_POINTS];
  fg_local_fit fit[PARTS][FG_LOAD_POINTS];
  bool seen[FG_LOAD_POINTS], known[FG_LOAD_POINTS]; /* of the whole; of both halves too */
} side;

static void free_side(side *s) {
  for (int part = 0; part < PARTS; part++)
    fg_load_stroke_free(&s->part[part]);
  free(s->stroke);
  free(s);
}

static fg_status choose_side_strokes(fg_context *ctx, const fg_load_strokes *strokes,
                                     const fg_load_direction *direction, int which, side *s) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < strokes->count; i++) {
    low = fmin(low, strokes->stroke[i].x[0]);
    high = fmax(high, strokes->stroke[i].x[strokes->stroke[i].count - 1]);
  }
  FG_TRY(fg_memory_allocate(ctx, strokes->count, sizeof(fg_load_stroke *), (void **)&s->stroke));
  for (size_t i = 0; i < strokes->count; i++)
    if ((strokes->stroke[i].sense > 0) == (which == FG_LOAD_PUSH) &&
        fg_load_stroke_reaches(&strokes->stroke[i], direction, low, high, which))
      s->stroke[s->count++] = &strokes->stroke[i];
  return FG_OK;
}

static fg_status merge_every_second(fg_context *ctx, side *s, size_t from, fg_load_stroke *part) {
  const fg_load_stroke **chosen;
  size_t count = 0;
  FG_TRY(fg_memory_allocate(ctx, s->count, sizeof *chosen, (void **)&chosen));
  for (size_t i = from; i < s->count; i += 2)
    chosen[count++] = s->stroke[i];
  fg_status status = fg_load_strokes_merge(ctx, chosen, count, part);
  free(chosen);
  return status;
}

static fg_status make_parts(fg_context *ctx, side *s) {
  FG_TRY(fg_load_strokes_merge(ctx, s->stroke, s->count, &s->part[WHOLE]));
  for (int part = ODD; part <= EVEN; part++)
    FG_TRY(s->count > 1
               ? merge_every_second(ctx, s, (size_t)part - ODD, &s->part[part])
               : fg_load_stroke_half(ctx, &s->part[WHOLE], (size_t)part - ODD, &s->part[part]));
  return FG_OK;
}

/* From the middle between the points to where the first stroke turns. */
static void place_points(const fg_load_direction *direction, int which, double noise_mm, side *s) {
  double middle = (direction->push_mm + direction->pull_mm) / 2;
  double end = which == FG_LOAD_PUSH ? INFINITY : -INFINITY;
  for (size_t i = 0; i < s->count; i++) {
    const fg_load_stroke *stroke = s->stroke[i];
    double low = fg_load_stroke_turn(stroke, false), high = fg_load_stroke_turn(stroke, true);
    end = which == FG_LOAD_PUSH ? fmin(end, high) : fmax(end, low);
    if (!isfinite(middle)) middle = (low + high) / 2;
  }
  double way = fmax(turn_left_out * direction->travel_mm, noise_left_out * noise_mm);
  end += (which == FG_LOAD_PUSH ? -1 : 1) * way;
  for (size_t g = 0; g < FG_LOAD_POINTS; g++)
    s->x[g] = middle + (end - middle) * (double)g / (FG_LOAD_POINTS - 1);
}

static int by_size(const void *left, const void *right) {
  double a = *(const double *)left, b = *(const double *)right;
  return (a > b) - (a < b);
}

/* Chooses windows: at each place the median of those around. Noise that makes a slope steep makes
 * its window narrow as well, and the largest slope would be sought among such windows. */
static void find_windows(const side *s, double window[FG_LOAD_POINTS]) {
  enum { AROUND = 4 };
  double own[FG_LOAD_POINTS];
  for (size_t g = 0; g < FG_LOAD_POINTS; g++) {
    fg_local_fit fit;
    bool found = fg_local_fit_adaptive(&s->part[WHOLE], s->x[g], FG_LOCAL_SLOPE, &fit);
    own[g] = found ? fit.window_mm : NAN;
  }
  for (size_t g = 0; g < FG_LOAD_POINTS; g++) {
    double around[2 * AROUND + 1];
    size_t count = 0;
    for (size_t k = g > AROUND ? g - AROUND : 0; k <= g + AROUND && k < FG_LOAD_POINTS; k++)
      if (isfinite(own[k])) around[count++] = own[k];
    fg_sort_items(around, count, sizeof *around, by_size);
    window[g] = count ? around[count / 2] : NAN;
  }
}

/* Slopes of all parts with the same window. */
static void fit_slopes(side *s) {
  double window[FG_LOAD_POINTS];
  find_windows(s, window);
  for (size_t g = 0; g < FG_LOAD_POINTS; g++) {
    s->seen[g] = isfinite(window[g]) &&
                 fg_local_fit_with(&s->part[WHOLE], s->x[g], window[g], &s->fit[WHOLE][g]);
    s->known[g] = s->seen[g];
    for (int part = ODD; part <= EVEN; part++)
      s->known[g] =
          s->known[g] && fg_local_fit_at(&s->part[part], s->x[g], window[g], &s->fit[part][g]);
  }
}

static size_t steepest(const side *s, int part) {
  size_t best = 0;
  for (size_t g = 1; g < FG_LOAD_POINTS; g++)
    if (s->known[g] && (!s->known[best] || s->fit[part][g].slope > s->fit[part][best].slope))
      best = g;
  return best;
}

static void write_stiffness_profile(const side *s, fg_load_profile *profile) {
  for (size_t g = 0; g < FG_LOAD_POINTS; g++) {
    const fg_local_fit *fit = &s->fit[WHOLE][g];
    if (s->seen[g])
      profile->point[profile->count++] =
          (fg_load_point){s->x[g], fit->value, fit->slope, fit->u_slope};
  }
}

/* Adds the scatter of the strokes' slopes at one place. */
static void add_scatter(const side *s, size_t at, fg_load_scatter *scatter) {
  double weight = 0, sum = 0, squares = 0;
  for (size_t i = 0; i < s->count; i++) {
    fg_local_fit fit;
    if (!fg_local_fit_at(s->stroke[i], s->x[at] + s->stroke[i]->shift_mm,
                         s->fit[WHOLE][at].window_mm, &fit))
      continue;
    double w = 1 / (fit.u_slope * fit.u_slope);
    scatter->dof += weight > 0;
    weight += w;
    sum += w * fit.slope;
    squares += w * fit.slope * fit.slope;
  }
  if (weight > 0) scatter->chi2 += fmax(0, squares - sum * sum / weight);
}

/* The largest slope: of each half where the other has it. */
static void keep_largest(const side *s, fg_load_direction *direction, fg_load_scatter *scatter) {
  size_t at = steepest(s, WHOLE), odd = steepest(s, EVEN), even = steepest(s, ODD);
  if (!s->known[at]) return;
  double largest = (s->fit[ODD][odd].slope + s->fit[EVEN][even].slope) / 2;
  double u = fmax(s->fit[WHOLE][at].u_slope,
                  hypot(s->fit[ODD][odd].u_slope, s->fit[EVEN][even].u_slope) / 2);
  add_scatter(s, at, scatter);
  if (largest <= direction->stiffness.value) return;
  direction->stiffness = (fg_load_value){largest, NAN, u};
  direction->stiffness_at_mm = s->x[at];
  direction->flags &= ~(unsigned)FG_LOAD_AT_END;
  if (at + 2 >= FG_LOAD_POINTS) direction->flags |= FG_LOAD_AT_END;
}

fg_status fg_load_find_stiffness(fg_context *ctx, const fg_load_strokes *strokes,
                                 fg_load_direction *direction, fg_load_findings *findings) {
  direction->stiffness.value = -INFINITY;
  direction->stiffness_at_mm = NAN;
  for (int which = 0; which < FG_LOAD_SIDES; which++) {
    side *s;
    FG_TRY(fg_memory_allocate(ctx, 1, sizeof *s, (void **)&s));
    fg_status status = choose_side_strokes(ctx, strokes, direction, which, s);
    if (status == FG_OK && s->count) status = make_parts(ctx, s);
    if (status == FG_OK && s->count) {
      place_points(direction, which, strokes->noise_mm, s);
      fit_slopes(s);
      write_stiffness_profile(s, &direction->profile[which]);
      keep_largest(s, direction, &findings->slopes);
    }
    free_side(s);
    FG_TRY(status);
  }
  if (direction->stiffness.value == -INFINITY)
    direction->stiffness = (fg_load_value){NAN, NAN, NAN};
  return FG_OK;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Load cell's zero: its reading where no foil pulls. */
#include <math.h>

#include "load_test/analysis.h"
#include "load_test/local_fit.h"

/* Number of places between the ends that up and down strokes share, less a share of the travel at
 * each end; windows as shares of it, of which the narrowest with samples is used. */
enum { PLACES = 49 };
static const double end_left_out = 0.05, window_share = 1.0 / 16, window_share_max = 0.25;

/* Maximum ratio of smallest to largest slope for a visible gap: a foil's stiffness alone may vary
 * by that. */
static const double flat_share = 0.5;

/* Slope above the smallest one, as a share of the largest, up to which places belong to the gap; a
 * mean over them scatters less than one place. */
static const double gap_share = 0.05;

static bool fit_at(const fg_load_stroke *stroke, double x, double span, fg_local_fit *fit) {
  for (double share = window_share; share <= window_share_max; share *= 2)
    if (fg_local_fit_at(stroke, x, share * span, fit)) return true;
  return fg_local_across(stroke, x, fit);
}

/* Forces of both senses where both are known, and the slope of their mean. */
typedef struct mean_curve {
  double x[PLACES], middle[PLACES], half[PLACES], u[PLACES], slope[PLACES], min, max;
  size_t count;
} mean_curve;

static void compare_forces(const fg_load_stroke *up, const fg_load_stroke *down, mean_curve *c) {
  double low = fmax(up->x[0], down->x[0]);
  double high = fmin(up->x[up->count - 1], down->x[down->count - 1]);
  *c = (mean_curve){.min = INFINITY};
  for (size_t k = 0; k < PLACES && high > low; k++) {
    double share = end_left_out + (1 - 2 * end_left_out) * (double)k / (PLACES - 1);
    double x = low + share * (high - low);
    fg_local_fit a, b;
    if (!fit_at(up, x, high - low, &a) || !fit_at(down, x, high - low, &b)) continue;
    c->x[c->count] = x;
    c->middle[c->count] = (a.value + b.value) / 2;
    c->half[c->count] = (a.value - b.value) / 2;
    c->u[c->count] = hypot(a.u_value, b.u_value) / 2;
    c->slope[c->count] = fabs(a.slope + b.slope) / 2;
    c->min = fmin(c->min, c->slope[c->count]);
    c->max = fmax(c->max, c->slope[c->count]);
    c->count++;
  }
}

static bool is_flat(const mean_curve *c, size_t k) {
  return c->slope[k] <= c->min + gap_share * c->max;
}

/* Averages over the middle half of the flat places: windows of the others reach to the foils.
 * Neighbouring places share samples, so the mean's u is that of one of them. */
static fg_load_zero mean_of_gap(const mean_curve *c) {
  fg_load_zero zero = {0, 0, 0, 0};
  double count = 0, first = INFINITY, last = -INFINITY;
  if (!(c->min < flat_share * c->max)) return (fg_load_zero){NAN, NAN, NAN, NAN};
  for (size_t k = 0; k < c->count; k++) {
    if (!is_flat(c, k)) continue;
    first = fmin(first, c->x[k]), last = fmax(last, c->x[k]);
  }
  double quarter = (last - first) / 4;
  for (size_t k = 0; k < c->count; k++) {
    if (!is_flat(c, k) || c->x[k] < first + quarter || c->x[k] > last - quarter) continue;
    zero.force_n += c->middle[k];
    zero.friction_n += c->half[k];
    zero.place_mm += c->x[k];
    zero.u_n += c->u[k];
    count++;
  }
  if (!(count > 0)) return (fg_load_zero){NAN, NAN, NAN, NAN};
  return (fg_load_zero){zero.force_n / count, zero.friction_n / count, zero.place_mm / count,
                        zero.u_n / count};
}

fg_status fg_load_find_zero(fg_context *ctx, const fg_load_strokes *strokes, fg_load_zero *zero) {
  fg_load_stroke up = {0}, down = {0};
  mean_curve c;
  fg_status status = FG_OK;
  *zero = (fg_load_zero){NAN, NAN, NAN, NAN};
  FG_TRY_EXIT(fg_load_strokes_merge_sense(ctx, strokes, 1, &up));
  FG_TRY_EXIT(fg_load_strokes_merge_sense(ctx, strokes, -1, &down));
  if (up.count && down.count) {
    compare_forces(&up, &down, &c);
    *zero = mean_of_gap(&c);
  }
exit:
  fg_load_stroke_free(&up);
  fg_load_stroke_free(&down);
  return status;
}

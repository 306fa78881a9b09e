/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One profile across an edge as shares of its contrast. */
#include "vision/picture_profile.h"

#include <math.h>
#include <stdbool.h>

#include "core/spread.h"

enum { BINS_MAX = 256 };
/* Min contrast of an edge, counts. */
#define CONTRAST_MIN 6.0

/* Distance of a bin from the source's middle, outwards. */
static double distance_outwards(const fg_profile_source *s, const fg_profile_bin *bin) {
  return s->way * (bin->across_px - s->middle_px);
}

/* The i-th bin from the material to the background. */
static const fg_profile_bin *bin_at(const fg_profile_source *s, size_t i) {
  return &s->bins[s->way > 0 ? i : s->count - 1 - i];
}

/* Distance outwards of the last bin that has pixels; an empty bin has no place. */
static double last_distance(const fg_profile_source *s) {
  for (size_t i = s->count; i-- > 0;)
    if (bin_at(s, i)->count > 0) return distance_outwards(s, bin_at(s, i));
  return NAN;
}

/* Median value of the bins between two distances outwards. */
static double level_between(const fg_profile_source *s, double from, double to) {
  double values[BINS_MAX];
  size_t n = 0;
  for (size_t i = 0; i < s->count && n < BINS_MAX; i++) {
    double at = distance_outwards(s, &s->bins[i]);
    if (s->bins[i].count > 0 && at >= from && at <= to) values[n++] = s->bins[i].value;
  }
  return fg_upper_median(values, n);
}

/* Returns the first crossing of the middle of the profile's levels, outwards. */
static double find_crossing(const fg_profile_source *s, double inside, double outside) {
  double half = 0.5 * (inside + outside), sign = outside > inside ? 1 : -1;
  const fg_profile_bin *last = NULL;
  for (size_t i = 0; i < s->count; i++) {
    const fg_profile_bin *bin = bin_at(s, i);
    if (bin->count <= 0 || distance_outwards(s, bin) < -s->plateau_px) continue;
    double rise = last ? bin->value - last->value : 0;
    if (last && sign * (last->value - half) < 0 && sign * (bin->value - half) >= 0)
      return s->way * (last->across_px - s->middle_px +
                       (half - last->value) / rise * (bin->across_px - last->across_px));
    last = bin;
  }
  return NAN;
}

bool fg_edge_profile_make(const fg_profile_source *s, fg_edge_profile *profile) {
  double inside = level_between(s, -s->plateau_px, s->plateau_px);
  double outside = level_between(s, last_distance(s) - s->reach_px, INFINITY);
  double edge = find_crossing(s, inside, outside);
  if (!(fabs(outside - inside) > CONTRAST_MIN) || isnan(edge)) return false;
  double sums[FG_SHARES] = {0}, counts[FG_SHARES] = {0};
  for (size_t i = 0; i < s->count; i++) {
    const fg_profile_bin *bin = &s->bins[i];
    double at = (distance_outwards(s, bin) - edge) / FG_SHARE_STEP_PX + FG_SHARES_INSIDE;
    if (bin->count <= 0 || !(at >= 0 && at < FG_SHARES)) continue;
    sums[(size_t)at] += bin->count * (bin->value - outside) / (inside - outside);
    counts[(size_t)at] += bin->count;
  }
  for (size_t i = 0; i < FG_SHARES; i++)
    profile->shares[i] = counts[i] > 0 ? (float)(sums[i] / counts[i]) : NAN;
  profile->bearing = s->bearing;
  profile->inside = inside;
  profile->outside = outside;
  profile->blur_px = s->blur_px;
  profile->background = (float)((s->background - outside) / (inside - outside));
  profile->inside_px = edge;
  return true;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Possible shift of an edge whose profile an end of the scale cuts.
 *
 * The cut part is not visible, except by the abrupt end of the profile. Let shares a (towards the
 * background) and b (towards the material) of a Gaussian edge's contrast be cut. Share v of the
 * remainder is then light a + (1 - a - b) v, and lies at x(v) = c + s z(a + (1 - a - b) v) with z
 * the normal quantile. Every pair (a, b) that the mean profile allows gives a place of half the
 * light: s z(1/2 + (a - b)/2) from the half of the remainder. The uncertainty follows from the
 * largest of these shifts. */
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdbool.h>

#include "vision/picture.h"
#include "vision/picture_profile.h"

enum { PLACES = 10, CUTS = 20 };
/* Places of the least light, or of the most, which are left out where that end of the scale cuts
 * nothing: a wall or a lens stretches it far beyond the blur, which tells nothing of the other end.
 */
enum { TAIL_PLACES = 2 };
/* Min share of the contrast that shows a profile. */
#define VISIBLE_MIN 0.01
/* Max misfit beyond the best, root mean square, as a share of the profile's own width: lenses and
 * the tone curve before the cut bend it by as much. */
#define MISFIT_SHARE 0.02
/* A picture that shows less than a quarter of an edge's width is one of few levels. */
#define BLURS_MAX 4.0
/* Ratio of the sd to the largest allowed shift: a uniform distribution up to it would give 1
 * / 1.73. */
#define SD_OF_LARGEST 0.6

typedef struct cut_profile {
  double px[PLACES]; /* places of the shares, outwards */
  bool open[2];      /* background and material may be cut */
  int first, last;   /* places in use */
  double width_px;   /* of these */
  double blurs;      /* the same of an uncut edge, over its blur */
} cut_profile;

/* One pair of cuts: its misfit to the profile, and its place of half the light. */
typedef struct cut_fit {
  double misfit_px, shift_px;
} cut_fit;

/* Returns the i-th cut to be tried. They are closer where little remains, as blur and shift change
 * most there. */
static double cut_at(int i) {
  return 1 - pow(1 - (double)i / CUTS, 1.5);
}

static double share_at(int place) {
  return (place + 0.5) / PLACES;
}

static double mean_share(const fg_edge_profile *profiles, size_t count, size_t i) {
  double sum = 0, n = 0;
  for (size_t k = 0; k < count; k++) {
    if (isnan(profiles[k].shares[i]) || -fg_share_px(i) > profiles[k].inside_px) continue;
    sum += (double)profiles[k].shares[i];
    n++;
  }
  return n > 0 ? sum / n : NAN;
}

/* Place outwards from the edge's middle (way 1), or inwards, where the mean passes a share. */
static double find_share(const double *shares, double share) {
  int way = share < 0.5 ? 1 : -1, i = FG_SHARES_INSIDE - (way > 0);
  while (i - way >= 0 && i - way < FG_SHARES && way * (shares[i] - share) < 0)
    i -= way;
  for (; i + way >= 0 && i + way < FG_SHARES; i += way) {
    double here = shares[i], next = shares[i + way];
    if (isnan(next)) return NAN;
    if (way * (next - share) <= 0)
      return fg_share_px((size_t)i) + way * FG_SHARE_STEP_PX * (here - share) / (here - next);
  }
  return NAN;
}

static bool make_cut_profile(const fg_edge_profile *profiles, size_t count,
                             const fg_picture_state *state, cut_profile *profile) {
  double shares[FG_SHARES], bright = 0;
  for (size_t i = 0; i < FG_SHARES; i++)
    shares[i] = mean_share(profiles, count, i);
  for (size_t k = 0; k < count; k++)
    bright += profiles[k].inside > profiles[k].outside ? 1 : -1;
  for (int p = 0; p < PLACES; p++) {
    profile->px[p] = find_share(shares, share_at(p));
    if (isnan(profile->px[p])) return false;
  }
  bool low = state->clipped_low > 0, high = state->clipped_high > 0;
  profile->open[0] = (bright > 0 ? low : high) || !(low || high);
  profile->open[1] = (bright > 0 ? high : low) || !(low || high);
  profile->first = profile->open[0] ? 0 : TAIL_PLACES;
  profile->last = PLACES - 1 - (profile->open[1] ? 0 : TAIL_PLACES);
  profile->width_px = fabs(profile->px[profile->last] - profile->px[profile->first]);
  profile->blurs = gsl_cdf_ugaussian_Pinv(share_at(profile->last)) -
                   gsl_cdf_ugaussian_Pinv(share_at(profile->first));
  return true;
}

/* Regression of the places on the quantiles of their light. */
static cut_fit fit_cuts(const cut_profile *profile, double a, double b) {
  double z[PLACES], mean_z = 0, mean_x = 0, zz = 0, zx = 0, misfit = 0;
  double n = profile->last + 1 - profile->first;
  for (int p = profile->first; p <= profile->last; p++) {
    z[p] = gsl_cdf_ugaussian_Pinv(a + (1 - a - b) * share_at(p));
    mean_z += z[p] / n;
    mean_x += profile->px[p] / n;
  }
  for (int p = profile->first; p <= profile->last; p++) {
    zz += (z[p] - mean_z) * (z[p] - mean_z);
    zx += (z[p] - mean_z) * (profile->px[p] - mean_x);
  }
  double slope = zx / zz; /* negative: the light falls outwards */
  for (int p = profile->first; p <= profile->last; p++) {
    double miss = profile->px[p] - mean_x - slope * (z[p] - mean_z);
    misfit += miss * miss / n;
  }
  double seen = profile->width_px / profile->blurs;
  double blur = fmax(fmin(fabs(slope), BLURS_MAX * seen), FG_HIDDEN_BLUR_PX);
  return (cut_fit){sqrt(misfit), blur * fabs(gsl_cdf_ugaussian_Pinv(0.5 + 0.5 * (a - b)))};
}

/* Returns the largest shift of the cuts whose misfit is within a limit. */
static double largest_shift(const cut_profile *profile, double limit_px, double *best_px) {
  double largest = 0;
  *best_px = INFINITY;
  for (int i = 0; i < (profile->open[0] ? CUTS : 1); i++)
    for (int j = 0; j < (profile->open[1] ? CUTS : 1); j++) {
      double a = cut_at(i), b = cut_at(j);
      if (1 - a - b < VISIBLE_MIN) continue;
      cut_fit fit = fit_cuts(profile, a, b);
      *best_px = fmin(*best_px, fit.misfit_px);
      if (fit.misfit_px <= limit_px) largest = fmax(largest, fit.shift_px);
    }
  return largest;
}

void fg_picture_inspect_cut(const fg_edge_profile *profiles, size_t count, double blur_px,
                            fg_picture_state *state) {
  cut_profile profile;
  double per_level = blur_px * sqrt(2 * M_PI), best;
  state->seen_blur = fmin(1, blur_px / FG_HIDDEN_BLUR_PX);
  if (!(state->findings & FG_PICTURE_CLIPPED)) return;
  /* Without a usable profile half of the scale or more may be cut. */
  double shift = FG_HIDDEN_BLUR_PX * gsl_cdf_ugaussian_Pinv(1 - VISIBLE_MIN / 2);
  if (make_cut_profile(profiles, count, state, &profile)) {
    largest_shift(&profile, 0, &best);
    shift = largest_shift(&profile, best + MISFIT_SHARE * profile.width_px, &best);
  }
  state->u_cut = SD_OF_LARGEST * shift / per_level;
}

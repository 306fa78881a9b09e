/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Profiles across an edge: levels where bins are empty, and of one that an end of the scale cuts no
 * edge place that it hides. */
#include <math.h>

#include <gsl/gsl_cdf.h>

#include "support/test.h"
#include "vision/picture.h"

#define BLUR_PX 1.3

/* A Gaussian edge of which only the light between a and 1 - b is seen. */
static fg_edge_profile cut_edge(double a, double b, int bright) {
  fg_edge_profile profile = {.inside = bright ? 255 : 0, .outside = bright ? 0 : 255};
  double middle = -BLUR_PX * gsl_cdf_ugaussian_Pinv(0.5 * (1 + a - b));
  profile.inside_px = 12;
  for (size_t i = 0; i < FG_SHARES; i++) {
    double light = gsl_cdf_ugaussian_P(-(fg_share_px(i) + middle) / BLUR_PX);
    profile.shares[i] = (float)fmin(fmax((light - a) / (1 - a - b), 0), 1);
  }
  return profile;
}

/* Light of a wall beyond the edge: a quarter of it, that falls slowly. */
static void add_wall(fg_edge_profile *profile) {
  for (size_t i = FG_SHARES_INSIDE; i < FG_SHARES; i++)
    profile->shares[i] = fmaxf(profile->shares[i], (float)(0.25 * exp(-fg_share_px(i) / 5)));
}

/* Standard uncertainty of the place of a profile's edge, px. */
static double u_of_profile(const fg_edge_profile *profile, double a, double b, int bright) {
  fg_picture_state state = fg_picture_unknown();
  state.findings = FG_PICTURE_CLIPPED;
  state.clipped_low = bright ? a > 0 : b > 0;
  state.clipped_high = bright ? b > 0 : a > 0;
  fg_picture_inspect_cut(profile, 1, 0.7, &state);
  return state.u_cut * 0.7 * sqrt(2 * M_PI);
}

static double u_px(double a, double b, int bright) {
  fg_edge_profile profile = cut_edge(a, b, bright);
  return u_of_profile(&profile, a, b, bright);
}

static void u_of_a_cut_covers_the_edge_and_grows_with_the_cut(void **unused) {
  (void)unused;
  for (int bright = 0; bright < 2; bright++)
    for (int both = 0; both < 2; both++) {
      double before = 0;
      for (int step = 1; step <= 9; step++) {
        double a = 0.1 * step, b = both ? 0.08 : 0;
        double off = BLUR_PX * fabs(gsl_cdf_ugaussian_Pinv(0.5 * (1 + a - b)));
        double u = u_px(a, b, bright), other = u_px(b, a, bright);
        if (!(2 * u >= off) || !(2 * other >= off))
          fail_msg("cut %.1f and %.1f: %.3f px off at u %.3f, %.3f", a, b, off, u, other);
        if (!both && !(u >= 0.8 * before)) fail_msg("cut %.1f: u %.3f after %.3f", a, u, before);
        before = u;
      }
    }
}

static void a_small_cut_adds_little_uncertainty(void **unused) {
  (void)unused;
  assert_true(u_px(0.05, 0, 1) < 0.6);
}

static void a_wall_beyond_the_edge_is_no_cut_of_the_other_end(void **unused) {
  (void)unused;
  for (int bright = 0; bright < 2; bright++)
    for (int step = 1; step <= 7; step++) {
      double b = 0.1 * step, off = BLUR_PX * fabs(gsl_cdf_ugaussian_Pinv(0.5 * (1 - b)));
      fg_edge_profile profile = cut_edge(0, b, bright);
      add_wall(&profile);
      double u = u_of_profile(&profile, 0, b, bright);
      if (!(2 * u >= off) || u > 3 * BLUR_PX)
        fail_msg("cut %.1f beside a wall: %.3f px off at u %.3f", b, off, u);
    }
}

enum { BINS = 81 };

/* Returns the profile of bins 0.25 px apart from -10 to 10 px, an edge at 4 px; `empty` of the
 * outermost ones hold no pixel. */
static fg_edge_profile stacked_edge(int way, int empty) {
  fg_profile_bin bins[BINS] = {{0}};
  for (int i = 0; i < BINS - empty; i++) {
    double across = -10 + 0.25 * i;
    double light = 180 - 150 * gsl_cdf_ugaussian_P((across - 4) / BLUR_PX);
    bins[way > 0 ? i : BINS - 1 - i] = (fg_profile_bin){way * across, light, 20};
  }
  const fg_profile_source source = {
      .bins = bins, .count = BINS, .way = way, .plateau_px = 1, .reach_px = 2.5, .background = 30};
  fg_edge_profile profile = {0};
  assert_true(fg_edge_profile_make(&source, &profile));
  return profile;
}

static void empty_outer_bins_leave_the_outer_level(void **unused) {
  (void)unused;
  for (int way = -1; way <= 1; way += 2)
    for (int empty = 0; empty <= 2; empty++) {
      fg_edge_profile profile = stacked_edge(way, empty);
      assert_near(profile.outside, 30, 0.5);
      assert_near(profile.background, 0, 0.01);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(empty_outer_bins_leave_the_outer_level),
      cmocka_unit_test(u_of_a_cut_covers_the_edge_and_grows_with_the_cut),
      cmocka_unit_test(a_small_cut_adds_little_uncertainty),
      cmocka_unit_test(a_wall_beyond_the_edge_is_no_cut_of_the_other_end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

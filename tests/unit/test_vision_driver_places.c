/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts of a driver's model: the light against the model's own integrals, and values that vary
 * against values found anew. */

#include "support/test.h"
#include "vision/driver_places.h"

enum { PLACES = 161 };
#define FROM_PX (-20.0)

static const double ends[2] = {30, 205};
static const double values[FG_DRIVEN_VALUES] = {-9.3, 9.6, 190, 40, 45, 0.2, -0.3, 1.3, 1.7};

static void set_places(bool single, fg_driven_places *places) {
  fg_driven_places_of_grid(FROM_PX, PLACES, single, 1.3, places);
}

static void find_anew(const fg_driver *driver, const double *at, bool single, double *counts) {
  fg_driven_places places;
  static fg_driver_tone tone;
  fg_context ctx;
  fg_driver_tone_fill(driver, &tone);
  assert_ok(&ctx, fg_driven_places_create(&ctx, 0, true, &places));
  set_places(single, &places);
  fg_driven_places_keep(driver, &tone, at, true, &places, counts);
  fg_driven_places_free(&places);
}

/* A blurred step with slope and halo. */
typedef struct step {
  double blur, halo, halo_px, height, slope;
} step;

/* The mean over the blur, from `low` to `high` sd, of the light that is not blurred. */
static double sum_between(const step *s, double d, double low, double high) {
  enum { CELLS = 2000 };
  double sum = 0, width = (high - low) / CELLS;
  for (int i = 0; i < CELLS; i++) {
    double t = low + (i + 0.5) * width, at = d - s->blur * t, beyond = at > 0;
    double weight = width * exp(-0.5 * t * t) / sqrt(2 * M_PI),
           tail = 0.5 * exp(-fabs(at) / s->halo_px);
    double spread = at > 0 ? 1 - tail : tail;
    sum +=
        weight * (beyond * (s->height + s->slope * at) + s->halo * s->height * (spread - beyond));
  }
  return sum;
}

/* The cells end at the edge, where the light jumps. */
static double light_by_sum(const step *s, double d) {
  double jump = fmin(fmax(d / s->blur, -8), 8);
  return sum_between(s, d, -8, jump) + sum_between(s, d, jump, 8);
}

static void test_light_is_the_blurred_step(void **state) {
  (void)state;
  fg_driver driver = fg_driver_none(ends);
  double counts[PLACES];
  driver.values[FG_DRIVER_HALO] = 0.1;
  driver.values[FG_DRIVER_HALO_PX] = 6;
  find_anew(&driver, values, false, counts);
  for (int i = 0; i < PLACES; i++) {
    double across = FROM_PX + i * FG_DRIVEN_STEP_PX, expected = values[FG_DRIVEN_PLATEAU];
    for (int side = 0; side < 2; side++) {
      step of = {values[FG_DRIVEN_BLUR_L + side], 0.1, 6,
                 values[FG_DRIVEN_LEVEL_L + side] - values[FG_DRIVEN_PLATEAU],
                 values[FG_DRIVEN_SLOPE_L + side]};
      expected += light_by_sum(&of, (side ? 1 : -1) * (across - values[FG_DRIVEN_LEFT + side]));
    }
    assert_near(counts[i], expected, 1e-4);
  }
}

/* The normal distribution against that of the C library; beyond 6 sd it is 0 or 1. */
static void test_shares_are_of_the_normal_distribution(void **state) {
  (void)state;
  enum { COUNT = 2001 };
  static double across[COUNT], arrays[4][COUNT];
  fg_lit lit = {.edge = {0, 0}, .blur = {1, 1}, .halo_px = 0.8};
  fg_lit_side side = {
      .outwards = arrays[0], .cumulative = arrays[1], .density = arrays[2], .loss = arrays[3]};
  for (int i = 0; i < COUNT; i++)
    across[i] = (i - COUNT / 2) * 0.00731;
  fg_lit_side_fill(&lit, 1, true, across, COUNT, &side);
  for (int i = 0; i < COUNT; i++) {
    double t = across[i], r = 1 / 0.8;
    double near = 0.5 * exp(0.5 * r * r - t * r) * erfc((r - t) * M_SQRT1_2);
    double far = 0.5 * exp(0.5 * r * r + t * r) * erfc((r + t) * M_SQRT1_2);
    double limit = fabs(t) < 6 ? 2e-11 : 2e-8;
    assert_near(side.cumulative[i], 0.5 * erfc(-t * M_SQRT1_2), limit);
    assert_near(side.density[i], exp(-0.5 * t * t) / sqrt(2 * M_PI), limit);
    assert_near(side.loss[i], 0.5 * (near - far), limit);
  }
}

static void check_vary(const fg_driver *kept, const fg_driver *driver, const double *at,
                       bool single) {
  double counts[PLACES], anew[PLACES];
  static fg_driver_tone tone, other;
  fg_driven_places places;
  fg_context ctx;
  fg_driver_tone_fill(kept, &tone);
  fg_driver_tone_fill(driver, &other);
  assert_ok(&ctx, fg_driven_places_create(&ctx, 0, true, &places));
  set_places(single, &places);
  fg_driven_places_keep(kept, &tone, values, true, &places, counts);
  fg_driven_places_vary(driver, &other, at, &places, counts);
  find_anew(driver, at, single, anew);
  for (int i = 0; i < PLACES; i++)
    assert_near(counts[i], anew[i], 1e-11);
  fg_driven_places_free(&places);
}

static void test_varied_values_are_found_as_anew(void **state) {
  (void)state;
  fg_driver kept = fg_driver_none(ends);
  const double start[FG_DRIVER_VALUES] = {0.2, 3, 0.45, 0.4, 1.1, 0.1, 8};
  memcpy(kept.values, start, sizeof start);
  for (int amount = 0; amount < 2; amount++) {
    kept.values[FG_DRIVER_AMOUNT] = amount * 0.4;
    for (int single = 0; single < 2; single++) {
      for (int i = 0; i < FG_DRIVER_VALUES; i++) {
        fg_driver driver = kept;
        driver.values[i] += 0.05;
        check_vary(&kept, &driver, values, single);
      }
      for (int i = 0; i < FG_DRIVEN_VALUES; i++) {
        double at[FG_DRIVEN_VALUES];
        memcpy(at, values, sizeof at);
        at[i] += 0.05;
        check_vary(&kept, &kept, at, single);
      }
    }
  }
}

/* Dust may leave a stretch without a single pixel. */
static void test_a_profile_without_bins_is_not_fitted(void **state) {
  (void)state;
  fg_context ctx;
  fg_profile_bin bins[1] = {{1e300, 0, 0}};
  fg_driven_profile profile = {.bins = bins};
  fg_driver_fit fit = {.driver = fg_driver_none(ends), .noise = 1};
  memcpy(profile.values, values, sizeof values);
  fit.driver.values[FG_DRIVER_AMOUNT] = 0.5;
  assert_ok(&ctx, fg_driver_fit_profiles(&ctx, &profile, 1, &fit));
  assert_false(fit.good);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_light_is_the_blurred_step),
      cmocka_unit_test(test_shares_are_of_the_normal_distribution),
      cmocka_unit_test(test_varied_values_are_found_as_anew),
      cmocka_unit_test(test_a_profile_without_bins_is_not_fitted),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

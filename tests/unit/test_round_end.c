/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light about the round end of a cut: against a sum over a fine grid, and of ends whose light is
 * known in closed form. Measured ends: tests/cli/test_beams.sh. */
#include <math.h>
#include <stdio.h>

#include <gsl/gsl_cdf.h>

#include "geometry/beam_line.h"
#include "support/test.h"
#include "vision/round_end.h"

/* The light of the cut by a sum over cells of the blur. */
static double light_by_grid(const fg_round_end *e, double u, double v) {
  const double step = 0.02, reach = 6;
  double sum = 0;
  for (double a = -reach + 0.5 * step; a < reach; a += step)
    for (double b = -reach + 0.5 * step; b < reach; b += step) {
      double x = u + a * e->blur_along, y = v + b * e->blur_across;
      bool in_cut = fabs(y) < e->half_width && x < sqrt(fmax(0, e->radius * e->radius - y * y));
      if (in_cut) sum += exp(-0.5 * (a * a + b * b));
    }
  return sum * step * step / (2 * M_PI);
}

static void light_is_that_of_the_blurred_cut(void **unused) {
  (void)unused;
  const fg_round_end ends[] = {{4.7, 4.7, 1.2, 1.2},
                               {3, 3, 1.2, 1.2},
                               {9, 4.7, 1, 1.5},
                               {37, 4.7, 1.2, 1.2},
                               {4, 5, 1.3, 1}};
  for (size_t k = 0; k < sizeof ends / sizeof *ends; k++)
    for (double u = 1; u < 10; u += 2.3)
      for (double v = 0; v < 5; v += 2.1) {
        double grid = light_by_grid(&ends[k], u, v);
        double light =
            gsl_cdf_ugaussian_P(fg_round_end_distance(&ends[k], u, v) / ends[k].blur_along);
        if (fabs(light - grid) > 4e-3) fail_msg("end %zu, %g %g: %g, %g", k, u, v, light, grid);
      }
}

/* A wide flat end is a straight edge. Where the arc is wide against the blur, the edge lies
 * s²/2R towards the centre. */
static void wide_ends_are_straight_or_moved_by_their_curvature(void **unused) {
  (void)unused;
  const fg_round_end flat = {1e6, 100, 1.2, 1.2}, wide = {60, 60, 1.2, 1.2};
  for (double d = -3; d <= 3; d += 0.5)
    assert_near(fg_round_end_distance(&flat, 1e6 - d, 3), d, 1e-4);
  assert_near(fg_round_end_distance(&wide, 60, 0), -1.2 * 1.2 / 120, 1e-4);
}

/* The light is never more than that between two straight edges. */
static void narrow_cuts_do_not_reach_the_light_of_the_void(void **unused) {
  (void)unused;
  const fg_round_end narrow = {2.4, 2.4, 1.2, 1.2};
  double between = gsl_cdf_ugaussian_P(2) - gsl_cdf_ugaussian_Q(2);
  double max = 1.2 * gsl_cdf_ugaussian_Pinv(between);
  assert_near(fg_round_end_distance(&narrow, -20, 0), max, 1e-4);
  assert_true(fg_round_end_distance(&narrow, 0, 0) < max);
}

/* Stations on an arc about (2, 1), the tip towards +y. */
static void the_apex_of_an_arc_is_found(void **unused) {
  (void)unused;
  enum { STATIONS = 12 };
  const double radius = 0.1, half = 1.1;
  for (int turned = 0; turned < 2; turned++) {
    fg_disc_point stations[STATIONS];
    fg_context ctx = {0};
    fg_beam_line line;
    for (int i = 0; i < STATIONS; i++) {
      double f = half * (2 * (i + 0.5) / STATIONS - 1) * (turned ? -1 : 1);
      stations[i] = (fg_disc_point){.at = {2 + radius * sin(f), 1 - radius * cos(f)}, .used = true};
    }
    const fg_beam_edge edge = {
        .stations = stations, .count = STATIONS, .round = true, .radius_mm = 1.002 * radius};
    assert_int_equal(fg_beam_line_fit(&ctx, &edge, (fg_point){0, 1}, &line), FG_OK);
    assert_near(line.at.y, 1 - radius, 1e-8);
    assert_near(line.at.x, 2, 1e-8);
    fg_beam_line_free(&line);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(light_is_that_of_the_blurred_cut),
      cmocka_unit_test(wide_ends_are_straight_or_moved_by_their_curvature),
      cmocka_unit_test(the_apex_of_an_arc_is_found),
      cmocka_unit_test(narrow_cuts_do_not_reach_the_light_of_the_void),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

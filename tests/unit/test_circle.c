/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Circle fits on points of known circles: bias, covariance, optimisers against each other, bad
 * starts, input that has no circle. */
#include <math.h>
#include <string.h>

#include "foilgauge/circle.h"
#include "support/random.h"
#include "support/test.h"

enum { N = 300, TRIALS = 3000 };

static const double pi = 3.14159265358979323846;

/* `count` points of an arc about `middle_rad`, evenly spread, with isotropic noise. */
static void make_arc(fg_point *points, size_t count, fg_circle circle, double middle_rad,
                     double width_rad, double noise, uint64_t *seed) {
  for (size_t i = 0; i < count; i++) {
    double angle = middle_rad + width_rad * (((double)i + 0.5) / (double)count - 0.5);
    points[i].x = circle.x + circle.radius * cos(angle);
    points[i].y = circle.y + circle.radius * sin(angle);
    if (noise > 0) {
      points[i].x += noise * random_gaussian(seed);
      points[i].y += noise * random_gaussian(seed);
    }
  }
}

/* Kåsa: least squares on x² + y² = 2 a x + 2 b y + c, on centred points. */
static double kasa_radius(const fg_point *points, size_t count) {
  double mx = 0, my = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, n = (double)count;
  for (size_t i = 0; i < count; i++) {
    mx += points[i].x / n;
    my += points[i].y / n;
  }
  for (size_t i = 0; i < count; i++) {
    double x = points[i].x - mx, y = points[i].y - my, z = x * x + y * y;
    xx += x * x, xy += x * y, yy += y * y, xz += x * z, yz += y * z;
  }
  double determinant = xx * yy - xy * xy;
  double a = (xz * yy - yz * xy) / determinant / 2, b = (yz * xx - xz * xy) / determinant / 2;
  return sqrt(a * a + b * b + (xx + yy) / n);
}

static double distance_between(const fg_circle *a, const fg_circle *b) {
  return fmax(fmax(fabs(a->x - b->x), fabs(a->y - b->y)), fabs(a->radius - b->radius));
}

static fg_circle_fit fit_or_fail(const fg_point *points, size_t count, const fg_circle *start) {
  fg_context ctx = {0};
  fg_circle_fit fit;
  if (fg_circle_fit_geometric(&ctx, points, NULL, count, start, &fit) != FG_OK)
    fail_msg("%s", ctx.message);
  return fit;
}

/* 63 degrees, R = 3.32 mm, noise 20 µm: Kåsa's radius is systematically small; the hyper and the
 * geometric fit are not (within four standard errors of their mean). */
static void short_arc_is_not_biased(void **state) {
  (void)state;
  uint64_t seed = 1;
  const fg_circle truth = {12, -7, 3.32};
  double sums[3] = {0}, squares[3] = {0};
  for (int trial = 0; trial < TRIALS; trial++) {
    fg_point points[N];
    fg_circle hyper;
    make_arc(points, N, truth, 0.7, 63.15 * pi / 180, 0.02, &seed);
    assert_ok(&test_context, fg_circle_estimate(&test_context, points, NULL, N, &hyper));
    fg_circle_fit fit = fit_or_fail(points, N, NULL);
    double errors[3] = {kasa_radius(points, N) - truth.radius, hyper.radius - truth.radius,
                        fit.circle.radius - truth.radius};
    for (int k = 0; k < 3; k++) {
      sums[k] += errors[k] / TRIALS;
      squares[k] += errors[k] * errors[k] / TRIALS;
    }
  }
  double standard_error = sqrt(squares[2] / TRIALS);
  assert_true(sums[0] < -20 * standard_error);
  assert_true(fabs(sums[1]) < 4 * standard_error);
  /* The orthogonal fit's own second-order bias is +sigma²/(2 R) and what curvature adds to it. */
  assert_true(fabs(sums[2]) < 4 * standard_error);
}

/* The covariance that is returned against that of the fits themselves; the crown is the combination
 * in which R and the centre nearly cancel. */
static void covariance_is_that_of_the_fits(void **state) {
  (void)state;
  uint64_t seed = 2;
  const double middle = 2.1, noise = 0.002;
  const fg_circle truth = {-3, 40, 3.32};
  double u[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {cos(middle), sin(middle), 1}};
  double variance[4] = {0}, expected[4] = {0};
  for (int trial = 0; trial < TRIALS; trial++) {
    fg_point points[N];
    make_arc(points, N, truth, middle, 63.15 * pi / 180, noise, &seed);
    fg_circle_fit fit = fit_or_fail(points, N, &truth);
    double error[3] = {fit.circle.x - truth.x, fit.circle.y - truth.y,
                       fit.circle.radius - truth.radius};
    for (int k = 0; k < 4; k++) {
      double along = u[k][0] * error[0] + u[k][1] * error[1] + u[k][2] * error[2];
      variance[k] += along * along / TRIALS;
      for (int i = 0; i < 9; i++)
        expected[k] +=
            noise * noise * u[k][i / 3] * fit.covariance[i / 3][i % 3] * u[k][i % 3] / TRIALS;
    }
  }
  /* The variance of a variance from 3000 trials is worth 2.6 %. */
  for (int k = 0; k < 4; k++)
    assert_true(fabs(variance[k] / expected[k] - 1) < 0.1);
  /* The uncertainties of R and of the crown of such an arc differ by a factor of 17; were the
   * correlation lost, the crown would come out as bad as R. */
  assert_true(expected[3] < 0.01 * expected[2]);
}

/* 2 nm, in mm, over arcs of 20 to 360 degrees with 1 µm noise. */
static void optimisers_agree(void **state) {
  (void)state;
  uint64_t seed = 3;
  for (int trial = 0; trial < 300; trial++) {
    fg_point points[N];
    fg_circle_fit simplex, levenberg;
    fg_circle truth = {100 * random_uniform(&seed), 100 * random_uniform(&seed),
                       1 + 20 * random_uniform(&seed)};
    double width = (20 + 340 * random_uniform(&seed)) * pi / 180;
    make_arc(points, N, truth, 2 * pi * random_uniform(&seed), width, 1e-3, &seed);
    simplex = fit_or_fail(points, N, NULL);
    assert_ok(&test_context,
              fg_circle_fit_levenberg(&test_context, points, NULL, N, NULL, &levenberg));
    assert_true(distance_between(&simplex.circle, &levenberg.circle) < 2e-6);
    assert_true(fabs(simplex.rms - levenberg.rms) < 1e-9);
    for (int i = 0; i < 9; i++) {
      double scale = sqrt(simplex.covariance[i / 3][i / 3] * simplex.covariance[i % 3][i % 3]);
      assert_true(fabs(simplex.covariance[i / 3][i % 3] - levenberg.covariance[i / 3][i % 3]) <
                  1e-4 * scale);
    }
    assert_true(simplex.iterations > 0);
  }
}

static void bad_starts_end_at_the_same_minimum(void **state) {
  (void)state;
  uint64_t seed = 4;
  fg_point points[N];
  const fg_circle truth = {5, 6, 3.32};
  make_arc(points, N, truth, -1, 63.15 * pi / 180, 1e-3, &seed);
  fg_circle_fit good = fit_or_fail(points, N, NULL);
  for (int trial = 0; trial < 500; trial++) {
    fg_circle start = {pow(10, 6 * random_uniform(&seed)) * random_gaussian(&seed),
                       pow(10, 6 * random_uniform(&seed)) * random_gaussian(&seed),
                       pow(10, 12 * random_uniform(&seed) - 6)};
    fg_circle_fit fit = fit_or_fail(points, N, &start);
    assert_true(distance_between(&fit.circle, &good.circle) < 1e-10);
  }
  fg_circle senseless[] = {{NAN, 0, 1}, {0, 0, -1}, {0, 0, 0}, {INFINITY, 0, 1}, {0, 0, NAN}};
  for (size_t i = 0; i < sizeof senseless / sizeof *senseless; i++) {
    in_row("senseless[%zu]", i);
    fg_circle_fit fit = fit_or_fail(points, N, &senseless[i]);
    assert_true(distance_between(&fit.circle, &good.circle) < 1e-12);
  }
}

/* Exact points: the answer to the last digits, from 0.5 degrees to a full turn, far from zero. */
static void exact_points_give_exact_circles(void **state) {
  (void)state;
  uint64_t seed = 5;
  const double widths_deg[] = {0.5, 2, 10, 63.15, 180, 300, 360};
  for (size_t k = 0; k < sizeof widths_deg / sizeof *widths_deg; k++) {
    in_row("widths_deg[%zu]", k);
    fg_point points[N];
    const fg_circle truth = {0.25, -0.5, 20.73};
    double width = widths_deg[k] * pi / 180;
    make_arc(points, N, truth, 0.4, width, 0, &seed);
    fg_circle_fit fit = fit_or_fail(points, N, NULL);
    /* Rounding of the coordinates over the sagitta, R w² / 8. */
    double tolerance = 1e-14 * truth.radius * fmax(1, 8 / (width * width));
    assert_true(distance_between(&fit.circle, &truth) < tolerance);
    assert_true(fit.rms < 1e-14 * truth.radius);
  }
}

static void weights_are_repetitions(void **state) {
  (void)state;
  uint64_t seed = 6;
  fg_point points[12], repeated[40];
  double weights[13];
  size_t count = 0;
  make_arc(points, 12, (fg_circle){1, 2, 3}, 0, 2, 0.01, &seed);
  for (size_t i = 0; i < 12; i++) {
    weights[i] = (double)(i % 4);
    for (size_t k = 0; k < i % 4; k++)
      repeated[count++] = points[i];
  }
  fg_circle_fit weighted, plain = fit_or_fail(repeated, count, NULL);
  assert_ok(&test_context,
            fg_circle_fit_geometric(&test_context, points, weights, 12, NULL, &weighted));
  assert_true(distance_between(&weighted.circle, &plain.circle) < 1e-12);
  assert_true(fabs(weighted.rms - plain.rms) < 1e-14);
  for (int i = 0; i < 9; i++)
    assert_true(fabs(weighted.covariance[i / 3][i % 3] - plain.covariance[i / 3][i % 3]) <
                1e-10 * plain.covariance[2][2]);
}

typedef fg_status any_fit(const fg_point *points, const double *weights, size_t count);

static fg_status by_estimate(const fg_point *points, const double *weights, size_t count) {
  fg_circle circle;
  return fg_circle_estimate(NULL, points, weights, count, &circle);
}

static fg_status by_simplex(const fg_point *points, const double *weights, size_t count) {
  fg_circle_fit fit;
  return fg_circle_fit_geometric(NULL, points, weights, count, NULL, &fit);
}

static fg_status by_levenberg(const fg_point *points, const double *weights, size_t count) {
  fg_circle_fit fit;
  return fg_circle_fit_levenberg(NULL, points, weights, count, NULL, &fit);
}

static void no_circle_is_an_error(void **state) {
  (void)state;
  static const struct {
    const char *name;
    fg_point points[5];
    double weights[5];
    size_t count;
  } rows[] = {
      {"no points", {{0, 0}}, {0}, 0},
      {"two points", {{0, 0}, {1, 1}}, {1, 1}, 2},
      {"one place", {{1e3, 1e-3}, {1e3, 1e-3}, {1e3, 1e-3}}, {1, 1, 1}, 3},
      {"two places", {{0, 1}, {0, 1}, {2, 3}, {2, 3}}, {1, 1, 1, 1}, 4},
      {"a line", {{0.1, 0.3}, {0.2, 0.6}, {0.3, 0.9}, {0.7, 2.1}}, {1, 1, 1, 1}, 4},
      {"a line far off",
       {{1e6, 1e6}, {1e6 + 0.1, 1e6 + 0.1}, {1e6 + 0.3, 1e6 + 0.3}},
       {1, 1, 1},
       3},
      {"NaN", {{0, 0}, {1, 0}, {NAN, 1}, {0, 1}}, {1, 1, 1, 1}, 4},
      {"infinite", {{0, 0}, {1, 0}, {INFINITY, 1}, {0, 1}}, {1, 1, 1, 1}, 4},
      {"too large", {{0, 0}, {1e200, 0}, {0, 1e200}, {1e200, 1e200}}, {1, 1, 1, 1}, 4},
      {"two weights", {{0, 0}, {1, 0}, {0, 1}}, {1, 1, 0}, 3},
      {"negative weight", {{0, 0}, {1, 0}, {0, 1}, {2, 2}}, {1, 1, 1, -1}, 4},
      {"NaN weight", {{0, 0}, {1, 0}, {0, 1}, {2, 2}}, {1, 1, 1, NAN}, 4},
  };
  any_fit *const fits[] = {by_estimate, by_simplex, by_levenberg};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
    for (size_t k = 0; k < 3; k++)
      if (fits[k](rows[i].points, rows[i].weights, rows[i].count) != FG_ERR_NUMERIC)
        fail_msg("%s, fit %zu: no error", rows[i].name, k);
}

/* Symmetric about a line, so that bending it either way only makes it worse. */
static void a_better_line_is_an_error(void **state) {
  (void)state;
  const fg_point points[] = {{-1, 0.1}, {-1, -0.1}, {0, 0.1}, {0, -0.1}, {1, 0.1}, {1, -0.1}};
  fg_context ctx = {0};
  fg_circle_fit fit;
  assert_status(&ctx, fg_circle_fit_geometric(&ctx, points, NULL, 6, NULL, &fit), FG_ERR_NUMERIC);
  assert_has(ctx.message, "line");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(short_arc_is_not_biased),
      cmocka_unit_test(covariance_is_that_of_the_fits),
      cmocka_unit_test(optimisers_agree),
      cmocka_unit_test(bad_starts_end_at_the_same_minimum),
      cmocka_unit_test(exact_points_give_exact_circles),
      cmocka_unit_test(weights_are_repetitions),
      cmocka_unit_test(no_circle_is_an_error),
      cmocka_unit_test(a_better_line_is_an_error),
  };
  return cmocka_run_group_tests_name("circle", tests, NULL, NULL);
}

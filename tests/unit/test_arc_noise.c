/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Covariances of fitted arcs against Monte Carlo: white and correlated (AR(1)) noise on known
 * arcs; where arcs end; and which line of the strip is measured. */
#include "support/brief.h"
#include "support/measured_render.h"

#include "core/small_solve.h"
#include "geometry/arcs.h"
#include "support/random.h"
#include "support/test.h"

enum { ARCS = 9, POINTS = 320, TRIALS = 120 };
static const double radius_mm = 3.4, step_mm = 0.0106;

typedef struct arcs_strip {
  fg_strip strip;
  fg_datum_line line;
  fg_range ranges[ARCS];
  fg_arc arcs[ARCS];
} arcs_strip;

/* Nine arcs, each about its own centre; noise with the correlation rho from point to point. */
static void draw_arcs(arcs_strip *a, double sd_mm, double rho, uint64_t *seed) {
  fg_context ctx = {0};
  memset(a, 0, sizeof *a);
  a->strip = (fg_strip){.count = ARCS * POINTS, .step_mm = step_mm, .thickness_mm = 0.1};
  a->strip.stations = calloc(a->strip.count, sizeof *a->strip.stations);
  assert_non_null(a->strip.stations);
  for (size_t k = 0; k < a->strip.count; k++) {
    static double noise;
    size_t arc = k / POINTS, i = k % POINTS;
    noise = i ? rho * noise + sqrt(1 - rho * rho) * random_gaussian(seed) : random_gaussian(seed);
    double angle = ((double)i - 0.5 * POINTS) * step_mm / radius_mm;
    double c = cos(angle), s = sin(angle), r = radius_mm + sd_mm * noise;
    fg_point o = {5.0 * (double)arc, 1};
    a->strip.stations[k] = (fg_station){.s_mm = step_mm * (double)k,
                                        .left = {o.x + (r + 0.05) * c, o.y + (r + 0.05) * s},
                                        .right = {o.x + (r - 0.05) * c, o.y + (r - 0.05) * s},
                                        .normal = {-c, -s},
                                        .weight = 1};
  }
  assert_ok(&ctx, fg_datum_line_build(&ctx, &a->strip, FG_DATUM_MID, true, &a->line));
  for (size_t i = 0; i < ARCS; i++) {
    a->ranges[i] = (fg_range){i * POINTS, (i + 1) * POINTS - 1};
    a->arcs[i] = (fg_arc){.ranges = &a->ranges[i], .range_count = 1};
    assert_ok(&ctx, fg_arc_fit(&ctx, &a->line, &a->arcs[i]));
  }
}

static void free_arcs(arcs_strip *a) {
  fg_datum_line_free(&a->line);
  free(a->strip.stations);
}

/* A (sum over pairs c_|i-j| x_i x_j') A, pair by pair. */
static double radius_variance(const arcs_strip *a, const fg_arc *arc, const fg_noise_model *noise) {
  static double rows[POINTS][3];
  fg_normal_equations system;
  double x[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX], weights[POINTS], sum = 0;
  fg_normal_clear(&system, 3);
  for (size_t i = 0; i < POINTS; i++) {
    const fg_point *p = &a->line.points[arc->ranges[0].first + i];
    double dx = p->x - arc->circle.x, dy = p->y - arc->circle.y, d = hypot(dx, dy);
    const double row[3] = {dx / d, dy / d, 1};
    memcpy(rows[i], row, sizeof row);
    fg_normal_add(&system, row, 0, 1);
  }
  assert_true(fg_normal_solve(&system, 0, x, inverse));
  for (size_t i = 0; i < POINTS; i++)
    weights[i] = inverse[2][0] * rows[i][0] + inverse[2][1] * rows[i][1] + inverse[2][2];
  for (size_t i = 0; i < POINTS; i++)
    for (size_t j = 0; j < POINTS; j++) {
      size_t lag = i > j ? i - j : j - i;
      if (lag < noise->lags) sum += noise->covariance[lag] * weights[i] * weights[j];
    }
  return sum;
}

/* Pairs are as far apart as the noise's lags, more than an arc's stations are read at once. */
static void all_pairs_of_stations_count(void **state) {
  (void)state;
  uint64_t seed = 5;
  arcs_strip a;
  fg_noise_model noise = {.lags = 200, .integral_stations = 1};
  draw_arcs(&a, 1e-5, 0, &seed);
  for (size_t lag = 0; lag < noise.lags; lag++)
    noise.covariance[lag] = 1e-8 * exp(-(double)lag / 40);
  fg_arc arc = a.arcs[1];
  arc.scatter_mm = 1; /* no outliers */
  fg_arc_covariance(&a.line, &noise, &arc);
  double expected = radius_variance(&a, &arc, &noise);
  assert_near(arc.covariance[2][2] / expected, 1, 1e-9);
  free_arcs(&a);
}

/* Ratio of the true variance of R to the mean of the reported variance, over trials. */
static void covariance_is_monte_carlo(double rho, double low, double high) {
  uint64_t seed = 77;
  double square = 0, reported = 0, covered = 0, n = 0;
  for (int trial = 0; trial < TRIALS; trial++) {
    arcs_strip a;
    fg_noise_model noise;
    draw_arcs(&a, 2e-4, rho, &seed);
    fg_noise_estimate(&a.line, a.arcs, ARCS, FG_NOISE_OF_LINE, &noise);
    for (size_t i = 0; i < ARCS; i++) {
      fg_arc_covariance(&a.line, &noise, &a.arcs[i]);
      double error = a.arcs[i].circle.radius - radius_mm, variance = a.arcs[i].covariance[2][2];
      square += error * error;
      reported += variance;
      covered += fabs(error) <= 1.96 * sqrt(variance);
      n++;
    }
    free_arcs(&a);
  }
  if (!(square / reported > low && square / reported < high))
    fail_msg("rho %g: true variance over reported %.3f", rho, square / reported);
  if (!(covered / n > 0.92 && covered / n < 0.98)) fail_msg("rho %g: cover %.3f", rho, covered / n);
}

/* The variance of a variance over 1080 arcs is 4.3 %; correlation leaves fewer degrees. */
static void white_noise(void **state) {
  (void)state;
  covariance_is_monte_carlo(0, 0.85, 1.15);
}

static void correlated_noise(void **state) {
  (void)state;
  covariance_is_monte_carlo(0.5, 0.8, 1.2);
  covariance_is_monte_carlo(0.8, 0.8, 1.25);
}

/* An arc grown on a bump ends before the fillets: within 4 stations inside the tangent points, and
 * never beyond them by more than one. */
static void arcs_end_before_the_fillets(void **state) {
  (void)state;
  const double blurs[] = {0.7, 1.2, 3};
  for (size_t j = 0; j < 3; j++) {
    char json[4096];
    small_foil(json, sizeof json, 3, ",\"radius_mm\":[3.4,3.4,3.4]", "\"blur_px\":%g", blurs[j]);
    measured m = measure_render(json, NULL);
    assert_ok(NULL, m.status);
    const fg_foil *foil = &m.result.foils[0];
    /* A fillet of radius F touches the bump circle from outside and the overall circle from
     * inside; its centre lies R + F from C and R0 - F from O. */
    const double fillet = 0.35;
    for (size_t i = 0; i < foil->bump_count; i++) {
      const fg_bump *b = &foil->bumps[i];
      double x = b->centre_to_centre_mm, p = b->radius_mm + fillet;
      double q = foil->overall.radius_mm - fillet;
      double half = acos((x * x + p * p - q * q) / (2 * x * p));
      double exact = 2 * half * b->radius_mm, used = b->arc_end_mm - b->arc_start_mm;
      double station = foil->strip.step_mm, margin = 2 * 1.5 * blurs[j] * 25.4 / 4800;
      assert_true(used < exact + 2 * station);
      assert_true(used > exact - margin - 12 * station);
    }
    measured_free(&m);
  }
}

/* R and R0 follow the line that is measured; h, X and the flags do not. */
static void datum_moves_radii_by_half_the_thickness(void **state) {
  (void)state;
  char json[4096];
  small_foil(json, sizeof json, 3, ",\"rotate_deg\":20", "\"noise\":0.2,\"bits\":16");
  fg_design design;
  fg_design_default(&design);
  measured mid = measure_render(json, &design);
  for (int side = -1; side <= 1; side += 2) {
    design.datum = side < 0 ? FG_DATUM_INNER : FG_DATUM_OUTER;
    measured m = measure_render(json, &design);
    assert_ok(NULL, m.status);
    const fg_foil *a = &mid.result.foils[0], *b = &m.result.foils[0];
    assert_int_equal(a->bump_count, b->bump_count);
    /* The sleeve's side is outside of the overall circle, and inside of a bump's. */
    assert_near(b->overall.radius_mm - a->overall.radius_mm, side * 0.05, 5e-5);
    for (size_t i = 0; i < a->bump_count; i++) {
      assert_near(b->bumps[i].radius_mm - a->bumps[i].radius_mm, -side * 0.05, 1e-4);
      assert_near(b->bumps[i].height_mm, a->bumps[i].height_mm, 3e-5);
      assert_near(b->bumps[i].centre_to_centre_mm, a->bumps[i].centre_to_centre_mm, 1e-4);
    }
    measured_free(&m);
  }
  measured_free(&mid);
}

/* 95 % intervals of R, h and R0 over rotations, seeds, polarities: of 168 radii 160 +- 3 are in. */
static void intervals_cover_the_truth(void **state) {
  (void)state;
  double in[2] = {0}, n = 0;
  for (int i = 0; i < 28; i += (int)test_step(3)) {
    char json[4096], foil[100];
    snprintf(foil, sizeof foil, ",\"rotate_deg\":%d", 17 * i);
    small_foil(json, sizeof json, 6, foil, "\"dpi\":2400,\"noise\":%g,%s", 1 + 0.2 * (i % 5),
               i % 2 ? "\"background\":230,\"contrast\":-175" : "\"bits\":16");
    memcpy(strstr(json, "\"seed\":3"), "\"seed\":", 7);
    strstr(json, "\"seed\":")[7] = (char)('1' + i % 9);
    measured m = measure_render(json, NULL);
    assert_ok(NULL, m.status);
    const fg_foil *f = &m.result.foils[0];
    const fg_render_foil *t = &m.picture.truth->foils[0];
    assert_int_equal(f->bump_count, t->bump_count);
    for (size_t k = 0; k < f->bump_count; k++) {
      const fg_bump *b = &f->bumps[k];
      in[0] += fabs(b->radius_mm - t->bumps[k].radius_mm) <= 1.96 * b->u_radius_mm;
      in[1] += fabs(b->height_mm - t->bumps[k].height_mm) <= 1.96 * b->u_height_mm;
      n++;
    }
    measured_free(&m);
  }
  if (!(in[0] / n >= 0.88)) fail_msg("R: %.3f", in[0] / n);
  if (!(in[1] / n >= 0.88)) fail_msg("h: %.3f", in[1] / n);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(all_pairs_of_stations_count),
      cmocka_unit_test(white_noise),
      cmocka_unit_test(correlated_noise),
      cmocka_unit_test(arcs_end_before_the_fillets),
      cmocka_unit_test(datum_moves_radii_by_half_the_thickness),
      cmocka_unit_test(intervals_cover_the_truth),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

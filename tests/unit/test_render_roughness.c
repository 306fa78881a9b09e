/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The edges' scatter: its size and its autocorrelation, both forms, from far below a pixel to
 * centimetres; in the drawn sequence, and in the picture. */
#include "render_picture.h"

#include "render/spec.h"
#include "support/brief.h"
#include "support/test.h"

/* Mean square of a foil's first edge and its products at lags of one step, over many foils. */
typedef struct scatter {
  double variance, step_um, lag[64];
} scatter;

static fg_render_spec *many(int foils, const char *rough) {
  fg_context ctx = {0};
  fg_render_spec *spec = NULL;
  char json[512];
  snprintf(json, sizeof json,
           "{\"schema\":\"foilgauge/render/1\",\"seed\":11,\"foils\":[{\"repeat\":%d}],"
           "\"width_px\":8000,\"scanner\":{\"rough\":{%s}}}",
           foils, rough);
  if (fg_render_parse(&ctx, "spec.json", json, &spec) != FG_OK) fail_msg("%s", ctx.message);
  return spec;
}

static scatter scatter_of(int foils, const char *rough) {
  fg_render_spec *spec = many(foils, rough);
  scatter s = {.step_um = 1e3 * spec->scene.drawn[0].roughness_step_mm};
  size_t pairs[64] = {0};
  for (size_t f = 0; f < spec->scene.foil_count; f++) {
    const fg_drawn_foil *foil = &spec->scene.drawn[f];
    for (size_t k = 0; k < 64 && k < foil->roughness_count; k++)
      for (size_t i = 0; i + k < foil->roughness_count; i++, pairs[k]++)
        s.lag[k] += 1e6 * (double)foil->roughness[0][i] * (double)foil->roughness[0][i + k];
  }
  for (size_t k = 0; k < 64; k++)
    s.lag[k] /= pairs[k] ? (double)pairs[k] : NAN;
  s.variance = s.lag[0];
  fg_render_free(spec);
  return s;
}

typedef struct roughness_case {
  double length_um;
  bool exponential;
  double tolerance; /* of the variance, relative: foils are shorter than centimetres */
} roughness_case;

/* The Gaussian that a sample is smoothed with (0.3 px of 25.4 / 4800 mm) takes its share of scatter
 * that is finer than it. */
static double expected_at(const roughness_case *c, double lag_um) {
  const double smooth = 0.3 * 25.4e3 / 4800;
  double sum = 0, weights = 0, widened = hypot(c->length_um, 2 * smooth);
  if (!c->exponential) return c->length_um / widened * exp(-pow(lag_um / widened, 2));
  for (int k = -400; k <= 400; k++) { /* two smoothings: sd times sqrt(2) */
    double shift = 6 * smooth * k / 400, weight = exp(-0.25 * pow(shift / smooth, 2));
    weights += weight;
    sum += weight * exp(-fabs(lag_um + shift) / c->length_um);
  }
  return sum / weights;
}

static void roughness_has_its_size_and_correlation(void **state) {
  (void)state;
  static const roughness_case cases[] = {
      {1.06, false, 0.02}, {5, false, 0.02},   {50, false, 0.03}, {1000, false, 0.12},
      {20000, false, 0.4}, {1.06, true, 0.02}, {5, true, 0.02},   {50, true, 0.05},
      {1000, true, 0.15},  {20000, true, 0.4},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i += test_step(3)) {
    const roughness_case *c = &cases[i];
    char rough[160];
    snprintf(rough, sizeof rough,
             "\"edge_roughness_um\":1.6,\"edge_common_um\":1.2,\"correlation_um\":%g,"
             "\"correlation_form\":\"%s\"",
             c->length_um, c->exponential ? "exponential" : "gaussian");
    scatter s = scatter_of(c->length_um < 20 ? 4 : c->length_um < 100 ? 24 : 60, rough);
    assert_near(s.variance / 4 / expected_at(c, 0), 1, c->tolerance);
    for (size_t k = 1; k < 64 && (double)k * s.step_um < 3 * c->length_um; k++) {
      if (isnan(s.lag[k])) break;
      double expected = expected_at(c, (double)k * s.step_um) / expected_at(c, 0);
      assert_near(s.lag[k] / s.variance, expected, fmax(0.02, 0.6 * c->tolerance));
    }
  }
}

/* Both edges share edge_common_um and nothing else. */
static void common_roughness_is_equal_on_both_edges(void **state) {
  (void)state;
  fg_render_spec *spec = many(30, "\"edge_roughness_um\":1.6,\"edge_common_um\":1.2");
  double both = 0, count = 0;
  for (size_t f = 0; f < spec->scene.foil_count; f++) {
    const fg_drawn_foil *foil = &spec->scene.drawn[f];
    for (size_t i = 0; i < foil->roughness_count; i++, count++)
      both += 1e6 * (double)foil->roughness[0][i] * (double)foil->roughness[1][i];
  }
  assert_near(both / count, 1.44, 0.08);
  fg_render_free(spec);
}

/* Around a disc the scatter closes, also where it is longer than the way round. */
static void disc_scatters_and_closes(void **state) {
  (void)state;
  const char *models[] = {"gaussian", "exponential"};
  const double lengths_um[] = {20, 200, 50000};
  for (size_t f = 0; f < 2; f++)
    for (size_t l = 0; l < 3; l++) {
      double squares = 0, turn = 0, next = 0, samples = 0;
      for (int seed = 0; seed < 40; seed++) {
        fg_context ctx = {0};
        fg_render_spec *spec = NULL;
        char json[400];
        snprintf(json, sizeof json,
                 "{\"schema\":\"foilgauge/render/1\",\"seed\":%d,\"discs\":[{\"centre_mm\":[3,3],"
                 "\"radius_mm\":2}],\"scanner\":{\"rough\":{\"edge_roughness_um\":0.9,"
                 "\"edge_common_um\":1.2,\"correlation_um\":%g,\"correlation_form\":\"%s\"}}}",
                 seed, lengths_um[l], models[f]);
        assert_ok(&ctx, fg_render_parse(&ctx, "spec.json", json, &spec));
        const fg_shape *disc = &spec->scene.shapes[0];
        size_t n = disc->roughness_count;
        for (size_t i = 1; i <= n; i++)
          squares += 1e6 * (double)disc->roughness[i] * (double)disc->roughness[i];
        samples += (double)n;
        turn += pow(1e3 * (double)(disc->roughness[1] - disc->roughness[n]), 2);
        next += pow(1e3 * (double)(disc->roughness[n / 2] - disc->roughness[n / 2 + 1]), 2);
        fg_render_free(spec);
      }
      double expected = l == 2 ? 1 : expected_at(&(roughness_case){lengths_um[l], f == 1, 0}, 0);
      const double tolerance[] = {0.04, 0.1, 0.6};
      assert_near(squares / samples / (1.5 * 1.5) / expected, 1, tolerance[l]);
      assert_true(turn < 3 * next + 1e-6); /* where it closes as smooth as elsewhere */
    }
}

/* A rough disc's edge in the picture, against the smooth one: by the light along a ray. */
static void disc_scatter_is_in_the_picture(void **state) {
  (void)state;
  const char *format =
      "{\"schema\":\"foilgauge/render/1\",\"seed\":5,\"width_px\":400,\"height_px\":400,"
      "\"discs\":[{\"centre_mm\":[1.05,1.05],\"radius_mm\":0.8}],\"scanner\":{" EXACT "%s}}";
  picture rough =
      draw_format(format, ",\"rough\":{\"edge_roughness_um\":2,\"correlation_um\":100}");
  picture smooth = draw_format(format, "");
  const fg_shape *disc = &rough.spec->scene.shapes[0];
  double errors = 0, squares = 0;
  for (int64_t y = 150; y < 250; y++) { /* the right edge, nearly upright */
    double width = 0;
    for (int64_t x = 250; x < 400; x++)
      width += coverage(&rough, x, y) - coverage(&smooth, x, y);
    double dy = (double)y * pixel - 1.05, dx = sqrt(0.64 - dy * dy);
    double turn = atan2(dy, dx) / (2 * 3.14159265358979);
    double shift =
        fg_roughness_at(disc->roughness, 1 + (turn - floor(turn)) * (double)disc->roughness_count);
    double expected = shift * 0.8 / dx / pixel;
    errors += (width - expected) * (width - expected);
    squares += expected * expected;
  }
  assert_true(squares / 100 > 0.02);
  assert_true(errors < 0.003 * squares);
  drop(&rough);
  drop(&smooth);
}

/* Edge of every column along the bumps' crowns: position on both sides against the smooth foil. */
static void roughness_has_its_size(void **state) {
  (void)state;
  const char *format = "{\"schema\":\"foilgauge/render/1\",\"seed\":%d,\"foils\":[{"
                       "\"centre_mm\":[22,24],\"design\":{\"bump_count\":1,"
                       "\"fillet_radius_mm\":0.35},\"lip\":null,\"first_land_mm\":12,"
                       "\"last_land_mm\":12}],\"width_px\":8300,\"height_px\":1600,"
                       "\"scanner\":{" EXACT "%s}}";
  char rough[512], smooth[512];
  snprintf(rough, sizeof rough, format, 7,
           ",\"rough\":{\"edge_roughness_um\":1.5,\"edge_common_um\":1,\"correlation_um\":50}");
  snprintf(smooth, sizeof smooth, format, 7, "");
  picture a = draw(0, rough), b = draw(0, smooth);
  double sum = 0, squares = 0, lag = 0, before = 0;
  int64_t count = 0;
  for (int64_t x = 3850; x < 4450; x++) { /* the bump, nearly level */
    double width[2] = {0, 0};
    for (int64_t y = 0; y < a.height; y++) {
      width[0] += coverage(&a, x, y);
      width[1] += coverage(&b, x, y);
    }
    double error = (width[0] - width[1]) * 25.4e3 / 4800; /* um: difference of two edges */
    sum += error;
    squares += error * error;
    lag += error * before;
    before = error;
    count++;
  }
  /* 600 columns of 5.3 um hold about 36 independent lengths: 12 % for the sd of one draw. */
  assert_near(sqrt(squares / (double)count), 1.5 * sqrt(2.0), 0.8);
  assert_true(lag / squares > 0.9);
  drop(&a);
  drop(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(roughness_has_its_size_and_correlation),
      cmocka_unit_test(common_roughness_is_equal_on_both_edges),
      cmocka_unit_test(disc_scatters_and_closes),
      cmocka_unit_test(disc_scatter_is_in_the_picture),
      cmocka_unit_test(roughness_has_its_size),
  };
  return cmocka_run_group_tests_name("render roughness", tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scan that a driver made finer than its sensor reads: every pixel is the interpolation of the
 * scan that the sensor gave. */
#include "render_picture.h"
#include "support/test.h"

/* A disc and a hole, `scanner` says at what resolution. */
static picture draw_size(int width, int height, const char *scanner) {
  return draw_format("{\"schema\":\"foilgauge/render/1\",\"seed\":4,\"width_px\":%d,"
                     "\"height_px\":%d,\"discs\":[{\"centre_mm\":[0.66,0.6],\"radius_mm\":0.4},{"
                     "\"centre_mm\":[0.7,0.6],\"radius_mm\":0.1,\"hole\":true}],"
                     "\"scanner\":{\"bits\":16,\"noise\":1.5,%s}}",
                     width, height, scanner);
}

static double pixel_of(const picture *p, int64_t x, int64_t y) {
  x = x < 0 ? 0 : x >= p->width ? p->width - 1 : x;
  y = y < 0 ? 0 : y >= p->height ? p->height - 1 : y;
  return p->dn[y * p->width + x];
}

/* Keys' cubic with a = -1/2. */
static double cubic_weight(double d) {
  d = fabs(d);
  if (d < 1) return 1.5 * d * d * d - 2.5 * d * d + 1;
  return d < 2 ? -0.5 * d * d * d + 2.5 * d * d - 4 * d + 2 : 0;
}

static double linear_weight(double d) {
  return fmax(0, 1 - fabs(d));
}

static double interpolated(const picture *p, double x, double y, double (*weight)(double)) {
  double sum = 0;
  for (int64_t j = (int64_t)floor(y) - 2; j <= (int64_t)floor(y) + 3; j++)
    for (int64_t i = (int64_t)floor(x) - 2; i <= (int64_t)floor(x) + 3; i++)
      sum += weight(x - (double)i) * weight(y - (double)j) * pixel_of(p, i, j);
  return fmax(0, fmin(255, sum));
}

static void pixels_are_interpolated(void **state) {
  (void)state;
  static const struct {
    const char *sensor, *scanner;
    int width, height; /* of the sensor's picture */
    double step[2];
    bool bicubic;
  } table[] = {
      {"\"dpi\":2400", "\"dpi\":4800,\"resampled_from_dpi\":2400", 126, 121, {0.5, 0.5}, false},
      {"\"dpi\":2400",
       "\"dpi\":4800,\"resampled_from_dpi\":2400,\"resampled_by\":\"bicubic\"",
       126,
       121,
       {0.5, 0.5},
       true},
      {"\"dpi\":[1200,4800],\"blur_px\":2.1",
       "\"dpi\":4800,\"blur_px\":2.1,\"resampled_from_dpi\":[1200,4800],"
       "\"resampled_by\":\"bilinear\"",
       64,
       241,
       {0.25, 1},
       false},
      {"\"dpi\":3600",
       "\"dpi\":4800,\"resampled_from_dpi\":3600,\"resampled_by\":\"bicubic\"",
       189,
       181,
       {0.75, 0.75},
       true},
  };
  for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
    in_row("table[%zu]", k);
    picture seen = draw_size(table[k].width, table[k].height, table[k].sensor);
    picture p = draw_size(251, 241, table[k].scanner);
    for (int64_t y = 0; y < p.height; y++)
      for (int64_t x = 0; x < p.width; x++)
        assert_near(pixel_of(&p, x, y),
                    interpolated(&seen, (double)x * table[k].step[0], (double)y * table[k].step[1],
                                 table[k].bicubic ? cubic_weight : linear_weight),
                    1.2 / 257);
    drop(&seen);
    drop(&p);
  }
}

/* Places in the truth are of the finished picture. */
static void truth_is_of_the_finished_picture(void **state) {
  (void)state;
  fg_context ctx = {0};
  char *json = NULL;
  picture p = draw_size(251, 241, "\"dpi\":4800,\"resampled_from_dpi\":1200");
  assert_ok(&ctx, fg_render_truth_json(&ctx, p.spec, &json));
  assert_has(json, "\"resampled_from_dpi\": 1200");
  assert_has(json, "\"resampled_by\": \"bilinear\"");
  assert_has(json, "\"dpi\": 4800");
  free(json);
  assert_near(p.truth->discs[0].centre_px.x, 0.66 / pixel, 1e-9);
  double sum = 0, first = 0;
  for (int64_t x = 0; x < 251; x++) {
    double value = pixel_of(&p, x, 60) + pixel_of(&p, x, 166) - 60;
    sum += value;
    first += value * (double)x;
  }
  assert_near(first / sum, 0.66 / pixel, 0.3);
  drop(&p);
}

/* The driver's tone curve, mask and levels come behind; strips of any height, colours too. */
static void strips_of_any_height_give_one_picture(void **state) {
  (void)state;
  const char *json = "{\"schema\":\"foilgauge/render/1\",\"seed\":9,\"foils\":[{\"design\":{"
                     "\"bump_count\":1},\"rotate_deg\":15}],\"scanner\":{\"dpi\":2400,"
                     "\"resampled_from_dpi\":[800,1200],\"resampled_by\":\"bicubic\",\"blur_px\":1,"
                     "\"tone_curve\":[[20,0],[220,255]],\"unsharp_mask\":{\"amount_pct\":100},"
                     "\"rows_lost\":[{\"y_mm\":1.2,\"count\":-3}],\"rough\":{\"jpeg\":{"
                     "\"quality\":80}}}}";
  picture first = draw(64, json), other = draw(100000, json);
  assert_memory_equal(first.dn, other.dn, (size_t)(first.width * first.height) * sizeof *first.dn);
  drop(&first);
  drop(&other);
}

typedef struct colour_rows {
  int64_t width;
  uint8_t *pixels;
} colour_rows;

static fg_status keep_colours(fg_context *ctx, void *user, int64_t row, const void *pixels) {
  (void)ctx;
  colour_rows *keep = user;
  memcpy(keep->pixels + row * keep->width * 3, pixels, (size_t)(3 * keep->width));
  return FG_OK;
}

/* A channel is larger by 500 ppm about the sensor's middle, in sensor pixels or finished ones. */
static void channels_are_resampled_alike(void **state) {
  (void)state;
  const char *format = "{\"schema\":\"foilgauge/render/1\",\"width_px\":2001,\"height_px\":200,"
                       "\"discs\":[{\"centre_mm\":[0.6,0.5],\"radius_mm\":0.3},{\"centre_mm\":[10,"
                       "0.5],\"radius_mm\":0.3}],\"scanner\":{\"noise\":0,\"dpi\":4800%s,"
                       "\"colour_lines\":{\"magnification_ppm\":[500,0,-200],\"dx_px\":[0,0,1]}}}";
  for (int resampled = 0; resampled < 2; resampled++) {
    fg_context ctx = {0};
    fg_render_spec *spec = NULL;
    char json[1024];
    double place[3][2];
    snprintf(json, sizeof json, format, resampled ? ",\"resampled_from_dpi\":2400" : "");
    assert_ok(&ctx, fg_render_parse(&ctx, "spec.json", json, &spec));
    colour_rows colours = {.width = 2001, .pixels = calloc(2001 * 200, 3)};
    assert_non_null(colours.pixels);
    assert_ok(&ctx, fg_render_rows(&ctx, spec, 0, keep_colours, &colours));
    for (int c = 0; c < 3; c++)
      for (int k = 0; k < 2; k++) {
        double sum = 0, first = 0;
        for (int64_t y = 0; y < 200; y++)
          for (int64_t x = k ? 1000 : 0; x < (k ? 2001 : 1000); x++) {
            double value = colours.pixels[(y * 2001 + x) * 3 + c] - 30.0;
            sum += value;
            first += value * (double)x;
          }
        place[c][k] = first / sum;
      }
    double apart = place[1][1] - place[1][0];
    assert_near(apart, 9.4 / pixel, 0.02);
    assert_near((place[0][1] - place[0][0]) / apart, 1 + 500e-6, 1e-5);
    assert_near((place[2][1] - place[2][0]) / apart, 1 - 200e-6, 1e-5);
    assert_near(0.5 * (place[0][0] + place[0][1]) - 0.5 * (place[1][0] + place[1][1]), 0, 0.03);
    assert_near(0.5 * (place[2][0] + place[2][1]) - 0.5 * (place[1][0] + place[1][1]),
                resampled ? 2 : 1, 0.03);
    free(colours.pixels);
    fg_render_free(spec);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pixels_are_interpolated),
      cmocka_unit_test(truth_is_of_the_finished_picture),
      cmocka_unit_test(strips_of_any_height_give_one_picture),
      cmocka_unit_test(channels_are_resampled_alike),
  };
  return cmocka_run_group_tests_name("render resample", tests, NULL, NULL);
}

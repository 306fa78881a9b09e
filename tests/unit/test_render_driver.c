/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects of a scanner's driver on finished numbers: tone curve, unsharp mask, gray levels, JPEG
 * behind them all. Every test computes the driver's part again from the picture without it. */
#include "render_picture.h"
#include "support/test.h"

/* A disc of 200 on 20, its edge at x = 200 px along the middle row. */
#define DISC                                                                                       \
  "{\"schema\":\"foilgauge/render/1\",\"seed\":%d,\"width_px\":250,\"height_px\":250,\"discs\":"   \
  "[{\"centre_mm\":[0.661458333,0.661458333],\"radius_mm\":0.396875}],\"scanner\":{%s}}"

#define EIGHT   "\"background\":20,\"contrast\":200,\"noise\":2"
#define SIXTEEN "\"bits\":16," EIGHT

static size_t pixel_count(const picture *p) {
  return (size_t)(p->width * p->height);
}

static void rounds_to_nothing_else(const picture *p, const double *expected, double tolerance) {
  for (size_t i = 0; i < pixel_count(p); i++)
    if (fabs(p->dn[i] - expected[i]) > tolerance)
      fail_msg("pixel %zu is %g, not %g", i, p->dn[i], expected[i]);
}

/* Straight between points, constant beyond them; on the number before it is rounded. */
static void tone_curve_is_applied_exactly(void **state) {
  (void)state;
  const double points[][2] = {{19, 5}, {40, 12}, {120, 130}, {121, 160}, {218, 250}};
  const char *curve = ",\"tone_curve\":[[19,5],[40,12],[120,130],[121,160],[218,250]]";
  char members[256];
  picture plain = draw_format(DISC, 3, SIXTEEN);
  snprintf(members, sizeof members, SIXTEEN "%s", curve);
  picture bent = draw_format(DISC, 3, members);
  snprintf(members, sizeof members, EIGHT "%s", curve);
  picture narrow = draw_format(DISC, 3, members);
  for (size_t i = 0; i < pixel_count(&plain); i++) {
    double in = plain.dn[i], out = in <= 19 ? 5 : 250;
    for (int k = 0; k < 4; k++)
      if (in > points[k][0] && in <= points[k + 1][0])
        out = points[k][1] + (in - points[k][0]) / (points[k + 1][0] - points[k][0]) *
                                 (points[k + 1][1] - points[k][1]);
    double rounding = in > 119.99 && in < 121.01 ? 30 : 1.5; /* slope × half a step of 1/257 */
    assert_near(bent.dn[i], out, (rounding + 1) * 0.5 / 257 + 1e-4);
    assert_near(narrow.dn[i], out, 0.5 + rounding * 0.5 / 257 + 1e-4);
  }
  drop(&plain);
  drop(&bent);
  drop(&narrow);
}

/* A slope of 2.5 behind the rounding: most counts never come up. */
static void tone_of_rounded_numbers_leaves_gaps(void **state) {
  (void)state;
  picture plain = draw_format(DISC, 3, EIGHT), bent;
  bent = draw_format(DISC, 3, EIGHT ",\"tone_curve\":[[60,0],[160,250]],\"tone_bits\":8");
  for (size_t i = 0; i < pixel_count(&plain); i++)
    assert_near(bent.dn[i], floor(fmax(0, fmin(250, 2.5 * (plain.dn[i] - 60))) + 0.5), 0);
  drop(&plain);
  drop(&bent);
}

static void straight_tone_curve_changes_nothing(void **state) {
  (void)state;
  picture plain = draw_format(DISC, 4, EIGHT), same;
  same = draw_format(DISC, 4, EIGHT ",\"tone_curve\":[[0,0],[255,255]]");
  rounds_to_nothing_else(&same, plain.dn, 0);
  drop(&plain);
  drop(&same);
}

/* A slow mask over the whole picture, of one number. */
static double blurred(const picture *p, int64_t x, int64_t y, double radius) {
  int reach = (int)ceil(4.5 * radius);
  double sum = 0, weights = 0;
  for (int j = -reach; j <= reach; j++)
    for (int i = -reach; i <= reach; i++) {
      int64_t at_x = x + i < 0 ? 0 : x + i >= p->width ? p->width - 1 : x + i;
      int64_t at_y = y + j < 0 ? 0 : y + j >= p->height ? p->height - 1 : y + j;
      double weight = exp(-0.5 * (i * i + j * j) / (radius * radius));
      sum += weight * p->dn[at_y * p->width + at_x];
      weights += weight;
    }
  return sum / weights;
}

static double masked(double in, double blurred_in, double amount, double threshold) {
  double difference = in - blurred_in;
  if (fabs(difference) < threshold) return in;
  return fmax(0, fmin(255, in + amount * difference));
}

static void check_mask(const char *scanner, double amount_pct, double radius, double threshold) {
  char members[256];
  picture plain = draw_format(DISC, 5, scanner);
  snprintf(members, sizeof members,
           "%s,\"unsharp_mask\":{\"amount_pct\":%g,\"radius_px\":%g,\"threshold\":%g}", scanner,
           amount_pct, radius, threshold);
  picture sharp = draw_format(DISC, 5, members);
  double step = plain.truth->bits == 16 ? 1 / 257.0 : 1;
  for (int64_t y = 0; y < plain.height; y += 7)
    for (int64_t x = 0; x < plain.width; x++) {
      double in = plain.dn[y * plain.width + x], soft = blurred(&plain, x, y, radius);
      if (fabs(fabs(in - soft) - threshold) < 1e-3) continue; /* either way */
      assert_near(sharp.dn[y * plain.width + x], masked(in, soft, 0.01 * amount_pct, threshold),
                  0.5 * step + 2e-3);
    }
  drop(&plain);
  drop(&sharp);
}

static void unsharp_mask_is_its_formula(void **state) {
  (void)state;
  check_mask(EIGHT, 150, 1, 0);
  check_mask(EIGHT, 80, 2.5, 3);
  check_mask(EIGHT, 500, 1, 0); /* clipped at the black end */
  check_mask(SIXTEEN, 100, 1, 2);
}

/* Height of a blurred edge of sd `sd` at a distance, from 0 to 1. */
static double edge_height(double distance, double sd) {
  return 0.5 * erfc(-distance / sd / sqrt(2));
}

/* Of an edge whose blur has the sd s: in - gaussian(in) is contrast × (Phi(x / s) - Phi(x /
 * sqrt(s² + r²))), which is odd: the half level stays where it was. */
static void unsharp_mask_overshoots_and_keeps_the_half_level(void **state) {
  (void)state;
  const double edge = 50.5; /* half way: a straight line between two pixels is exact there */
  char json[512];
  snprintf(json, sizeof json,
           "{\"schema\":\"foilgauge/render/1\",\"width_px\":100,\"height_px\":60,\"discs\":["
           "{\"centre_mm\":[%.9f,0.16],\"radius_mm\":20}],\"scanner\":{\"bits\":16,"
           "\"background\":60,\"contrast\":100,\"noise\":0,\"blur_px\":1.2,\"unsharp_mask\":{"
           "\"amount_pct\":100,\"radius_px\":1.5}}}",
           edge * pixel - 20);
  picture p = draw(0, json);
  const double *row = p.dn + llround(0.16 / pixel) * p.width;
  double sd = sqrt(1.2 * 1.2 + 1 / 12.0), wide = hypot(sd, 1.5), highest = 0, lowest = 255;
  for (int64_t x = 30; x < 70; x++) {
    double inside = edge - (double)x;
    double expected = 2 * edge_height(inside, sd) - edge_height(inside, wide);
    assert_near(row[x], 60 + 100 * expected, 0.1);
    highest = fmax(highest, row[x]);
    lowest = fmin(lowest, row[x]);
  }
  assert_true(highest > 164 && lowest < 56);
  double half = 50 + (row[50] - 110) / (row[50] - row[51]);
  assert_near(half, edge, 0.01);
  drop(&p);
}

static size_t count_values(const picture *p, bool seen[65536]) {
  size_t count = 0;
  memset(seen, 0, 65536 * sizeof *seen);
  for (size_t i = 0; i < pixel_count(p); i++) {
    bool *value = &seen[lround(p->dn[i] * (p->truth->bits == 16 ? 257 : 1))];
    count += !*value;
    *value = true;
  }
  return count;
}

/* A wide edge passes through every level there is between 0 and 255. */
#define RAMP "\"background\":0,\"contrast\":255,\"noise\":1,\"blur_px\":8"

static void levels_are_as_many_as_stated(void **state) {
  (void)state;
  static bool seen[65536];
  const int levels[] = {2, 3, 16, 100, 256};
  for (size_t i = 0; i < 5; i++) {
    char members[128];
    snprintf(members, sizeof members, RAMP ",\"levels\":%d", levels[i]);
    picture p = draw_format(DISC, 6, members);
    assert_int_equal(count_values(&p, seen), levels[i]);
    for (int k = 0; k < levels[i]; k++)
      assert_true(seen[lround(255.0 * k / (levels[i] - 1))]);
    drop(&p);
    snprintf(members, sizeof members, "\"bits\":16," RAMP ",\"levels\":%d", levels[i]);
    p = draw_format(DISC, 6, members);
    assert_int_equal(count_values(&p, seen), levels[i]);
    drop(&p);
  }
}

static void levels_are_the_nearest(void **state) {
  (void)state;
  picture plain = draw_format(DISC, 6, RAMP), coarse = draw_format(DISC, 6, RAMP ",\"levels\":16");
  for (size_t i = 0; i < pixel_count(&plain); i++)
    assert_near(coarse.dn[i], 17 * round(plain.dn[i] / 17), 0);
  drop(&plain);
  drop(&coarse);
}

static void threshold_divides_two_levels(void **state) {
  (void)state;
  picture plain = draw_format(DISC, 7, RAMP), middle, high;
  middle = draw_format(DISC, 7, RAMP ",\"levels\":2");
  high = draw_format(DISC, 7, RAMP ",\"levels\":2,\"threshold\":180");
  for (size_t i = 0; i < pixel_count(&plain); i++) {
    assert_near(middle.dn[i], plain.dn[i] >= 127.5 ? 255 : 0, 0);
    assert_near(high.dn[i], plain.dn[i] >= 180 ? 255 : 0, 0);
  }
  drop(&plain);
  drop(&middle);
  drop(&high);
}

/* Two levels through JPEG: flat blocks keep them, an edge's blocks have many more. */
static void jpeg_comes_last(void **state) {
  (void)state;
  static bool seen[65536];
  picture p = draw_format(DISC, 8, EIGHT ",\"levels\":2,\"rough\":{\"jpeg\":{\"quality\":60}}");
  assert_true(count_values(&p, seen) > 20);
  assert_near(p.dn[0], 0, 0);
  assert_near(p.dn[125 * 250 + 125], 255, 0);
  drop(&p);
}

#define ALL                                                                                        \
  "{\"schema\":\"foilgauge/render/1\",\"seed\":9,\"foils\":[{\"design\":{\"bump_count\":1},"       \
  "\"rotate_deg\":15}],\"scanner\":{\"dpi\":3000,\"noise_correlation\":0.6,\"tone_curve\":"        \
  "[[20,0],[90,60],[160,200],[220,255]],\"unsharp_mask\":{\"amount_pct\":120,\"radius_px\":%g,"    \
  "\"threshold\":1},\"levels\":64,\"rough\":{\"jpeg\":{\"quality\":80}}}}"

static void strips_of_any_height_give_one_picture(void **state) {
  (void)state;
  const double radii[] = {0.1, 1, 20};
  const int64_t strips[] = {64, 192, 100000};
  for (size_t r = 0; r < 3; r++) {
    char json[1024];
    snprintf(json, sizeof json, ALL, radii[r]);
    picture first = draw(0, json);
    for (size_t i = 0; i < 3; i++) {
      picture other = draw(strips[i], json);
      assert_memory_equal(first.dn, other.dn, pixel_count(&first) * sizeof *first.dn);
      drop(&other);
    }
    drop(&first);
  }
}

static void picture_may_be_lower_than_the_mask_is_wide(void **state) {
  (void)state;
  picture p = draw(0, "{\"schema\":\"foilgauge/render/1\",\"width_px\":17,\"height_px\":16,"
                      "\"discs\":[{\"centre_mm\":[0,0],\"radius_mm\":0.03}],\"scanner\":{"
                      "\"unsharp_mask\":{\"amount_pct\":100,\"radius_px\":30}}}");
  assert_int_equal(p.height, 16);
  assert_true(p.dn[0] > 200);
  drop(&p);
}

typedef struct colour_row {
  int64_t width, row;
  uint8_t pixels[3 * 250];
} colour_row;

static fg_status keep_colour_row(fg_context *ctx, void *user, int64_t row, const void *pixels) {
  (void)ctx;
  colour_row *keep = user;
  if (row == keep->row) memcpy(keep->pixels, pixels, (size_t)(3 * keep->width));
  return FG_OK;
}

/* Each channel of a colour scan is the gray picture of its own tones. */
static void channels_are_worked_on_one_by_one(void **state) {
  (void)state;
  const double background[3] = {20, 60, 200}, contrast[3] = {200, 120, -150};
  const char *driver = "\"noise\":0,\"tone_curve\":[[0,10],[100,140],[255,250]],"
                       "\"unsharp_mask\":{\"amount_pct\":150},\"levels\":50";
  fg_context ctx = {0};
  fg_render_spec *spec = NULL;
  char members[512], json[1024];
  snprintf(members, sizeof members,
           "%s,\"colour_lines\":{\"background\":[20,60,200],\"contrast\":[200,120,-150]}", driver);
  snprintf(json, sizeof json, DISC, 2, members);
  assert_ok(&ctx, fg_render_parse(&ctx, "spec.json", json, &spec));
  colour_row colours = {.width = 250, .row = 70};
  assert_ok(&ctx, fg_render_rows(&ctx, spec, 0, keep_colour_row, &colours));
  fg_render_free(spec);
  for (int c = 0; c < 3; c++) {
    snprintf(members, sizeof members, "%s,\"background\":%g,\"contrast\":%g", driver, background[c],
             contrast[c]);
    picture gray = draw_format(DISC, 2, members);
    for (int64_t x = 0; x < 250; x++)
      assert_int_equal(colours.pixels[3 * x + c], gray.dn[70 * 250 + x]);
    drop(&gray);
  }
}

/* The truth records stated members alone. */
static void truth_records_the_driver(void **state) {
  (void)state;
  fg_context ctx = {0};
  char *json = NULL;
  picture p = draw_format(DISC, 1, EIGHT), all;
  assert_ok(&ctx, fg_render_truth_json(&ctx, p.spec, &json));
  assert_has_not(json, "tone_curve");
  assert_has_not(json, "unsharp");
  assert_has_not(json, "levels");
  assert_has_not(json, "threshold");
  free(json);
  drop(&p);
  all = draw_format(DISC, 1,
                    EIGHT ",\"tone_curve\":[[0,0],[200,255]],\"unsharp_mask\":{\"amount_pct\":50,"
                          "\"threshold\":3},\"levels\":2,\"threshold\":90");
  assert_ok(&ctx, fg_render_truth_json(&ctx, all.spec, &json));
  const char *words[] = {"\"tone_curve\": [", "[200, 255]",       "\"amount_pct\": 50",
                         "\"radius_px\": 1",  "\"threshold\": 3", "\"levels\": 2",
                         "\"threshold\": 90"};
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    if (!strstr(json, words[i])) fail_msg("no %s in %s", words[i], json);
  free(json);
  drop(&all);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(tone_curve_is_applied_exactly),
      cmocka_unit_test(tone_of_rounded_numbers_leaves_gaps),
      cmocka_unit_test(straight_tone_curve_changes_nothing),
      cmocka_unit_test(unsharp_mask_is_its_formula),
      cmocka_unit_test(unsharp_mask_overshoots_and_keeps_the_half_level),
      cmocka_unit_test(levels_are_as_many_as_stated),
      cmocka_unit_test(levels_are_the_nearest),
      cmocka_unit_test(threshold_divides_two_levels),
      cmocka_unit_test(jpeg_comes_last),
      cmocka_unit_test(strips_of_any_height_give_one_picture),
      cmocka_unit_test(picture_may_be_lower_than_the_mask_is_wide),
      cmocka_unit_test(channels_are_worked_on_one_by_one),
      cmocka_unit_test(truth_records_the_driver),
  };
  return cmocka_run_group_tests_name("render driver", tests, NULL, NULL);
}

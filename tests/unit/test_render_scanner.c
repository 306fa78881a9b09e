/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects of the rendered scanner on light: tone, noise, clipping, JPEG, halo, wall; the same bytes
 * every time. */
#include "render_picture.h"

#include <unistd.h>

#include "foilgauge/scan.h"
#include "render/jpeg.h"
#include "support/test.h"

typedef struct statistics {
  double mean, sd, right, below;
} statistics;

static statistics picture_statistics(const picture *p) {
  statistics s = {0};
  double squares = 0, right = 0, below = 0;
  int64_t n = p->width * p->height;
  for (int64_t i = 0; i < n; i++)
    s.mean += p->dn[i] / (double)n;
  for (int64_t y = 0; y + 1 < p->height; y++)
    for (int64_t x = 0; x + 1 < p->width; x++) {
      const double *at = p->dn + y * p->width + x;
      squares += (at[0] - s.mean) * (at[0] - s.mean);
      right += (at[0] - s.mean) * (at[1] - s.mean);
      below += (at[0] - s.mean) * (at[p->width] - s.mean);
    }
  s.sd = sqrt(squares / (double)((p->width - 1) * (p->height - 1)));
  s.right = right / squares;
  s.below = below / squares;
  return s;
}

/* Background alone: the disc lies far outside. */
#define EMPTY                                                                                      \
  "{\"schema\":\"foilgauge/render/1\",\"seed\":%d,\"width_px\":800,\"height_px\":600,"             \
  "\"discs\":[{\"centre_mm\":[50,50],\"radius_mm\":0.5}],\"scanner\":{\"background\":100,"         \
  "\"contrast\":100,%s}}"

static void noise_has_its_sd_and_correlation(void **state) {
  (void)state;
  const double correlations[] = {0, 0.5, 0.7};
  for (size_t i = 0; i < 3; i++) {
    char members[128];
    snprintf(members, sizeof members, "\"bits\":16,\"noise\":2.5,\"noise_correlation\":%g",
             correlations[i]);
    picture p = draw_format(EMPTY, 3, members);
    statistics s = picture_statistics(&p);
    assert_near(s.mean, 100, 0.08);
    assert_near(s.sd, 2.5, 0.03);
    assert_near(s.right, correlations[i], 0.01);
    assert_near(s.below, correlations[i], 0.01);
    drop(&p);
  }
}

/* A normal law: kurtosis 3 and the right share beyond three sd. */
static void noise_is_normal(void **state) {
  (void)state;
  picture p = draw_format(EMPTY, 4, "\"bits\":16,\"noise\":2");
  double fourth = 0, beyond = 0, n = (double)(p.width * p.height);
  for (int64_t i = 0; i < p.width * p.height; i++) {
    double u = (p.dn[i] - 100) / 2;
    fourth += u * u * u * u / n;
    beyond += fabs(u) > 3;
  }
  assert_near(fourth, 3, 0.06);
  assert_near(beyond / n, 0.0027, 0.0004);
  drop(&p);
}

static void eight_bit_rounds_to_nearest(void **state) {
  (void)state;
  picture p = draw_format(EMPTY, 5, "\"bits\":8,\"noise\":1");
  statistics s = picture_statistics(&p);
  assert_near(s.mean, 100, 0.01);
  assert_near(s.sd, sqrt(1 + 1.0 / 12), 0.01);
  drop(&p);
}

static void plateaus_keep_their_values_under_gamma(void **state) {
  (void)state;
  const double gammas[] = {0.6, 1, 2.2};
  double middles[3];
  for (size_t i = 0; i < 3; i++) {
    picture p = draw_format("{\"schema\":\"foilgauge/render/1\",\"width_px\":250,"
                            "\"height_px\":250,\"discs\":[{\"centre_mm\":[0.661458333,"
                            "0.661458333],\"radius_mm\":0.396875}],"
                            "\"scanner\":{" EXACT ",\"gamma\":%g}}",
                            gammas[i]);
    assert_near(p.dn[3 * p.width + 3], 20, 0.01);
    assert_near(p.dn[125 * p.width + 125], 220, 0.01);
    middles[i] = p.dn[125 * p.width + 200]; /* on the edge: half of the light */
    drop(&p);
  }
  for (size_t i = 0; i < 3; i++) {
    double light = 0.5 * (pow(20 / 255.0, gammas[i]) + pow(220 / 255.0, gammas[i]));
    assert_near(middles[i], 255 * pow(light, 1 / gammas[i]), 1.0);
  }
}

static void shading_and_clipping(void **state) {
  (void)state;
  picture p = draw_format(EMPTY, 1,
                          "\"bits\":16,\"noise\":0,\"shading\":{\"x\":0.1,\"y\":-0.05,"
                          "\"quadratic\":0.02},\"clip_white\":111");
  assert_near(p.dn[0], 100 * (1 - 0.1 + 0.05 + 0.04), 0.01);
  assert_near(p.dn[599 * 800], 100 * (1 - 0.1 - 0.05 + 0.04), 0.01);
  assert_near(p.dn[799], 111, 0.01); /* 119 */
  drop(&p);
}

/* Light is only moved about: the sum stays, a share of it goes to the surroundings. */
static void halo_moves_light(void **state) {
  (void)state;
  const char *format = "{\"schema\":\"foilgauge/render/1\",\"width_px\":601,\"height_px\":601,"
                       "\"discs\":[{\"centre_mm\":[1.5875,1.5875],\"radius_mm\":0.3}],"
                       "\"scanner\":{" EXACT ",\"rough\":{\"halo\":{\"fraction\":%g,"
                       "\"length_px\":15}}}}";
  double sums[2], near[2];
  for (int i = 0; i < 2; i++) {
    char json[1024];
    snprintf(json, sizeof json, format, i ? 0.15 : 0.0);
    picture p = draw(0, json);
    sums[i] = 0;
    for (int64_t k = 0; k < p.width * p.height; k++)
      sums[i] += (p.dn[k] - 20) / 200;
    near[i] = coverage(&p, 300 + 57 + 15, 300);
    if (i) assert_true(coverage(&p, 300, 300) > 0.88);
    drop(&p);
  }
  assert_near(sums[1] / sums[0], 1, 1e-3);
  assert_near(near[0], 0, 1e-4);
  assert_true(near[1] > 0.015 && near[1] < 0.06);
}

/* Across a straight piece of the strip: the wall shows beside the edge that faces it, only there.
 */
static void wall_shows_on_one_side(void **state) {
  (void)state;
  picture p = draw(0, "{\"schema\":\"foilgauge/render/1\",\"foils\":[{\"lip\":null,"
                      "\"design\":{\"bump_count\":1}}],"
                      "\"scanner\":{" EXACT ",\"rough\":{\"side_wall\":{\"amplitude\":0.3,"
                      "\"direction_deg\":90,\"length_px\":10}}}}");
  const fg_render_bump *bump = &p.truth->foils[0].bumps[0];
  int64_t x = llround(bump->centre_px.x);
  int64_t y = llround(bump->centre_px.y + bump->radius_mm * 4800 / 25.4);
  double inside = coverage(&p, x, y + 9 + 10), outside = coverage(&p, x, y - 9 - 10);
  assert_near(inside, 0.3 * exp(-1), 0.02);
  assert_near(outside, 0, 1e-3);
  drop(&p);
}

static void jpeg_keeps_flat_blocks_and_rounds_ramps(void **state) {
  (void)state;
  fg_jpeg jpeg;
  uint8_t flat[16 * 16], ramp[13 * 16], once[13 * 16];
  fg_jpeg_init(50, &jpeg);
  memset(flat, 128, sizeof flat);
  fg_jpeg_squeeze(&jpeg, flat, 16, 16, 16);
  for (size_t i = 0; i < sizeof flat; i++)
    assert_int_equal(flat[i], 128);
  for (int i = 0; i < 13 * 16; i++)
    ramp[i] = (uint8_t)(100 + 3 * (i % 16) + i / 16 % 3);
  memcpy(once, ramp, sizeof ramp);
  fg_jpeg_squeeze(&jpeg, once, 15, 13, 16); /* incomplete blocks on both sides */
  int changed = 0, largest = 0;
  for (int i = 0; i < 13 * 16; i++) {
    int change = abs(once[i] - ramp[i]);
    if (i % 16 == 15) assert_int_equal(change, 0);
    changed += change > 0;
    if (change > largest) largest = change;
  }
  assert_true(changed > 50 && largest < 30);
  memcpy(ramp, once, sizeof ramp);
  fg_jpeg_squeeze(&jpeg, once, 8, 8, 16);
  for (int i = 0; i < 8 * 16; i++)
    assert_true(abs(once[i] - ramp[i]) <= 1);
}

/* Gray colours come out as gray does; a colour's edge is only known to two pixels. */
static void jpeg_halves_the_resolution_of_colours(void **state) {
  (void)state;
  fg_jpeg jpeg;
  uint8_t gray[20 * 27], colours[20 * 27 * 3];
  fg_jpeg_init(70, &jpeg);
  for (int i = 0; i < 20 * 27; i++)
    gray[i] = colours[3 * i] = colours[3 * i + 1] = colours[3 * i + 2] =
        (uint8_t)(90 + 5 * (i % 27) + 7 * (i / 27 % 4));
  fg_jpeg_squeeze(&jpeg, gray, 27, 20, 27);
  fg_jpeg_squeeze_colours(&jpeg, colours, 27, 20, 27 * 3);
  for (int i = 0; i < 20 * 27 * 3; i++)
    assert_int_equal(colours[i], gray[i / 3]);

  uint8_t edge[16 * 16 * 3]; /* red to blue of one luminance, behind column 4 */
  fg_jpeg_init(100, &jpeg);
  for (int i = 0; i < 16 * 16; i++)
    memcpy(edge + 3 * i, i % 16 < 5 ? (uint8_t[]){180, 90, 100} : (uint8_t[]){60, 130, 209}, 3);
  fg_jpeg_squeeze_colours(&jpeg, edge, 16, 16, 16 * 3);
  assert_near(edge[3 * 2], 180, 3);
  assert_near(edge[3 * 8], 60, 3);
  assert_near(edge[3 * 8 + 2], 209, 3);
  assert_near(edge[3 * 4], 120, 4);
  assert_near(edge[3 * 5], 120, 4);
}

#define BUSY                                                                                       \
  "{\"schema\":\"foilgauge/render/1\",\"seed\":%d,\"foils\":[{\"design\":{\"bump_count\":1},"      \
  "\"rotate_deg\":15,\"radius_springback\":{\"mean\":0.02,\"sd\":0.01}}],\"scanner\":{"            \
  "\"gamma\":1.3,\"noise_correlation\":0.6,\"dust\":{\"count\":30},\"specks\":{\"count\":5},"      \
  "\"scratches\":{\"count\":4},\"shading\":{\"x\":0.05},\"rough\":{\"one_sided_blur_px\":1,"       \
  "\"edge_roughness_um\":1.5,\"halo\":{\"fraction\":0.1,\"length_px\":12},\"side_wall\":{"         \
  "\"amplitude\":0.2,\"direction_deg\":30},\"jpeg\":{\"quality\":85}}}}"

static void same_spec_same_bytes_whatever_the_strip(void **state) {
  (void)state;
  char json[1024];
  snprintf(json, sizeof json, BUSY, 9);
  picture first = draw(64, json);
  const int64_t strips[] = {64, 256, 100000};
  size_t bytes = (size_t)(first.width * first.height) * sizeof *first.dn;
  for (size_t i = 0; i < 3; i++) {
    picture other = draw(strips[i], json);
    assert_memory_equal(first.dn, other.dn, bytes);
    drop(&other);
  }
  snprintf(json, sizeof json, BUSY, 10);
  picture other = draw(0, json);
  assert_true(other.truth->foils[0].bumps[0].radius_mm != first.truth->foils[0].bumps[0].radius_mm);
  drop(&other);
  drop(&first);
}

/* The file says what the rows said, to the last bit, at the resolution of each axis. */
static void file_holds_the_rows(void **state) {
  (void)state;
  fg_context ctx = {0};
  char path[] = "/tmp/foilgauge-render-XXXXXX";
  int file = mkstemp(path);
  assert_true(file >= 0);
  close(file);
  picture p = draw(0, "{\"schema\":\"foilgauge/render/1\",\"width_px\":130,\"height_px\":140,"
                      "\"discs\":[{\"centre_mm\":[0.3,0.35],\"radius_mm\":0.2}],"
                      "\"scanner\":{\"dpi\":[4800,4200],\"bits\":16}}");
  assert_ok(&ctx, fg_render_scan(&ctx, p.spec, path, NULL));
  fg_scan *scan = NULL;
  assert_ok(&ctx, fg_scan_open(&ctx, path, &(fg_scan_options){0}, &scan));
  const fg_scan_info *info = fg_scan_get_info(scan);
  assert_int_equal(info->width_px, 130);
  assert_int_equal(info->height_px, 140);
  assert_int_equal(info->bit_depth, 16);
  assert_near(info->dpi[0], 4800, 0);
  assert_near(info->dpi[1], 4200, 0);
  uint16_t rows[140][130];
  assert_ok(&ctx, fg_scan_read_rows(&ctx, scan, 140, rows, sizeof rows[0]));
  for (int i = 0; i < 130 * 140; i++)
    assert_int_equal(rows[i / 130][i % 130], lround(p.dn[i] * 257));
  fg_scan_close(scan);
  remove(path);
  drop(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(noise_has_its_sd_and_correlation),
      cmocka_unit_test(noise_is_normal),
      cmocka_unit_test(eight_bit_rounds_to_nearest),
      cmocka_unit_test(plateaus_keep_their_values_under_gamma),
      cmocka_unit_test(shading_and_clipping),
      cmocka_unit_test(halo_moves_light),
      cmocka_unit_test(wall_shows_on_one_side),
      cmocka_unit_test(jpeg_keeps_flat_blocks_and_rounds_ramps),
      cmocka_unit_test(jpeg_halves_the_resolution_of_colours),
      cmocka_unit_test(same_spec_same_bytes_whatever_the_strip),
      cmocka_unit_test(file_holds_the_rows),
  };
  return cmocka_run_group_tests_name("render scanner", tests, NULL, NULL);
}

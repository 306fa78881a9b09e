/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows that were lost or read again, and seams between a sensor's chips: to the pixel. */
#include "render_picture.h"
#include "support/test.h"

#define DISC                                                                                       \
  "{\"schema\":\"foilgauge/render/1\",\"width_px\":250,\"height_px\":%d,\"discs\":[{"              \
  "\"centre_mm\":[0.66,0.66],\"radius_mm\":0.4}],\"scanner\":{" EXACT "%s}}"

/* The row of the plain picture that a row shows. */
static void assert_rows(const char *scanner, int64_t height, const int64_t *shows) {
  picture plain = draw_format(DISC, 250, ""), p = draw_format(DISC, (int)height, scanner);
  for (int64_t y = 0; y < height; y++) {
    if (shows[y] >= plain.height) continue;
    for (int64_t x = 0; x < p.width; x++)
      assert_near(p.dn[y * p.width + x], plain.dn[shows[y] * p.width + x], 1.0 / 256);
  }
  drop(&plain);
  drop(&p);
}

/* 0.5 mm is 94.5 rows: the first row behind it is 95. */
static void lost_rows_are_not_there(void **state) {
  (void)state;
  int64_t shows[250];
  for (int64_t y = 0; y < 250; y++)
    shows[y] = y < 95 ? y : y + 3;
  assert_rows(",\"rows_lost\":[{\"y_mm\":0.5,\"count\":3}]", 250, shows);
  for (int64_t y = 0; y < 250; y++)
    shows[y] = y < 95 ? y : y < 160 ? y + 1 : y + 21;
  assert_rows(",\"rows_lost\":[{\"y_mm\":0.845,\"count\":20},{\"y_mm\":0.5,\"count\":1}]", 250,
              shows);
}

/* The carriage stands still for three rows: the row before is seen four times in all. */
static void rows_are_read_again(void **state) {
  (void)state;
  int64_t shows[250];
  for (int64_t y = 0; y < 250; y++)
    shows[y] = y < 95 ? y : y < 98 ? 94 : y - 3;
  assert_rows(",\"rows_lost\":[{\"y_mm\":0.5,\"count\":-3}]", 250, shows);
}

/* Four pieces: rows are left out, come twice, and are seen again, between one and four. */
static void pieces_are_stitched(void **state) {
  (void)state;
  int64_t shows[250];
  for (int64_t y = 0; y < 250; y++)
    shows[y] = y < 67 ? y : y < 95 ? y - 3 : y < 129 ? y + 1 : y < 131 ? 129 : y - 1;
  assert_rows(",\"stitches\":[{\"y_mm\":0.35,\"rows\":-3},{\"y_mm\":0.5,\"rows\":4}],"
              "\"rows_lost\":[{\"y_mm\":0.68,\"count\":-2}]",
              250, shows);
}

/* By two columns to the left: true = nominal + d. */
static void pieces_shift_sideways(void **state) {
  (void)state;
  picture plain = draw_format(DISC, 250, "");
  picture p = draw_format(DISC, 250,
                          ",\"stitches\":[{\"y_mm\":0.5,\"rows\":-1,\"shift_um\":10.583333333}]");
  for (int64_t y = 0; y < 250; y++)
    for (int64_t x = 0; x + 2 < 250; x++)
      assert_near(p.dn[y * 250 + x], plain.dn[(y < 95 ? y * 250 : (y - 1) * 250 + 2) + x],
                  1.0 / 256);
  drop(&plain);
  drop(&p);
}

static void assert_truth(const picture *p, const char *words) {
  fg_context ctx = {0};
  char *json = NULL;
  assert_ok(&ctx, fg_render_truth_json(&ctx, p->spec, &json));
  if (!strstr(json, words)) fail_msg("'%s' is not in %s", words, json);
  free(json);
}

/* Row 95 is the first behind it: the jump is at 94.5 rows of 25.4 / 4800 mm. */
static void truth_names_the_step(void **state) {
  (void)state;
  picture p = draw_format(DISC, 250,
                          ",\"rows_lost\":[{\"y_mm\":0.5,\"count\":-2}],\"chip_seams\":[{"
                          "\"x_mm\":0.7,\"shift_um\":6,\"shift_y_um\":-4}]");
  assert_truth(&p, "\"id\": \"scan.row_step\"");
  assert_truth(&p, "\"amplitude_um\": -10.58333");
  assert_truth(&p, "\"y_mm\": 0.50006");
  assert_truth(&p, "\"rows\": -2");
  assert_truth(&p, "\"id\": \"scan.column_step\"");
  assert_truth(&p, "\"amplitude_um\": 6,");
  assert_truth(&p, "\"x_mm\": 0.70114");
  assert_truth(&p, "\"amplitude_y_um\": -4");
  drop(&p);
  p = draw_format(DISC, 250, ",\"stitches\":[{\"y_mm\":0.5,\"rows\":4,\"shift_um\":3}]");
  assert_truth(&p, "\"id\": \"scan.row_step\"");
  assert_truth(&p, "\"rows\": 4");
  assert_truth(&p, "\"amplitude_x_um\": 3");
  drop(&p);
}

/* A picture that is fitted to its content makes room for what rows read again push down. */
static void fitted_picture_grows(void **state) {
  (void)state;
  const char *format = "{\"schema\":\"foilgauge/render/1\",\"discs\":[{\"centre_mm\":[1,1],"
                       "\"radius_mm\":0.4}],\"scanner\":{" EXACT ",\"rows_lost\":[{\"y_mm\":0.2,"
                       "\"count\":%d}]}}";
  picture lost = draw_format(format, 7), again = draw_format(format, -7);
  assert_int_equal(again.height - lost.height, 7);
  drop(&lost);
  drop(&again);
}

/* Three chips: a disc's middle on each shows the sum of the seams before it. True = nominal + d:
 * the disc shows where nominal = true - d. */
static void chips_shift_discs_by_their_seams(void **state) {
  (void)state;
  picture p =
      draw(0, "{\"schema\":\"foilgauge/render/1\",\"width_px\":700,\"height_px\":200,"
              "\"discs\":[{\"centre_mm\":[0.5,0.5],\"radius_mm\":0.1},{\"centre_mm\":[1.5,0.5],"
              "\"radius_mm\":0.1},{\"centre_mm\":[2.5,0.5],\"radius_mm\":0.1}],\"scanner\":{" EXACT
              ",\"chip_seams\":[{\"x_mm\":1,\"shift_um\":7},{\"x_mm\":2,\"shift_um\":-9,"
              "\"shift_y_um\":5}]}}");
  const double expected[3][2] = {{0, 0}, {7, 0}, {-2, 5}};
  for (int chip = 0; chip < 3; chip++) {
    double area = 0, mx = 0, my = 0;
    for (int64_t y = 0; y < p.height; y++)
      for (int64_t x = chip * 189; x < (chip + 1) * 189; x++) {
        area += coverage(&p, x, y);
        mx += coverage(&p, x, y) * (double)x;
        my += coverage(&p, x, y) * (double)y;
      }
    assert_near((0.5 + chip - mx / area * pixel) * 1e3, expected[chip][0], 0.02);
    assert_near((0.5 - my / area * pixel) * 1e3, expected[chip][1], 0.02);
  }
  drop(&p);
}

/* A seam through a disc is as sharp as a pixel: the columns before it are as they were. */
static void seam_is_sharp(void **state) {
  (void)state;
  picture plain = draw_format(DISC, 250, "");
  picture p = draw_format(
      DISC, 250, ",\"chip_seams\":[{\"x_mm\":0.66,\"shift_um\":0,\"shift_y_um\":10.583333333}]");
  for (int64_t y = 0; y + 2 < 250; y++)
    for (int64_t x = 0; x < 250; x++)
      assert_near(p.dn[y * 250 + x], plain.dn[(y + (x > 124 ? 2 : 0)) * 250 + x], 1.0 / 256);
  drop(&plain);
  drop(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lost_rows_are_not_there),
      cmocka_unit_test(rows_are_read_again),
      cmocka_unit_test(pieces_are_stitched),
      cmocka_unit_test(pieces_shift_sideways),
      cmocka_unit_test(truth_names_the_step),
      cmocka_unit_test(fitted_picture_grows),
      cmocka_unit_test(chips_shift_discs_by_their_seams),
      cmocka_unit_test(seam_is_sharp),
  };
  return cmocka_run_group_tests_name("render jumps", tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Red, green and blue of a scan are read apart after everything else, as each would be by itself.
 */

#include "foilgauge/scan.h"
#include "png_fixture.h"
#include "support/test.h"

enum { WIDTH = 61, HEIGHT = 23 };

static picture make_picture(int colour_type, int bit_depth, int interlace) {
  picture p = {.width = WIDTH,
               .height = HEIGHT,
               .bit_depth = bit_depth,
               .colour_type = colour_type,
               .interlace = interlace,
               .phys = {PHYS_4800_DPI, PHYS_4800_DPI},
               .phys_unit = PNG_RESOLUTION_METER};
  uint32_t seed = 9;
  if (colour_type == PNG_COLOR_TYPE_PALETTE) p.palette_size = 1 << bit_depth;
  for (int i = 0; i < p.palette_size; i++) {
    uint32_t c = next_random(&seed);
    p.palette[i] = (png_color){(png_byte)c, (png_byte)(c >> 8), (png_byte)(c >> 16)};
  }
  return p;
}

static char *save(const picture *p) {
  uint16_t *samples = make_samples(p, 5);
  bytes file = write_png(p, samples);
  char *path = save_bytes(file.data, file.size);
  free(file.data);
  free(samples);
  return path;
}

/* All rows of one channel, and the scan as it is left. */
static fg_scan *read_channel(const char *path, fg_channel channel, uint8_t *rows) {
  fg_context ctx = {0};
  fg_scan *scan = NULL;
  if (fg_scan_open(&ctx, path, &(fg_scan_options){.channel = channel}, &scan) != FG_OK)
    fail_msg("%s", ctx.message);
  int64_t stride = WIDTH * fg_scan_get_info(scan)->bytes_per_pixel;
  if (fg_scan_read_rows(&ctx, scan, HEIGHT, rows, stride) != FG_OK) fail_msg("%s", ctx.message);
  return scan;
}

static void assert_apart(const picture *p) {
  char *path = save(p), hex[65];
  uint8_t alone[3][HEIGHT * WIDTH * 2], apart[3][WIDTH * 2];
  fg_context ctx = {0};
  for (int k = 1; k < 3; k++)
    fg_scan_close(read_channel(path, (fg_channel)(FG_CHANNEL_RED + k), alone[k]));
  fg_scan *scan = read_channel(path, FG_CHANNEL_RED, alone[0]);
  size_t row = WIDTH * (size_t)fg_scan_get_info(scan)->bytes_per_pixel;
  assert_ok(&ctx, fg_scan_sha256(&ctx, scan, hex));
  assert_true(fg_scan_has_colours(scan));
  assert_ok(&ctx, fg_scan_begin_colours(&ctx, scan));
  for (size_t y = 0; y < HEIGHT; y++) {
    void *planes[3] = {apart[0], apart[1], apart[2]};
    assert_ok(&ctx, fg_scan_read_colours(&ctx, scan, planes));
    for (int k = 0; k < 3; k++)
      assert_memory_equal(apart[k], alone[k] + y * row, row);
  }
  fg_scan_close(scan);
  unlink(path);
  free(path);
}

static void channels_of_every_colour_type_are_separated(void **state) {
  (void)state;
  static const int kinds[][2] = {{PNG_COLOR_TYPE_RGB, 8},       {PNG_COLOR_TYPE_RGB, 16},
                                 {PNG_COLOR_TYPE_RGB_ALPHA, 8}, {PNG_COLOR_TYPE_RGB_ALPHA, 16},
                                 {PNG_COLOR_TYPE_PALETTE, 4},   {PNG_COLOR_TYPE_PALETTE, 8}};
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
    for (int interlace = 0; interlace < 2; interlace++) {
      picture p = make_picture(kinds[i][0], kinds[i][1], interlace);
      assert_apart(&p);
    }
}

static void gray_has_no_colours(void **state) {
  (void)state;
  picture p = make_picture(PNG_COLOR_TYPE_GRAY, 8, 0);
  char *path = save(&p);
  uint8_t rows[HEIGHT * WIDTH];
  fg_context ctx = {0};
  fg_scan *scan = read_channel(path, FG_CHANNEL_GREEN, rows);
  assert_false(fg_scan_has_colours(scan));
  assert_status(&ctx, fg_scan_begin_colours(&ctx, scan), FG_ERR_USAGE);
  fg_scan_close(scan);
  unlink(path);
  free(path);
}

/* A file that has become shorter since its rows were read says so. */
static void a_file_that_shrinks_is_an_error(void **state) {
  (void)state;
  picture p = make_picture(PNG_COLOR_TYPE_RGB, 8, 0);
  char *path = save(&p);
  uint8_t rows[HEIGHT * WIDTH], apart[3][WIDTH];
  void *planes[3] = {apart[0], apart[1], apart[2]};
  fg_context ctx = {0};
  fg_scan *scan = read_channel(path, FG_CHANNEL_GREEN, rows);
  assert_int_equal(truncate(path, 300), 0);
  fg_status status = fg_scan_begin_colours(&ctx, scan);
  for (int y = 0; y < HEIGHT && status == FG_OK; y++)
    status = fg_scan_read_colours(&ctx, scan, planes);
  assert_status(NULL, status, FG_ERR_DATA);
  assert_has(ctx.message, path);
  fg_scan_close(scan);
  unlink(path);
  free(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(channels_of_every_colour_type_are_separated),
      cmocka_unit_test(gray_has_no_colours),
      cmocka_unit_test(a_file_that_shrinks_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

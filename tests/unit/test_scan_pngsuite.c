/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PngSuite: the valid files decode as libpng's own expansion says, the broken ones are refused, and
 * what has crashed readers crashes nothing. */
#include <dirent.h>
#include <math.h>

#include "foilgauge/scan.h"
#include "png_fixture.h"
#include "support/test.h"

static char *suite_folder(void) {
  const char *shared = getenv("FOILGAUGE_SHARED");
  char *folder = NULL;
  if (asprintf(&folder, "%s/reference/pngsuite", shared && *shared ? shared : "../shared") < 0)
    return NULL;
  return folder;
}

typedef void visit(const char *path, const char *name);

/* Visits all PNGs of a folder of the suite and returns their number. */
static int visit_all(const char *part, visit *look) {
  char *suite = suite_folder(), *folder = NULL;
  if (asprintf(&folder, "%s/%s", suite, part) < 0) return 0;
  int count = 0;
  DIR *entries = opendir(folder);
  for (struct dirent *entry; entries && (entry = readdir(entries));) {
    char *path = NULL;
    if (!strstr(entry->d_name, ".png")) continue;
    if (asprintf(&path, "%s/%s", folder, entry->d_name) < 0) break;
    look(path, entry->d_name);
    count++;
    free(path);
  }
  if (entries) closedir(entries);
  free(folder);
  free(suite);
  return count;
}

static fg_status read_scan(fg_context *ctx, const char *path, fg_scan_info *info, uint8_t **rows) {
  fg_scan *scan = NULL;
  fg_status status = fg_scan_open(
      ctx, path, &(fg_scan_options){.dpi = 4800, .channel = FG_CHANNEL_LUMINANCE}, &scan);
  if (status != FG_OK) return status;
  *info = *fg_scan_get_info(scan);
  size_t stride = (size_t)info->width_px * (size_t)info->bytes_per_pixel;
  *rows = malloc(stride * (size_t)info->height_px);
  status = fg_scan_read_rows(ctx, scan, info->height_px, *rows, (int64_t)stride);
  fg_scan_close(scan);
  return status;
}

/* libpng's own way: expanded to 8- or 16-bit gray or RGB without alpha, whole image at once. */
static png_bytep *decode(const char *path, png_structp *png, png_infop *info) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  *png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
  *info = png_create_info_struct(*png);
  png_init_io(*png, file);
  png_read_png(*png, *info, PNG_TRANSFORM_EXPAND | PNG_TRANSFORM_STRIP_ALPHA, NULL);
  fclose(file);
  return png_get_rows(*png, *info);
}

static double sample_at(const uint8_t *row, size_t index, int bits) {
  return bits == 16 ? row[2 * index] * 256.0 + row[2 * index + 1] : row[index];
}

static double gray_at(const uint8_t *row, size_t x, int channels, int bits) {
  if (channels < 3) return sample_at(row, x, bits);
  return 0.2126 * sample_at(row, 3 * x, bits) + 0.7152 * sample_at(row, 3 * x + 1, bits) +
         0.0722 * sample_at(row, 3 * x + 2, bits);
}

static void compare(const char *name, const fg_scan_info *info, const uint8_t *rows,
                    png_bytep *wanted, int channels, int bits) {
  double tolerance = channels < 3 ? 0 : bits == 16 ? 1.3 : 0.51;
  for (int64_t y = 0; y < info->height_px; y++)
    for (int64_t x = 0; x < info->width_px; x++) {
      size_t at = (size_t)(y * info->width_px + x);
      uint16_t wide = rows[at];
      if (info->bytes_per_pixel == 2) memcpy(&wide, rows + 2 * at, 2);
      double gray = gray_at(wanted[y], (size_t)x, channels, bits);
      if (fabs(wide - gray) > tolerance)
        fail_msg("%s at %d,%d: %d, not %g", name, (int)x, (int)y, wide, gray);
    }
}

/* libpng strips alpha only where the file has it; tRNS expands to a channel that stays. */
static void valid_decodes_as_libpng_says(const char *path, const char *name) {
  if (name[0] == 'x') return;
  fg_context ctx = {0};
  fg_scan_info info = {0};
  uint8_t *rows = NULL;
  if (read_scan(&ctx, path, &info, &rows) != FG_OK) fail_msg("%s: %s", name, ctx.message);
  png_structp png;
  png_infop png_info;
  png_bytep *wanted = decode(path, &png, &png_info);
  assert_int_equal(info.width_px, png_get_image_width(png, png_info));
  assert_int_equal(info.height_px, png_get_image_height(png, png_info));
  int bits = png_get_bit_depth(png, png_info);
  assert_int_equal(info.bytes_per_pixel, bits / 8);
  compare(name, &info, rows, wanted, png_get_channels(png, png_info), bits);
  png_destroy_read_struct(&png, &png_info, NULL);
  free(rows);
}

static void broken_is_refused(const char *path, const char *name) {
  if (name[0] != 'x') return;
  fg_context ctx = {0};
  fg_scan_info info = {0};
  uint8_t *rows = NULL;
  if (read_scan(&ctx, path, &info, &rows) != FG_ERR_DATA) fail_msg("%s: %s", name, ctx.message);
  assert_has(ctx.message, name);
  free(rows);
}

static void crasher_is_harmless(const char *path, const char *name) {
  fg_context ctx = {0};
  fg_scan_info info = {0};
  uint8_t *rows = NULL;
  fg_status status = read_scan(&ctx, path, &info, &rows);
  bool wrong_sum = !strcmp(name, "badcrc.png") || !strcmp(name, "badadler.png");
  bool huge = !strncmp(name, "huge_", 5);
  if ((wrong_sum || huge) && status != FG_ERR_DATA) fail_msg("%s: %d", name, status);
  if (status != FG_OK && status != FG_ERR_DATA) fail_msg("%s: %s", name, ctx.message);
  free(rows);
}

/* Each uses a colour that its palette does not have. */
static void bad_palette_is_refused(const char *path, const char *name) {
  fg_context ctx = {0};
  fg_scan_info info = {0};
  uint8_t *rows = NULL;
  if (read_scan(&ctx, path, &info, &rows) != FG_ERR_DATA) fail_msg("%s: passes", name);
  if (!strstr(ctx.message, "of a palette of")) fail_msg("%s: %s", name, ctx.message);
  free(rows);
}

static void valid_files(void **state) {
  (void)state;
  assert_int_equal(visit_all("png", valid_decodes_as_libpng_says), 161 + 14);
}

static void broken_files(void **state) {
  (void)state;
  assert_int_equal(visit_all("png", broken_is_refused), 161 + 14);
}

static void crashers(void **state) {
  (void)state;
  assert_true(visit_all("crashers", crasher_is_harmless) > 20);
}

static void bad_palettes(void **state) {
  (void)state;
  assert_int_equal(visit_all("badpal", bad_palette_is_refused), 9);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(valid_files),
      cmocka_unit_test(broken_files),
      cmocka_unit_test(crashers),
      cmocka_unit_test(bad_palettes),
  };
  char *folder = suite_folder();
  bool missing = !folder || access(folder, R_OK) != 0;
  free(folder);
  if (missing) {
    puts("skipped: PngSuite is not here");
    return 77;
  }
  return cmocka_run_group_tests_name("scan_pngsuite", tests, NULL, NULL);
}

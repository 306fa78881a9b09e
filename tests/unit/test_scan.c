/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scans of every kind come out as the gray values that went in; the resolution is that of pHYs or
 * of the caller; the SHA-256 is the file's. */
#include <math.h>
#include <pthread.h>
#include <signal.h>

#include "core/sha256.h"
#include "foilgauge/scan.h"
#include "png_fixture.h"
#include "support/test.h"

/* Pixels per metre. */
#define PHYS_1200_DPI 47244

static const picture plain = {.width = 61,
                              .height = 23,
                              .bit_depth = 8,
                              .colour_type = PNG_COLOR_TYPE_GRAY,
                              .phys = {PHYS_4800_DPI, PHYS_4800_DPI},
                              .phys_unit = PNG_RESOLUTION_METER};

static const struct {
  int colour_type, bit_depth;
} kinds[] = {
    {PNG_COLOR_TYPE_GRAY, 1},        {PNG_COLOR_TYPE_GRAY, 2},       {PNG_COLOR_TYPE_GRAY, 4},
    {PNG_COLOR_TYPE_GRAY, 8},        {PNG_COLOR_TYPE_GRAY, 16},      {PNG_COLOR_TYPE_GRAY_ALPHA, 8},
    {PNG_COLOR_TYPE_GRAY_ALPHA, 16}, {PNG_COLOR_TYPE_RGB, 8},        {PNG_COLOR_TYPE_RGB, 16},
    {PNG_COLOR_TYPE_RGB_ALPHA, 8},   {PNG_COLOR_TYPE_RGB_ALPHA, 16}, {PNG_COLOR_TYPE_PALETTE, 1},
    {PNG_COLOR_TYPE_PALETTE, 2},     {PNG_COLOR_TYPE_PALETTE, 4},    {PNG_COLOR_TYPE_PALETTE, 8},
};

/* Gray value that the header promises, in floating point from the samples. */
static double expected_gray(const picture *p, const uint16_t *pixel) {
  if (p->palette_size) {
    png_color c = p->palette[pixel[0]];
    return 0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue;
  }
  if (p->colour_type & PNG_COLOR_MASK_COLOR)
    return 0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2];
  if (p->bit_depth < 8) return pixel[0] * 255.0 / ((1 << p->bit_depth) - 1);
  return pixel[0];
}

static void check_rows(const picture *p, const uint16_t *samples, const uint8_t *rows,
                       size_t stride) {
  int channels = picture_channels(p);
  /* Rounding, plus the weights' own (half of 1/65536 for each of three, times 65535). */
  bool mixed = (p->colour_type & PNG_COLOR_MASK_COLOR) != 0;
  double tolerance = !mixed ? 1e-9 : p->bit_depth == 16 ? 1.3 : 0.51;
  for (size_t y = 0; y < p->height; y++)
    for (size_t x = 0; x < p->width; x++) {
      double value = rows[y * stride + x];
      if (p->bit_depth == 16) {
        uint16_t wide;
        memcpy(&wide, rows + y * stride + 2 * x, 2);
        value = wide;
      }
      double wanted = expected_gray(p, samples + (y * p->width + x) * (size_t)channels);
      if (fabs(value - wanted) > tolerance)
        fail_msg("type %d depth %d interlace %d size %ux%u at %zu,%zu: %g, not %g", p->colour_type,
                 p->bit_depth, p->interlace, p->width, p->height, x, y, value, wanted);
    }
}

/* Reads in uneven portions and checks that nothing behind a row is touched. */
static void round_trip(const picture *p, uint32_t seed) {
  uint16_t *samples = make_samples(p, seed);
  bytes file = write_png(p, samples);
  char *path = save_bytes(file.data, file.size);
  fg_context ctx = {0};
  fg_scan *scan = NULL;
  if (fg_scan_open(&ctx, path, &(fg_scan_options){.channel = FG_CHANNEL_LUMINANCE}, &scan) != FG_OK)
    fail_msg("%s", ctx.message);
  const fg_scan_info *info = fg_scan_get_info(scan);
  assert_int_equal(info->width_px, p->width);
  assert_int_equal(info->height_px, p->height);
  assert_int_equal(info->bit_depth, p->bit_depth);
  assert_int_equal(info->bytes_per_pixel, p->bit_depth == 16 ? 2 : 1);

  size_t row_bytes = p->width * (size_t)info->bytes_per_pixel, stride = row_bytes + 5;
  uint8_t *rows = malloc(stride * p->height);
  memset(rows, 0xa5, stride * p->height);
  for (int64_t y = 0, portion = 1; y < p->height; y += portion, portion = portion % 3 + 1) {
    if (portion > p->height - y) portion = p->height - y;
    if (fg_scan_read_rows(&ctx, scan, portion, rows + (size_t)y * stride, (int64_t)stride) != FG_OK)
      fail_msg("%s", ctx.message);
  }
  check_rows(p, samples, rows, stride);
  for (size_t y = 0; y < p->height; y++)
    for (size_t i = row_bytes; i < stride; i++)
      assert_int_equal(rows[y * stride + i], 0xa5);
  assert_status(&ctx, fg_scan_read_rows(&ctx, scan, 1, rows, (int64_t)stride), FG_ERR_USAGE);

  fg_scan_close(scan);
  unlink(path);
  free(path);
  free(rows);
  free(file.data);
  free(samples);
}

/* Of `columns` × `rows` samples from (x, y) on. */
static double expected_mean(const picture *p, const uint16_t *samples, size_t x, size_t y,
                            const int averaged[2]) {
  double sum = 0;
  for (size_t r = 0; r < (size_t)averaged[1]; r++)
    for (size_t c = 0; c < (size_t)averaged[0]; c++) {
      size_t at = (y * (size_t)averaged[1] + r) * p->width + x * (size_t)averaged[0] + c;
      sum += round(expected_gray(p, samples + at * (size_t)picture_channels(p)));
    }
  return sum / (averaged[0] * averaged[1]);
}

/* Reads a picture whose file states unequal resolutions, and its green channel apart. */
static void check_averages(const picture *p, const int averaged[2]) {
  uint16_t *samples = make_samples(p, 5);
  bytes file = write_png(p, samples);
  char *path = save_bytes(file.data, file.size);
  fg_scan *scan = NULL;
  const fg_scan_options options = {.channel = FG_CHANNEL_LUMINANCE};
  assert_ok(&test_context, fg_scan_open(&test_context, path, &options, &scan));
  const fg_scan_info *info = fg_scan_get_info(scan);
  assert_int_equal(info->width_px, p->width / (size_t)averaged[0]);
  assert_int_equal(info->height_px, p->height / (size_t)averaged[1]);
  assert_int_equal(info->averaged[0], averaged[0]);
  assert_int_equal(info->averaged[1], averaged[1]);
  assert_near(info->dpi[0], info->dpi[1], 1e-9);
  assert_non_null(strstr(info->warning, "averaged"));
  size_t width = (size_t)info->width_px;
  uint16_t *row = malloc(width * 2), *red = malloc(width * 2), *blue = malloc(width * 2);
  for (size_t y = 0; y < (size_t)info->height_px; y++) {
    assert_ok(&test_context, fg_scan_read_rows(&test_context, scan, 1, row, 2 * (int64_t)width));
    for (size_t x = 0; x < width; x++) {
      double value = p->bit_depth == 16 ? row[x] : ((uint8_t *)row)[x];
      assert_near(value, expected_mean(p, samples, x, y, averaged),
                  p->bit_depth == 16 ? 2.5 : 1.01);
    }
  }
  char hex[65];
  assert_ok(&test_context, fg_scan_sha256(&test_context, scan, hex));
  if (fg_scan_has_colours(scan)) {
    assert_ok(&test_context, fg_scan_begin_colours(&test_context, scan));
    for (size_t y = 0; y < (size_t)info->height_px; y++) {
      assert_ok(&test_context,
                fg_scan_read_colours(&test_context, scan, (void *[]){red, row, blue}));
      double sum = 0;
      for (int r = 0; r < averaged[1]; r++)
        for (int c = 0; c < averaged[0]; c++)
          sum += samples[3 * ((y * (size_t)averaged[1] + (size_t)r) * p->width + (size_t)c) + 1];
      double value = p->bit_depth == 16 ? row[0] : ((uint8_t *)row)[0];
      assert_near(value, sum / (averaged[0] * averaged[1]), 0.51);
    }
  }
  fg_scan_close(scan);
  unlink(path);
  free(path);
  free(row);
  free(red);
  free(blue);
  free(file.data);
  free(samples);
}

/* Less than a pixel at the right and below is left out, but read. */
static void pixels_of_unequal_sides_are_averaged(void **state) {
  static const int ratios[][2] = {{2, 1}, {1, 2}, {3, 1}, {1, 4}};
  static const int types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_RGB};
  (void)state;
  for (size_t i = 0; i < 4 * sizeof ratios / sizeof ratios[0]; i++) {
    in_row("ratios[%zu]", i);
    const int *averaged = ratios[i / 4];
    picture p = plain;
    p.colour_type = types[i % 2];
    p.bit_depth = i / 2 % 2 ? 16 : 8;
    p.phys[0] = PHYS_1200_DPI * (uint32_t)averaged[0];
    p.phys[1] = PHYS_1200_DPI * (uint32_t)averaged[1];
    check_averages(&p, averaged);
  }
}

static picture make_kind(size_t kind, uint32_t seed) {
  picture p = plain;
  p.colour_type = kinds[kind].colour_type;
  p.bit_depth = kinds[kind].bit_depth;
  if (p.colour_type == PNG_COLOR_TYPE_PALETTE) {
    p.palette_size = p.bit_depth == 8 ? 200 : 1 << p.bit_depth;
    for (int i = 0; i < p.palette_size; i++) {
      uint32_t colour = next_random(&seed);
      p.palette[i] =
          (png_color){(png_byte)colour, (png_byte)(colour >> 8), (png_byte)(colour >> 16)};
    }
  }
  return p;
}

static void every_colour_type_reads_back_equal(void **state) {
  (void)state;
  for (size_t kind = 0; kind < sizeof kinds / sizeof kinds[0]; kind++)
    for (int interlace = 0; interlace < 2; interlace++) {
      picture p = make_kind(kind, 7);
      p.interlace = interlace;
      round_trip(&p, 11);
    }
}

static void transparency_is_dropped(void **state) {
  (void)state;
  static const size_t with_trns[] = {0, 3, 4, 7, 8, 11, 14};
  for (size_t i = 0; i < sizeof with_trns / sizeof with_trns[0]; i++) {
    in_row("with_trns[%zu]", i);
    picture p = make_kind(with_trns[i], 9);
    p.with_trns = 1;
    round_trip(&p, 13);
  }
}

/* Adam7 has empty passes in small images. */
static void small_interlaced_images_are_whole(void **state) {
  (void)state;
  picture p = make_kind(8, 1);
  p.interlace = PNG_INTERLACE_ADAM7;
  for (p.width = 1; p.width <= 10; p.width++)
    for (p.height = 1; p.height <= 10; p.height++)
      round_trip(&p, p.width * 16 + p.height);
}

static void many_small_pieces_are_joined(void **state) {
  (void)state;
  picture p = plain;
  p.width = 3001;
  p.height = 97;
  p.idat_bytes = 64;
  round_trip(&p, 17);
}

static void equal_colours_keep_their_value(void **state) {
  (void)state;
  picture p = make_kind(8, 1);
  p.width = 256;
  p.height = 256;
  uint16_t *samples = make_samples(&p, 1);
  for (size_t i = 0; i < 65536; i++)
    samples[3 * i] = samples[3 * i + 1] = samples[3 * i + 2] = (uint16_t)i;
  bytes file = write_png(&p, samples);
  char *path = save_bytes(file.data, file.size);
  uint16_t *rows = malloc(65536 * 2);
  fg_scan *scan = NULL;
  assert_ok(&test_context, fg_scan_open(&test_context, path, NULL, &scan));
  assert_ok(&test_context, fg_scan_read_rows(&test_context, scan, 256, rows, 512));
  for (size_t i = 0; i < 65536; i++)
    assert_int_equal(rows[i], i);
  fg_scan_close(scan);
  unlink(path);
  free(path);
  free(rows);
  free(file.data);
  free(samples);
}

static fg_status open_with(const picture *p, double dpi, fg_scan_info *info, fg_context *ctx) {
  uint16_t *samples = make_samples(p, 3);
  bytes file = write_png(p, samples);
  char *path = save_bytes(file.data, file.size);
  fg_scan *scan = NULL;
  fg_status status = fg_scan_open(ctx, path, &(fg_scan_options){.dpi = dpi}, &scan);
  if (status == FG_OK) *info = *fg_scan_get_info(scan);
  assert_true((status == FG_OK) == (scan != NULL));
  fg_scan_close(scan);
  unlink(path);
  free(path);
  free(file.data);
  free(samples);
  return status;
}

/* Pixels per metre, unit, --dpi; then the status, dpi of both axes, what the error must say. */
static const struct {
  uint32_t phys[2];
  int unit;
  double option;
  fg_status status;
  double dpi[2];
  const char *says;
} resolutions[] = {
    {{188976, 188976}, 1, 0, FG_OK, {4800, 4800}, NULL},
    {{188976, 94488}, 1, 0, FG_OK, {2400, 2400}, NULL},
    {{188976, 141732}, 1, 0, FG_OK, {4800, 3600}, NULL},
    {{47244, 47244}, 1, 0, FG_OK, {1200, 1200}, NULL},
    {{189000, 188950}, 1, 0, FG_OK, {4800.6, 4799.33}, NULL},
    {{188976, 188976}, 1, 1200.5, FG_OK, {1200.5, 1200.5}, NULL},
    {{0, 0}, 0, 4800, FG_OK, {4800, 4800}, NULL},
    {{0, 188976}, 1, 600, FG_OK, {600, 600}, NULL},
    {{0, 0}, 0, 0, FG_ERR_DATA, {0}, "--dpi"},
    {{188976, 188976}, 0, 0, FG_ERR_DATA, {0}, "--dpi"},
    {{0, 188976}, 1, 0, FG_ERR_DATA, {0}, "0 dpi in x"},
    {{188976, 0}, 1, 0, FG_ERR_DATA, {0}, "0 dpi in y"},
    {{1, 1}, 1, 0, FG_ERR_DATA, {0}, "no scanner"},
    {{0x7fffffff, 188976}, 1, 0, FG_ERR_DATA, {0}, "no scanner"},
    {{188976, 188976}, 1, -1, FG_ERR_USAGE, {0}, "--dpi"},
    {{188976, 188976}, 1, NAN, FG_ERR_USAGE, {0}, "--dpi"},
    {{188976, 188976}, 1, INFINITY, FG_ERR_USAGE, {0}, "--dpi"},
    {{188976, 188976}, 1, 1e300, FG_ERR_USAGE, {0}, "--dpi"},
    {{188976, 188976}, 1, 1e-300, FG_ERR_USAGE, {0}, "--dpi"},
};

static void resolution_comes_from_file_or_caller(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof resolutions / sizeof resolutions[0]; i++) {
    in_row("resolutions[%zu]", i);
    picture p = plain;
    memcpy(p.phys, resolutions[i].phys, sizeof p.phys);
    p.phys_unit = resolutions[i].unit;
    fg_context ctx = {0};
    fg_scan_info info = {0};
    fg_status status = open_with(&p, resolutions[i].option, &info, &ctx);
    if (status != resolutions[i].status) fail_msg("row %zu: %d %s", i, status, ctx.message);
    if (resolutions[i].says && !strstr(ctx.message, resolutions[i].says))
      fail_msg("row %zu: %s", i, ctx.message);
    for (int axis = 0; axis < 2; axis++)
      assert_true(fabs(info.dpi[axis] - resolutions[i].dpi[axis]) < 1e-9);
    if (status == FG_OK && resolutions[i].unit == 0) assert_true(isnan(info.dpi_file[0]));
    if (status == FG_OK && resolutions[i].unit == 1)
      assert_true(fabs(info.dpi_file[1] - resolutions[i].phys[1] * 0.0254) < 1e-9);
  }
}

static void zero_dpi_from_a_user_is_wrong(void **state) {
  (void)state;
  fg_context ctx = {0};
  assert_status(&ctx, fg_scan_check_dpi(&ctx, 0), FG_ERR_USAGE);
  assert_has(ctx.message, "--dpi");
  assert_ok(&ctx, fg_scan_check_dpi(&ctx, 4800));
}

/* The sum of the same bytes by nettle's plain call. */
static void known_sum(const bytes *file, char hex[65]) {
  struct sha256_ctx sum;
  sha256_init(&sum);
  sha256_update(&sum, file->size, file->data);
  fg_sha256_finish(&sum, hex);
}

typedef struct sending {
  int descriptor;
  const bytes *file;
} sending;

/* In small odd pieces, as pipes deliver. */
static void *send_slowly(void *argument) {
  const sending *job = argument;
  for (size_t at = 0; at < job->file->size; at += 997) {
    size_t left = job->file->size - at;
    if (write(job->descriptor, job->file->data + at, left < 997 ? left : 997) < 0) break;
  }
  close(job->descriptor);
  return NULL;
}

static void pipe_is_read_hashed_and_drained(void **state) {
  (void)state;
  picture p = plain;
  p.width = 700;
  p.height = 300;
  uint16_t *samples = make_samples(&p, 5);
  bytes file = write_png(&p, samples);
  size_t image_end = file.size;
  file.data = realloc(file.data, file.size + 300000); /* more than a pipe holds */
  file.size += 300000;
  memset(file.data + image_end, 'x', 300000);
  signal(SIGPIPE, SIG_IGN);
  int ends[2], saved = dup(STDIN_FILENO);
  assert_int_equal(pipe(ends), 0);
  dup2(ends[0], STDIN_FILENO);
  close(ends[0]);
  sending job = {ends[1], &file};
  pthread_t thread;
  assert_int_equal(pthread_create(&thread, NULL, send_slowly, &job), 0);

  uint8_t *rows = malloc((size_t)p.width * p.height);
  fg_context ctx = {0};
  fg_scan *scan = NULL;
  char hex[65], wanted[65];
  if (fg_scan_open(&ctx, "-", NULL, &scan) != FG_OK) fail_msg("%s", ctx.message);
  assert_status(&ctx, fg_scan_sha256(&ctx, scan, hex), FG_ERR_USAGE);
  assert_ok(&ctx, fg_scan_read_rows(&ctx, scan, 300, rows, 700));
  assert_ok(&ctx, fg_scan_sha256(&ctx, scan, hex));
  /* Closing the pipe's end first: a sender that was not drained then fails instead of waiting. */
  fg_scan_close(scan);
  dup2(saved, STDIN_FILENO);
  close(saved);
  pthread_join(thread, NULL);
  known_sum(&file, wanted);
  assert_string_equal(hex, wanted);
  check_rows(&p, samples, rows, 700);
  free(rows);
  free(file.data);
  free(samples);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_colour_type_reads_back_equal),
      cmocka_unit_test(transparency_is_dropped),
      cmocka_unit_test(small_interlaced_images_are_whole),
      cmocka_unit_test(many_small_pieces_are_joined),
      cmocka_unit_test(equal_colours_keep_their_value),
      cmocka_unit_test(pixels_of_unequal_sides_are_averaged),
      cmocka_unit_test(resolution_comes_from_file_or_caller),
      cmocka_unit_test(zero_dpi_from_a_user_is_wrong),
      cmocka_unit_test(pipe_is_read_hashed_and_drained),
  };
  return cmocka_run_group_tests_name("scan", tests, NULL, NULL);
}

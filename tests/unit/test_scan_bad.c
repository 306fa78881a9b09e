/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A table of bad files and the error that each must get. */
#include <sys/stat.h>

#include "foilgauge/scan.h"
#include "png_fixture.h"
#include "support/test.h"

static const picture plain = {.width = 301,
                              .height = 200,
                              .bit_depth = 8,
                              .colour_type = PNG_COLOR_TYPE_GRAY,
                              .phys = {PHYS_4800_DPI, PHYS_4800_DPI},
                              .phys_unit = PNG_RESOLUTION_METER,
                              .idat_bytes = 4000};

static bytes make_plain(void) {
  uint16_t *samples = make_samples(&plain, 21);
  bytes file = write_png(&plain, samples);
  free(samples);
  return file;
}

/* Opens and reads to the end, in portions, as the program would. */
static fg_status read_all(fg_context *ctx, const char *path, const fg_scan_options *options) {
  fg_scan *scan = NULL;
  fg_status status = fg_scan_open(ctx, path, options, &scan);
  if (status != FG_OK) {
    assert_null(scan);
    return status;
  }
  const fg_scan_info *info = fg_scan_get_info(scan);
  size_t stride = (size_t)info->width_px * (size_t)info->bytes_per_pixel;
  uint8_t *rows = malloc(stride * 16);
  for (int64_t y = 0; y < info->height_px && status == FG_OK; y += 16) {
    int64_t left = info->height_px - y;
    status = fg_scan_read_rows(ctx, scan, left < 16 ? left : 16, rows, (int64_t)stride);
  }
  if (status != FG_OK)
    assert_status(NULL, fg_scan_read_rows(NULL, scan, 1, rows, (int64_t)stride), FG_ERR_USAGE);
  free(rows);
  fg_scan_close(scan);
  return status;
}

/* Every error names the file and says what to do. */
static void expect(const char *label, const bytes *file, fg_status wanted, const char *says) {
  fg_context ctx = {0};
  char *path = save_bytes(file->data, file->size);
  fg_status status = read_all(&ctx, path, NULL);
  if (status != wanted) fail_msg("%s: status %d, not %d: %s", label, status, wanted, ctx.message);
  if (wanted != FG_OK && !strstr(ctx.message, path))
    fail_msg("%s: no path: %s", label, ctx.message);
  if (says && !strstr(ctx.message, says))
    fail_msg("%s: does not say '%s': %s", label, says, ctx.message);
  unlink(path);
  free(path);
}

#define HEAD(text)                                                                                 \
  { text, sizeof(text) - 1 }

static const struct {
  const char *label;
  struct {
    const char *data;
    size_t size;
  } head;
  const char *says;
} strangers[] = {
    {"empty", HEAD(""), "is empty"},
    {"text", HEAD("x,y\n1,2\n3,4\n"), "is a text"},
    {"UTF-8 text", HEAD("Folie \xc3\xbc\n"), "is a text"},
    {"zeros", HEAD("\0\0\0\0\0\0\0\0\0\0\0\0"), "is not a scan"},
    {"JPEG", HEAD("\xff\xd8\xff\xe0\0\x10JFIF\0"), "--allow-lossy"},
    {"TIFF", HEAD("II*\0\x08\0\0\0\0\0\0\0"), "damaged TIFF"},
    {"TIFF, big-endian", HEAD("MM\0*\0\0\0\x08\0\0\0\0"), "damaged TIFF"},
    {"BigTIFF", HEAD("II+\0\x08\0\0\0\0\0\0\0"), "damaged TIFF"},
    {"BMP", HEAD("BM\x36\0\0\0\0\0\0\0\x36\0"), "is a BMP"},
    {"GIF", HEAD("GIF89a\1\0\1\0\0\0"), "is a GIF"},
    {"PDF", HEAD("%PDF-1.7\n"), "is a PDF"},
    {"text mode, no carriage return", HEAD("\x89PNG\n\x1a\n\0\0\0\rIHDR"), "text mode"},
    {"text mode, 7 bits", HEAD("\x09PNG\r\n\x1a\n\0\0\0\rIHDR"), "text mode"},
    {"part of the signature", HEAD("\x89PN"), "is cut off"},
    {"signature only", HEAD("\x89PNG\r\n\x1a\n"), "is cut off"},
};

static void strangers_are_called_by_name(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof strangers / sizeof strangers[0]; i++) {
    in_row("strangers[%zu]", i);
    bytes file = {(uint8_t *)strangers[i].head.data, strangers[i].head.size};
    expect(strangers[i].label, &file, FG_ERR_DATA, strangers[i].says);
  }
}

static void truncation_is_fatal_at_every_offset(void **state) {
  (void)state;
  bytes file = make_plain();
  size_t image = find_chunk(&file, "IDAT");
  for (size_t size = 1; size < file.size; size += size < image + 100 ? 1 : 613) {
    bytes part = {file.data, size};
    expect("truncated", &part, FG_ERR_DATA, "is cut off");
  }
  for (size_t missing = 1; missing <= 30; missing++) {
    bytes part = {file.data, file.size - missing};
    expect("truncated at the end", &part, FG_ERR_DATA, "is cut off");
  }
  bytes part = {file.data, image + 2500};
  expect("truncated in the image", &part, FG_ERR_DATA, "chunk IDAT");
  expect("truncated in the image", &part, FG_ERR_DATA, "of 200");
  expect("truncated in the image", &part, FG_ERR_DATA, "copy or scan it again");
  expect("whole", &file, FG_OK, NULL);
  free(file.data);
}

static void wrong_crc_is_fatal_in_every_chunk(void **state) {
  (void)state;
  static const char *const types[] = {"IHDR", "pHYs", "IDAT", "IEND", "tEXt",
                                      "gAMA", "eXIf", "foIl", "tIME"};
  bytes file = make_plain();
  insert_chunk(&file, find_chunk(&file, "IDAT"), "tEXt", "a\0b", 3);
  insert_chunk(&file, find_chunk(&file, "IDAT"), "gAMA", "\0\0\xb1\x8f", 4);
  insert_chunk(&file, find_chunk(&file, "IDAT"), "foIl", "unknown", 7);
  insert_chunk(&file, find_chunk(&file, "IEND"), "eXIf", "MM\0*", 4);
  insert_chunk(&file, find_chunk(&file, "IEND"), "tIME", "\x07\xe8\1\1\1\1\1", 7);
  expect("all CRCs right", &file, FG_OK, NULL);
  for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
    in_row("types[%zu]", i);
    size_t at = find_chunk(&file, types[i]);
    uint8_t *crc = file.data + at + 8 + get_32(file.data + at);
    for (int byte = 0; byte < 4; byte++) {
      crc[byte] ^= 0x10;
      expect(types[i], &file, FG_ERR_DATA, "checksum (CRC)");
      expect(types[i], &file, FG_ERR_DATA, types[i]);
      crc[byte] ^= 0x10;
    }
  }
  free(file.data);
}

/* A bit anywhere: no pixel may come out silently wrong. */
static void no_flipped_bit_passes(void **state) {
  (void)state;
  bytes file = make_plain();
  for (size_t at = 0; at < file.size; at += at < 200 ? 1 : 331) {
    file.data[at] ^= 0x04;
    fg_context ctx = {0};
    char *path = save_bytes(file.data, file.size);
    if (read_all(&ctx, path, NULL) != FG_ERR_DATA) fail_msg("byte %zu: %s", at, ctx.message);
    unlink(path);
    free(path);
    file.data[at] ^= 0x04;
  }
  free(file.data);
}

/* IHDR fields changed under a right CRC. */
static const struct {
  const char *label;
  int field;
  uint32_t value;
  const char *says;
} headers[] = {
    {"no width", 0, 0, "width is zero"},
    {"no height", 4, 0, "height is zero"},
    {"width beyond 31 bits", 0, 0xffffffff, "chunk IHDR"},
    {"height beyond 31 bits", 4, 0xffffffff, "chunk IHDR"},
    {"huge width", 0, 0x7fffffff, "pixels"},
    {"huge height", 4, 0x7fffffff, "pixels"},
    {"more than the file can hold", 4, 1000000, "cannot hold"},
    {"too wide", 0, 1500000, "wide"},
    {"fewer rows than said", 4, 201, "ends before its last row"},
    {"more rows than said", 4, 199, "more rows"},
    {"bit depth 3", 8, 3, "bit depth"},
    {"bit depth 99", 8, 99, "bit depth"},
    {"colour type 1", 9, 1, "color type"},
    {"compression 9", 10, 9, "compression"},
    {"filter 9", 11, 9, "filter"},
    {"interlace 9", 12, 9, "interlace"},
    {"palette type without palette", 9, 3, "palette is missing"},
};

static void contradictory_headers_are_refused(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++) {
    in_row("headers[%zu]", i);
    bytes file = make_plain();
    size_t at = find_chunk(&file, "IHDR");
    uint8_t *field = file.data + at + 8 + headers[i].field;
    if (headers[i].field < 8)
      put_32(field, headers[i].value);
    else
      *field = (uint8_t)headers[i].value;
    seal_chunk(&file, at);
    expect(headers[i].label, &file, FG_ERR_DATA, headers[i].says);
    free(file.data);
  }
}

static void wrong_image_checksum_is_fatal(void **state) {
  (void)state;
  picture p = plain;
  p.idat_bytes = 1 << 20;
  uint16_t *samples = make_samples(&p, 2);
  bytes file = write_png(&p, samples);
  size_t at = find_chunk(&file, "IDAT");
  file.data[at + 8 + get_32(file.data + at) - 1] ^= 1; /* Adler-32 stands last */
  seal_chunk(&file, at);
  expect("Adler-32", &file, FG_ERR_DATA, "checksum of the compressed image");
  free(file.data);
  free(samples);
}

static void missing_chunks_are_named(void **state) {
  (void)state;
  bytes file = make_plain();
  remove_chunk(&file, "IEND");
  expect("no IEND", &file, FG_ERR_DATA, "is cut off");
  free(file.data);
  file = make_plain();
  remove_chunk(&file, "IHDR");
  expect("no IHDR", &file, FG_ERR_DATA, "damaged");
  free(file.data);
  picture p = plain;
  p.height = 1;
  uint16_t *samples = make_samples(&p, 2);
  file = write_png(&p, samples);
  remove_chunk(&file, "IDAT");
  expect("no IDAT", &file, FG_ERR_DATA, "wrong place");
  free(file.data);
  file = make_plain();
  size_t phys = find_chunk(&file, "pHYs");
  memcpy(file.data + phys + 4, "PHYs", 4);
  seal_chunk(&file, phys);
  expect("unknown critical chunk", &file, FG_ERR_DATA, "PHYs");
  free(file.data);
  free(samples);
}

static void broken_resolution_asks_for_dpi(void **state) {
  (void)state;
  bytes file = make_plain();
  remove_chunk(&file, "pHYs");
  expect("no pHYs", &file, FG_ERR_DATA, "--dpi");
  insert_chunk(&file, find_chunk(&file, "IDAT"), "pHYs", "\0\2", 2);
  expect("short pHYs", &file, FG_ERR_DATA, "--dpi");
  free(file.data);
}

static void colour_beyond_the_palette_is_located(void **state) {
  (void)state;
  static const int depths[] = {2, 4, 8};
  for (size_t i = 0; i < 3; i++)
    for (int interlace = 0; interlace < 2; interlace++) {
      picture p = plain;
      p.colour_type = PNG_COLOR_TYPE_PALETTE;
      p.bit_depth = depths[i];
      p.palette_size = 3;
      p.interlace = interlace;
      uint16_t *samples = make_samples(&p, 2);
      samples[77 * p.width + 129] = 3;
      bytes file = write_png(&p, samples);
      expect("palette", &file, FG_ERR_DATA, "row 78, column 130");
      free(file.data);
      free(samples);
    }
}

static void oversized_scans_are_refused_by_the_cap(void **state) {
  (void)state;
  bytes file = make_plain();
  char *path = save_bytes(file.data, file.size);
  fg_context ctx = {0};
  assert_status(&ctx, read_all(&ctx, path, &(fg_scan_options){.pixel_cap = 301 * 200 - 1}),
                FG_ERR_DATA);
  assert_has(ctx.message, "301 x 200");
  assert_ok(&ctx, read_all(&ctx, path, &(fg_scan_options){.pixel_cap = 301 * 200}));
  unlink(path);
  free(path);
  free(file.data);
}

static void huge_interlaced_scans_are_refused(void **state) {
  (void)state;
  bytes file = make_plain();
  size_t at = find_chunk(&file, "IHDR");
  put_32(file.data + at + 8, 60000);
  put_32(file.data + at + 12, 60000);
  file.data[at + 8 + 12] = 1;
  seal_chunk(&file, at);
  file.data = realloc(file.data, 4 << 20); /* large enough for its declared size */
  memset(file.data + file.size, 0, (4 << 20) - file.size);
  file.size = 4 << 20;
  expect("interlaced", &file, FG_ERR_DATA, "without interlacing");
  free(file.data);
}

static void a_missing_file_is_an_io_error(void **state) {
  (void)state;
  fg_context ctx = {0};
  assert_status(&ctx, read_all(&ctx, "/nonexistent/scan.png", NULL), FG_ERR_IO);
  assert_has(ctx.message, "/nonexistent/scan.png");
  assert_has(ctx.message, "No such file");
  assert_status(&ctx, read_all(&ctx, "/", NULL), FG_ERR_IO);
  assert_has(ctx.message, "folder");
  assert_status(&ctx, read_all(&ctx, "/dev/null", NULL), FG_ERR_DATA);
  assert_has(ctx.message, "is empty");
  char *path = save_bytes("x", 1);
  chmod(path, 0);
  if (access(path, R_OK) != 0) {
    assert_status(&ctx, read_all(&ctx, path, NULL), FG_ERR_IO);
    assert_has(ctx.message, "ermission");
  }
  unlink(path);
  free(path);
}

static void harmless_chunks_are_passed_over(void **state) {
  (void)state;
  bytes file = make_plain();
  insert_chunk(&file, find_chunk(&file, "IDAT"), "iCCP", "broken profile", 14);
  insert_chunk(&file, find_chunk(&file, "IDAT"), "sRGB", "", 0);
  insert_chunk(&file, find_chunk(&file, "IEND"), "zTXt", "x\0\0no zlib", 10);
  expect("broken ancillary content", &file, FG_OK, NULL);
  file.data = realloc(file.data, file.size + 100);
  memset(file.data + file.size, 0, 100);
  file.size += 100;
  expect("bytes behind the end", &file, FG_OK, NULL);
  free(file.data);
}

/* libpng's warnings must not reach standard error. */
static void nothing_is_printed(void **state) {
  (void)state;
  char *log = save_bytes("", 0);
  int saved = dup(STDERR_FILENO), descriptor = open(log, O_WRONLY);
  dup2(descriptor, STDERR_FILENO);
  harmless_chunks_are_passed_over(NULL);
  contradictory_headers_are_refused(NULL);
  broken_resolution_asks_for_dpi(NULL);
  dup2(saved, STDERR_FILENO);
  close(saved);
  close(descriptor);
  struct stat entry;
  assert_int_equal(stat(log, &entry), 0);
  assert_int_equal(entry.st_size, 0);
  unlink(log);
  free(log);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(strangers_are_called_by_name),
      cmocka_unit_test(truncation_is_fatal_at_every_offset),
      cmocka_unit_test(wrong_crc_is_fatal_in_every_chunk),
      cmocka_unit_test(no_flipped_bit_passes),
      cmocka_unit_test(contradictory_headers_are_refused),
      cmocka_unit_test(wrong_image_checksum_is_fatal),
      cmocka_unit_test(missing_chunks_are_named),
      cmocka_unit_test(broken_resolution_asks_for_dpi),
      cmocka_unit_test(colour_beyond_the_palette_is_located),
      cmocka_unit_test(oversized_scans_are_refused_by_the_cap),
      cmocka_unit_test(huge_interlaced_scans_are_refused),
      cmocka_unit_test(a_missing_file_is_an_io_error),
      cmocka_unit_test(harmless_chunks_are_passed_over),
      cmocka_unit_test(nothing_is_printed),
  };
  return cmocka_run_group_tests_name("scan_bad", tests, NULL, NULL);
}

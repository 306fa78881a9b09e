/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that change while they are read: the SHA-256 is of what the rows came from. */
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <tiffio.h>

#include "core/sha256.h"
#include "foilgauge/measure.h"
#include "foilgauge/scan.h"
#include "support/test.h"

enum { WIDTH = 2000, HEIGHT = 1500, HEAD = 17, BYTES = HEAD + WIDTH * HEIGHT };

typedef struct place {
  char folder[40], file[64], other[64];
  uint8_t *bytes; /* of a PNM of noise */
} place;

static void write_file(const char *path, const uint8_t *bytes, size_t count) {
  FILE *out = fopen(path, "wb");
  assert_non_null(out);
  assert_int_equal(fwrite(bytes, 1, count, out), count);
  assert_int_equal(fclose(out), 0);
}

static int make_place(void **state) {
  place *p = calloc(1, sizeof *p);
  strcpy(p->folder, "/tmp/foilgauge-test-XXXXXX");
  if (!mkdtemp(p->folder)) return 1;
  snprintf(p->file, sizeof p->file, "%s/scan", p->folder);
  snprintf(p->other, sizeof p->other, "%s/other", p->folder);
  p->bytes = malloc(BYTES);
  snprintf((char *)p->bytes, HEAD + 1, "P5\n%d %d\n255\n", WIDTH, HEIGHT);
  uint32_t seed = 1;
  for (size_t i = HEAD; i < BYTES; i++)
    p->bytes[i] = (uint8_t)((seed = seed * 1664525 + 1013904223) >> 24);
  *state = p;
  return 0;
}

static int remove_place(void **state) {
  place *p = *state;
  unlink(p->file);
  unlink(p->other);
  rmdir(p->folder);
  free(p->bytes);
  free(p);
  return 0;
}

static void sum_of(const uint8_t *bytes, size_t count, char hex[65]) {
  struct sha256_ctx sum;
  sha256_init(&sum);
  sha256_update(&sum, count, bytes);
  fg_sha256_finish(&sum, hex);
}

static fg_scan *open_scan(const char *path) {
  fg_context ctx = {""};
  fg_scan *scan = NULL;
  if (fg_scan_open(&ctx, path, &(fg_scan_options){.dpi = 1200}, &scan) != FG_OK)
    fail_msg("%s", ctx.message);
  return scan;
}

static fg_status read_rows(fg_scan *scan, int64_t count) {
  uint8_t row[WIDTH];
  fg_status status = FG_OK;
  for (int64_t y = 0; y < count && status == FG_OK; y++)
    status = fg_scan_read_rows(NULL, scan, 1, row, WIDTH);
  return status;
}

static void overwrite(const char *path, off_t from, size_t count) {
  uint8_t *zeros = calloc(count, 1);
  int file = open(path, O_WRONLY);
  assert_true(file >= 0);
  assert_int_equal(pwrite(file, zeros, count, from), count);
  close(file);
  free(zeros);
}

static void sum_is_of_the_rows_that_were_read(void **state) {
  place *p = *state;
  char hex[65], wanted[65];
  write_file(p->file, p->bytes, BYTES);
  fg_scan *scan = open_scan(p->file);
  assert_ok(NULL, read_rows(scan, HEIGHT / 2));
  overwrite(p->file, HEAD, BYTES / 4);
  assert_ok(NULL, read_rows(scan, HEIGHT / 2));
  assert_ok(&test_context, fg_scan_sha256(&test_context, scan, hex));
  sum_of(p->bytes, BYTES, wanted);
  assert_string_equal(hex, wanted);
  fg_scan_close(scan);
}

static void another_file_of_the_name_does_not_matter(void **state) {
  place *p = *state;
  char hex[65], wanted[65];
  write_file(p->file, p->bytes, BYTES);
  fg_scan *scan = open_scan(p->file);
  assert_ok(NULL, read_rows(scan, 10));
  write_file(p->other, (const uint8_t *)"other", 5);
  assert_int_equal(rename(p->other, p->file), 0);
  assert_ok(NULL, read_rows(scan, HEIGHT - 10));
  assert_ok(&test_context, fg_scan_sha256(&test_context, scan, hex));
  sum_of(p->bytes, BYTES, wanted);
  assert_string_equal(hex, wanted);
  fg_scan_close(scan);
}

static void completed_file_has_not_the_sum_of_the_cut_off_one(void **state) {
  place *p = *state;
  char hex[65], wanted[65];
  size_t cut = BYTES - WIDTH / 2;
  write_file(p->file, p->bytes, BYTES);
  fg_scan *scan = open_scan(p->file);
  assert_int_equal(truncate(p->file, (off_t)cut), 0);
  assert_status(NULL, read_rows(scan, HEIGHT), FG_ERR_DATA);
  write_file(p->file, p->bytes, BYTES);
  assert_ok(&test_context, fg_scan_sha256(&test_context, scan, hex));
  sum_of(p->bytes, cut, wanted);
  assert_string_equal(hex, wanted);
  fg_scan_close(scan);
}

/* Bytes that were not read for their rows are part of the sum, too. */
static void sum_of_a_scan_that_failed_is_of_the_whole_file(void **state) {
  place *p = *state;
  char wanted[65];
  fg_design design;
  fg_measurement m;
  const fg_measure_options options = {.dpi = 1200, .only_file = true, .sum_failed = true};
  fg_design_default(&design);
  memset(p->bytes, 'x', 2);
  write_file(p->file, p->bytes, BYTES);
  assert_status(NULL, fg_measure_scan(NULL, p->file, &design, &options, &m), FG_ERR_DATA);
  sum_of(p->bytes, BYTES, wanted);
  assert_string_equal(m.sha256, wanted);
  assert_status(NULL, fg_measure_scan(NULL, p->folder, &design, &options, &m), FG_ERR_IO);
  assert_string_equal(m.sha256, "");
}

static void only_files_are_waited_for(void **state) {
  place *p = *state;
  fg_scan *scan;
  const fg_scan_options options = {.only_file = true};
  const char *const names[] = {p->file, "/dev/zero"};
  assert_int_equal(mkfifo(p->file, 0600), 0);
  for (int i = 0; i < 2; i++) {
    fg_context ctx = {""};
    char hex[65];
    assert_status(&ctx, fg_scan_open(&ctx, names[i], &options, &scan), FG_ERR_IO);
    assert_has(ctx.message, "a pipe or a device");
    assert_status(NULL, fg_sha256_file(NULL, names[i], hex), FG_ERR_IO);
  }
}

static void write_tiff(const place *p, uint16_t compression) {
  TIFF *tiff = TIFFOpen(p->file, "w");
  assert_non_null(tiff);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, WIDTH);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, HEIGHT);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 16);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression);
  for (uint32_t y = 0; y < HEIGHT; y++)
    assert_int_equal(TIFFWriteScanline(tiff, p->bytes + HEAD + y * WIDTH, y, 0), 1);
  TIFFClose(tiff);
}

typedef struct summing {
  fg_scan *scan;
  char hex[65];
  fg_status status;
} summing;

static void *sum_scan(void *argument) {
  summing *job = argument;
  job->status = fg_scan_sha256(NULL, job->scan, job->hex);
  return NULL;
}

static void tiff_is_summed_beside_its_reading(void **state) {
  place *p = *state;
  const uint16_t compressions[] = {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE};
  for (int i = 0; i < 3; i++) {
    char wanted[65];
    write_tiff(p, compressions[i]);
    summing job = {.scan = open_scan(p->file)};
    pthread_t thread;
    assert_true(fg_scan_sums_apart(job.scan));
    assert_int_equal(pthread_create(&thread, NULL, sum_scan, &job), 0);
    assert_ok(NULL, read_rows(job.scan, HEIGHT));
    pthread_join(thread, NULL);
    assert_ok(NULL, job.status);
    assert_ok(&test_context, fg_scan_check_unchanged(&test_context, job.scan));
    assert_ok(&test_context, fg_sha256_file(&test_context, p->file, wanted));
    assert_string_equal(job.hex, wanted);
    fg_scan_close(job.scan);
  }
}

/* A byte that was read and one that was summed differ, whichever came first. */
static void tiff_that_changed_is_refused(void **state) {
  place *p = *state;
  for (int summed_first = 0; summed_first < 2; summed_first++) {
    fg_context ctx = {""};
    char hex[65];
    write_tiff(p, COMPRESSION_NONE);
    fg_scan *scan = open_scan(p->file);
    if (summed_first)
      assert_ok(&test_context, fg_scan_sha256(&test_context, scan, hex));
    else
      assert_ok(NULL, read_rows(scan, HEIGHT / 2));
    overwrite(p->file, WIDTH * HEIGHT / 4, 1);
    overwrite(p->file, WIDTH * HEIGHT / 4 + 1, 1);
    if (summed_first)
      assert_ok(NULL, read_rows(scan, HEIGHT / 2));
    else
      assert_status(NULL, fg_scan_sha256(NULL, scan, hex), FG_ERR_IO);
    assert_status(&ctx, fg_scan_check_unchanged(&ctx, scan), FG_ERR_IO);
    assert_has(ctx.message, "changed while it was read");
    fg_scan_close(scan);
  }
}

#define WITH_PLACE(test) cmocka_unit_test_setup_teardown(test, make_place, remove_place)

int main(void) {
  const struct CMUnitTest tests[] = {
      WITH_PLACE(sum_is_of_the_rows_that_were_read),
      WITH_PLACE(another_file_of_the_name_does_not_matter),
      WITH_PLACE(completed_file_has_not_the_sum_of_the_cut_off_one),
      WITH_PLACE(sum_of_a_scan_that_failed_is_of_the_whole_file),
      WITH_PLACE(only_files_are_waited_for),
      WITH_PLACE(tiff_is_summed_beside_its_reading),
      WITH_PLACE(tiff_that_changed_is_refused),
  };
  return cmocka_run_group_tests_name("changed scans", tests, NULL, NULL);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "fuzz.h"

const char *fuzz_file(const uint8_t *data, size_t size) {
  static int descriptor = -1;
  static char path[64];
  if (descriptor < 0) {
    descriptor = memfd_create("fuzz", MFD_CLOEXEC);
    snprintf(path, sizeof path, "/proc/self/fd/%d", descriptor);
  }
  if (ftruncate(descriptor, 0) != 0 || pwrite(descriptor, data, size, 0) != (ssize_t)size) abort();
  return path;
}

void fuzz_read_scan(const char *path, const fg_scan_options *options) {
  fg_context ctx = {0};
  fg_scan *scan = NULL;
  if (fg_scan_open(&ctx, path, options, &scan) != FG_OK) return;
  const fg_scan_info *info = fg_scan_get_info(scan);
  int64_t stride = info->width_px * info->bytes_per_pixel;
  void *row = malloc((size_t)stride);
  for (int64_t y = 0; row && y < info->height_px; y++)
    if (fg_scan_read_rows(&ctx, scan, 1, row, stride) != FG_OK) break;
  free(row);
  fg_scan_close(scan);
}

static bool holds_word(const char *text, const char *word) {
  size_t length = strlen(word);
  for (const char *at = strcasestr(text, word); at; at = strcasestr(at + 1, word))
    if ((at == text || !isalpha((unsigned char)at[-1])) && !isalpha((unsigned char)at[length]))
      return true;
  return false;
}

FILE *fuzz_report_open(fuzz_report *report) {
  *report = (fuzz_report){0};
  report->out = open_memstream(&report->text, &report->size);
  return report->out;
}

void fuzz_report_close(fuzz_report *report, bool numbers) {
  fclose(report->out);
  if (numbers && (holds_word(report->text, "nan") || holds_word(report->text, "inf"))) {
    fputs(report->text, stderr);
    abort();
  }
  free(report->text);
}

uint8_t fuzz_take(fuzz_bytes *bytes) {
  return bytes->at < bytes->end ? *bytes->at++ : 0;
}

size_t fuzz_take_below(fuzz_bytes *bytes, size_t limit) {
  size_t high = fuzz_take(bytes);
  return (high << 8 | fuzz_take(bytes)) % limit;
}

double fuzz_take_number(fuzz_bytes *bytes, double value) {
  static const double odd[] = {0,   1e18, -1e18, 1e-308, -1e308, 1e200,        -1e-5, 1e-12,
                               1e9, -1e4, 1,     -1,     1e300,  4294967296.0, 1e5,   -1e-300};
  uint8_t kind = fuzz_take(bytes);
  if (kind < sizeof odd / sizeof *odd) return odd[kind];
  return kind < 128 ? value * ((double)fuzz_take(bytes) / 64 - 1)
                    : value + ((double)fuzz_take(bytes) - 128) / 1000;
}

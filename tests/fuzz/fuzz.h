/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared parts of the fuzz targets. Each is a libFuzzer entry; driver.c runs one over files
 * instead. */
#ifndef FG_TESTS_FUZZ_H
#define FG_TESTS_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "foilgauge/scan.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The bytes as a file in memory; the path stays good until the next call. */
const char *fuzz_file(const uint8_t *data, size_t size);

/* Opens the file and reads it to its end, or to its error. */
void fuzz_read_scan(const char *path, const fg_scan_options *options);

/* A report in memory. NULL where there is no memory for it. */
typedef struct fuzz_report {
  char *text;
  size_t size;
  FILE *out;
} fuzz_report;

FILE *fuzz_report_open(fuzz_report *report);

/* Closes and frees it. With `numbers`, a word `nan` or `inf` in it aborts: a number that is none.
 */
void fuzz_report_close(fuzz_report *report, bool numbers);

/* Bytes of an input, taken one after the other; zeros after its end. */
typedef struct fuzz_bytes {
  const uint8_t *at, *end;
} fuzz_bytes;

uint8_t fuzz_take(fuzz_bytes *bytes);
size_t fuzz_take_below(fuzz_bytes *bytes, size_t limit); /* 0 <= result < limit, from two bytes */

/* A number as instruments never write it (0, 1e18, 1e-308, -1e308 ...), or a mild factor of
 * `value`. */
double fuzz_take_number(fuzz_bytes *bytes, double value);

#endif

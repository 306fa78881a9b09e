/* What the fuzz targets share. Each is a libFuzzer entry; driver.c runs one over files instead. */
#ifndef FG_TESTS_FUZZ_H
#define FG_TESTS_FUZZ_H

#include <stddef.h>
#include <stdint.h>

#include "foilgauge/scan.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The bytes as a file in memory; the path stays good until the next call. */
const char *fuzz_file(const uint8_t *data, size_t size);

/* Opens the file and reads it to its end, or to its error. */
void fuzz_read_scan(const char *path, const fg_scan_options *options);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* TIFF, JPEG, and PNM by the way: any bytes that the table of formats takes. */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  fuzz_read_scan(fuzz_file(data, size), &(fg_scan_options){.dpi = size % 2 ? 600 : 0,
                                                           .pixel_cap = 1 << 18,
                                                           .memory_cap = 64 << 20,
                                                           .allow_lossy = true});
  return 0;
}

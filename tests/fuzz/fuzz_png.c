/* SPDX-License-Identifier: GPL-3.0-or-later */
/* PNG: chunk checksums are put right first, or nearly every input would end at the first of them.
 */
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "fuzz.h"

static uint32_t read_32(const uint8_t *p) {
  return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static void repair(uint8_t *data, size_t size) {
  for (size_t at = 8; at + 12 <= size;) {
    size_t length = read_32(data + at);
    if (length > size - at - 12) return;
    uint32_t crc = (uint32_t)crc32(0, data + at + 4, (uInt)length + 4);
    for (int i = 0; i < 4; i++)
      data[at + 8 + length + (size_t)i] = (uint8_t)(crc >> (24 - 8 * i));
    at += length + 12;
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  uint8_t *copy = malloc(size + 8);
  if (!copy) return 0;
  memcpy(copy, data, size);
  if (size >= 8) memcpy(copy, signature, 8);
  repair(copy, size);
  fuzz_read_scan(fuzz_file(copy, size),
                 &(fg_scan_options){.dpi = size % 2 ? 600 : 0, .pixel_cap = 1 << 18});
  free(copy);
  return 0;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* EXIF 2.32, 4.6: "Exif", two zeros, then a TIFF whose first directory is that of the image. An
 * entry is tag, type, count (2, 2, 4 bytes) and 4 bytes of value, or its offset. */
#include "scan/exif.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { TAG_ORIENTATION = 0x0112, TAG_X = 0x011a, TAG_Y = 0x011b, TAG_UNIT = 0x0128 };
enum { TYPE_SHORT = 3, TYPE_RATIONAL = 5, UNIT_INCH = 2, UNIT_CENTIMETRE = 3 };
enum { ENTRY_BYTES = 12, IDENTIFIER_BYTES = 6 };

typedef struct tiff_bytes {
  const uint8_t *data;
  size_t length;
  bool big_endian;
} tiff_bytes;

static bool exif_number(const tiff_bytes *t, size_t at, size_t width, uint32_t *number) {
  if (at > t->length || width > t->length - at) return false;
  *number = 0;
  for (size_t i = 0; i < width; i++)
    *number = *number << 8 | t->data[at + (t->big_endian ? i : width - 1 - i)];
  return true;
}

static double rational_at(const tiff_bytes *t, size_t entry) {
  uint32_t place, above, below;
  if (!exif_number(t, entry + 8, 4, &place) || !exif_number(t, place, 4, &above) ||
      !exif_number(t, (size_t)place + 4, 4, &below) || below == 0)
    return NAN;
  return (double)above / below;
}

/* Reads the directory at `at`; resolutions still per its unit. */
static void read_directory(const tiff_bytes *t, size_t at, fg_exif *exif, uint32_t *unit) {
  uint32_t entries = 0, tag, type, value;
  if (!exif_number(t, at, 2, &entries)) return;
  for (size_t i = 0; i < entries; i++) {
    size_t entry = at + 2 + i * ENTRY_BYTES;
    if (!exif_number(t, entry, 2, &tag) || !exif_number(t, entry + 2, 2, &type)) return;
    if (type == TYPE_RATIONAL && (tag == TAG_X || tag == TAG_Y))
      exif->dpi[tag - TAG_X] = rational_at(t, entry);
    if (type != TYPE_SHORT || !exif_number(t, entry + 8, 2, &value)) continue;
    if (tag == TAG_UNIT) *unit = value;
    if (tag == TAG_ORIENTATION) exif->orientation = (int)value;
  }
}

void fg_exif_read(const uint8_t *bytes, size_t length, fg_exif *exif) {
  uint32_t first = 0, unit = UNIT_INCH;
  *exif = (fg_exif){.dpi = {NAN, NAN}};
  if (length < IDENTIFIER_BYTES + 8 || memcmp(bytes, "Exif\0\0", IDENTIFIER_BYTES) != 0) return;
  tiff_bytes t = {.data = bytes + IDENTIFIER_BYTES, .length = length - IDENTIFIER_BYTES};
  t.big_endian = t.data[0] == 'M';
  if (!exif_number(&t, 4, 4, &first)) return;
  read_directory(&t, first, exif, &unit);
  for (int axis = 0; axis < 2; axis++)
    exif->dpi[axis] = unit == UNIT_INCH         ? exif->dpi[axis]
                      : unit == UNIT_CENTIMETRE ? exif->dpi[axis] * 2.54
                                                : NAN;
}

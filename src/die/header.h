/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Facts in the lines before a profile's data: units, columns, half, tip. */
#ifndef FG_DIE_HEADER_H
#define FG_DIE_HEADER_H

#include "die/lines.h"
#include "foilgauge/die.h"

typedef struct fg_die_header {
  fg_die_unit unit[2]; /* of x, z */
  bool other_unit;     /* an unsupported unit, as inch */
  size_t column[2];    /* from 1; 0: not named */
  const char *half;    /* a word of fg_die_half_word, or NULL */
  double tip_um;       /* NaN: not stated */
  size_t points;       /* number of points stated; 0: not stated */
} fg_die_header;

/* Reads the text from `text` to `data`, whose columns are separated by `separator`. */
void fg_die_header_read(const char *text, const char *data, char separator, size_t columns,
                        fg_die_header *header);

/* Returns "concave" or "convex" where the text has one of the two, in English or German, and not
 * the other; else NULL. */
const char *fg_die_half_in(const char *text, size_t length);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the lines before a profile's data say: units, columns, half, tip. */
#ifndef FG_DIE_HEADER_H
#define FG_DIE_HEADER_H

#include "die/lines.h"
#include "foilgauge/die.h"

typedef struct fg_die_header {
  fg_die_unit unit[2]; /* of x, z */
  bool other_unit;     /* a unit that is none of those read: inch */
  size_t column[2];    /* from 1; 0: not named */
  const char *half;    /* a word of fg_die_half_word, or NULL */
  double tip_um;       /* NaN: not said */
  size_t points;       /* how many the file says it has; 0: not said */
} fg_die_header;

/* Reads the text from `text` to `data`, whose columns are separated by `separator`. */
void fg_die_header_read(const char *text, const char *data, char separator, size_t columns,
                        fg_die_header *header);

/* "concave" or "convex" where the text holds one of the two and not the other, in English or
 * German; else NULL. */
const char *fg_die_half_in(const char *text, size_t length);

#endif

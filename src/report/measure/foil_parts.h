/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of a foil that pages list, plot and judge one by one: bumps, or beams. */
#ifndef FG_REPORT_MEASURE_FOIL_PARTS_H
#define FG_REPORT_MEASURE_FOIL_PARTS_H

#include "foilgauge/words.h"

typedef struct fg_foil_parts {
  fg_quantity_owner owner;
  const char *name;   /* "bump" */
  const char *plural; /* "bumps" */
  const fg_foil *foil;
  size_t count;
  size_t stated; /* by the design; 0: not */
} fg_foil_parts;

fg_foil_parts fg_foil_parts_of(const fg_design *design, const fg_foil *foil);
const void *fg_foil_part_at(const fg_foil_parts *parts, size_t i);
int fg_foil_part_number(const fg_foil_parts *parts, size_t i);
int fg_foil_parts_last(
    const fg_foil_parts *parts); /* the highest number, at least the stated count and 1 */
bool fg_foil_parts_have(const fg_foil_parts *parts, int number);

/* Returns the reason why a part has no value, for people. */
const char *fg_foil_part_lack(const fg_foil_parts *parts, size_t i);

/* Returns the name of the part that a row of the quantities belongs to: "bump", "beam" or "". */
const char *fg_foil_part_word(const fg_quantity *row);

#endif

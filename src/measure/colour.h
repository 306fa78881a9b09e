/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The channels of a colour scan against each other, around measured edges. */
#ifndef FG_MEASURE_COLOUR_H
#define FG_MEASURE_COLOUR_H

#include "foilgauge/foil.h"
#include "foilgauge/scan.h"

/* Reads a colour scan once more, and fills m->colour_lines. Of a gray scan, and of one whose
 * channels cannot be read apart, nothing is read and m->colour_lines stays all zero. `memory_cap`:
 * limit of the rows, bytes. */
fg_status fg_colour_measure(fg_context *ctx, fg_scan *scan, size_t memory_cap, unsigned threads,
                            fg_measurement *m);

#endif

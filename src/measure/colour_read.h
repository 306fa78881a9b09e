/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One more reading of a colour scan: the pixels around known edges. Memory is as many rows as the
 * tallest cross-section needs. */
#ifndef FG_MEASURE_COLOUR_READ_H
#define FG_MEASURE_COLOUR_READ_H

#include "core/memory.h"
#include "foilgauge/scan.h"
#include "measure/colour_stations.h"

/* Fills the place of every cross-section in each channel. `same` is true when two channels hold the
 * same pixels at all of them: red and green, green and blue, blue and red. */
fg_status fg_colour_read(fg_context *ctx, fg_scan *scan, fg_budget *budget, unsigned threads,
                         fg_colour_stations *stations, bool same[3]);

#endif

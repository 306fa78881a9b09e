/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Place of a foil in the scan, and the order of places. */
#ifndef FG_MEASURE_PLACE_H
#define FG_MEASURE_PLACE_H

#include "foilgauge/foil.h"
#include "vision/trace.h"

/* Sets the box of a foil that has a trace and nothing more. */
void fg_place_from_trace(const fg_trace *trace, fg_foil *foil);

/* Moves all positions of a foil from a view of the scan into the scan, and fills its place_mm. */
void fg_place_move(const int64_t origin_px[2], const double dpi[2], fg_foil *foil);

/* Puts the foils into reading order: rows of foils from top to bottom, each from left to right. */
void fg_place_sort_foils(fg_measurement *m);

#endif

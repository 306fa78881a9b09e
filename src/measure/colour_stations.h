/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cross-sections of a measurement, in pixels, at which the channels of its scan are compared: of
 * foils across the whole strip, of discs across their edge. */
#ifndef FG_MEASURE_COLOUR_STATIONS_H
#define FG_MEASURE_COLOUR_STATIONS_H

#include "foilgauge/foil.h"
#include "measure/colour_profile.h"

typedef struct fg_colour_station {
  double x, y, nx, ny; /* middle of the strip, or the edge; unit normal */
  double bend;         /* 1/px: the strip runs past it along the parabola n = bend t² / 2 */
  double half_along_px, half_across_px;
  fg_colour_known known;
  int64_t top, bottom; /* rows of its pixels */
  int part;            /* foil, or disc behind the foils; neighbours in the list are neighbours */
  bool outlier;        /* a disc's */
  fg_colour_place place[3];
} fg_colour_station;

typedef struct fg_colour_stations {
  fg_colour_station *list; /* along the parts; owned */
  size_t *order;           /* by bottom row; owned */
  size_t count, capacity;
  int64_t rows_max; /* max height of one of them */
} fg_colour_stations;

/* `m` holds the edges as found: at the resolution of the scan, not calibrated. */
fg_status fg_colour_stations_choose(fg_context *ctx, const fg_measurement *m,
                                    fg_colour_stations *stations);
void fg_colour_stations_free(fg_colour_stations *stations);

#endif

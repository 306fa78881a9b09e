/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of the scanner with a plate or ring of known diameters, from time to time. */
#ifndef FG_STATION_CHECK_H
#define FG_STATION_CHECK_H

#include "station/keep.h"
#include "station/state.h"

/* Measures a scan of the check and keeps its card, scale and shear. */
fg_status fg_station_measure_check(fg_context *ctx, fg_inspection *station, const char *path,
                                   const fg_station_file *file, char *words, size_t size);

/* The due time of the next check, and the result of the last. */
typedef struct fg_station_health {
  bool asked;      /* the recipe asks for checks */
  int64_t last_at; /* 0: never */
  int64_t due_at;  /* 0: no time is set */
  bool due, failed;
  bool changed;    /* tone, sharpening or blur are not those of the baseline */
  bool clock_back; /* the clock shows a time before the last check, whose age is unknown */
} fg_station_health;
fg_status fg_station_check_health(fg_context *ctx, sqlite3 *connection,
                                  const fg_station_check *check, fg_station_health *health);

/* True when scans get no verdict because of the check; the reason goes into the words. */
bool fg_station_check_withholds(fg_inspection *station, const fg_design *design, char *why,
                                size_t size);

#endif

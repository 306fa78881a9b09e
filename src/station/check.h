/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scanner's own health: a plate or ring of known diameters, now and then. */
#ifndef FG_STATION_CHECK_H
#define FG_STATION_CHECK_H

#include "station/keep.h"
#include "station/state.h"

/* Measures a scan of the check and keeps its card and what it says of scale and shear. */
fg_status fg_station_take_check(fg_context *ctx, fg_inspection *station, const char *path,
                                const fg_station_file *file, char *words, size_t size);

/* When the next one is due, and what the last came to. */
typedef struct fg_station_health {
  bool asked;      /* the recipe asks for checks */
  int64_t last_at; /* 0: never */
  int64_t due_at;  /* 0: no time is set */
  bool due, failed;
  bool changed;    /* tone, sharpening or blur are not those of the baseline */
  bool clock_back; /* the clock stands before the last check: nobody knows how old that is */
} fg_station_health;
fg_status fg_station_check_health(fg_context *ctx, sqlite3 *connection,
                                  const fg_station_check *check, fg_station_health *health);

/* Whether scans get no verdict for it now, and why. */
bool fg_station_check_withholds(fg_inspection *station, char *why, size_t size);

#endif

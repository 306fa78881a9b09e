/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CSV files beside the database, which say more about foils: a column `serial` or `time` tells
 * which foil a row belongs to, every other column is a candidate for a cause. */
#ifndef FG_STATION_CONTEXT_H
#define FG_STATION_CONTEXT_H

#include "foilgauge/station.h"
#include "foilgauge/table.h"

/* One file. By serial a foil has the values of its row; by time those of the rows around it:
 * numbers are interpolated, words are those of the last row before. */
typedef struct fg_station_context {
  fg_table table;
  fg_table serials; /* by serial: the same cells as they are written */
  bool by_time;
  size_t key;    /* its column */
  size_t *order; /* rows, sorted by key */
  double *days;  /* rows: since 1970, local time as written; by time alone */
} fg_station_context;

typedef struct fg_station_contexts {
  fg_station_context one[FG_STATION_CONTEXTS];
  size_t count;
} fg_station_contexts;

/* Loads the request's files. FG_ERR_DATA: no column `serial` or `time`, or a time that cannot be
 * read. */
fg_status fg_station_contexts_load(fg_context *ctx, const fg_station_request *request,
                                   fg_station_contexts *contexts);
void fg_station_contexts_free(fg_station_contexts *contexts);

/* A foil's value in a column of a file: a word, or a number. Neither: the file does not know it. */
typedef struct fg_context_value {
  const char *word; /* NULL: none */
  double number;    /* NaN: none */
} fg_context_value;
fg_context_value fg_station_context_value(const fg_station_context *context, size_t column,
                                          const char *serial, double days);

#endif

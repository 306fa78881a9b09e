/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foils of the database as a search for causes sees them: one value of each, and its columns. */
#ifndef FG_STATION_CAUSE_DATA_H
#define FG_STATION_CAUSE_DATA_H

#include "station/context.h"
#include "station/trend_choice.h"

enum { FG_CAUSE_COLUMNS = 32, FG_CAUSE_NAME = 64 };

/* Names of the columns that the station makes itself. */
#define FG_CAUSE_TIME "time"
#define FG_CAUSE_HOUR "hour"
#define FG_CAUSE_LOT  "lot"

typedef struct fg_cause_column {
  char name[FG_CAUSE_NAME];
  bool words;    /* levels, else numbers */
  size_t *level; /* foils, of words */
  char **level_name;
  size_t levels;
  double *number;   /* foils, of numbers */
  bool within_days; /* it varies within days */
} fg_cause_column;

typedef struct fg_cause_data {
  size_t foils;
  int64_t *foil, *at; /* in the order of measuring */
  double *value;      /* mean over a foil's bumps, one bump, or the whole foil */
  char **serial;
  size_t *day; /* number of the local day, from 0 */
  size_t days;
  size_t *lot; /* index of the lot; foils without one share a level */
  size_t lots;
  fg_cause_column column[FG_CAUSE_COLUMNS];
  size_t columns;
  char left_out[600]; /* columns that no search can use, in words; "": none */
} fg_cause_data;

/* Reads the foils of a choice (its quantity, bump, lot and die) with their columns. */
fg_status fg_cause_data_read(fg_context *ctx, sqlite3 *reader, const fg_station_contexts *contexts,
                             const fg_trend_choice *choice, fg_cause_data *data);
/* Reads the columns of these foils alone, without values; `foil` is sorted. */
fg_status fg_cause_data_of_foils(fg_context *ctx, sqlite3 *reader,
                                 const fg_station_contexts *contexts, const int64_t *foil,
                                 size_t count, fg_cause_data *data);
void fg_cause_data_free(fg_cause_data *data);

/* Returns NULL when there is none. */
const fg_cause_column *fg_cause_column_find(const fg_cause_data *data, const char *name);

/* Days since 1970 by the local clock, with their fraction. */
double fg_cause_days(int64_t at);

#endif

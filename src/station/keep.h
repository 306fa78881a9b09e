/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writing into the database: scans with all their measurements, cards of files, setups. */
#ifndef FG_STATION_KEEP_H
#define FG_STATION_KEEP_H

#include "foilgauge/station.h"
#include "station/database.h"
#include "station/naming.h"

/* A file of the folder, in its state when it was inspected. */
typedef struct fg_station_file {
  const char *name; /* below the folder, as stored (stored_name.h) */
  int64_t bytes, modified_ns;
} fg_station_file;

/* Kind of a card: the finding on a file. */
typedef enum fg_card {
  FG_CARD_MEASURED,
  FG_CARD_KNOWN,      /* the same scan of the same foil was measured before */
  FG_CARD_UNFINISHED, /* not whole: half-written, or cut off */
  FG_CARD_FOREIGN,    /* no scan */
  FG_CARD_UNREADABLE, /* a scan that could not be read or measured */
  FG_CARD_CHECK,      /* of the scanner */
  FG_CARD_DUPLICATE,  /* a copy of another foil's scan, byte for byte: it is no measurement of this
                         one */
} fg_card;
const char *fg_card_word(fg_card card);

/* Keeps the setup of all scans from now on; a setup equal to an earlier one is the same row. */
fg_status fg_station_keep_setup(fg_context *ctx, fg_station_database *database,
                                const fg_lot_settings *settings, int64_t *setup);

/* Returns true when the file was inspected in its present state and found whole. */
fg_status fg_station_file_is_done(fg_context *ctx, fg_station_database *database,
                                  const fg_station_file *file, bool *done);

/* fg_station_file_is_done for many files: the query is prepared once. The database must not be
 * reopened meanwhile. */
typedef struct fg_done_files {
  fg_station_database *database;
  fg_query query;
} fg_done_files;
void fg_done_files_begin(fg_station_database *database, fg_done_files *files);
bool fg_done_files_have(fg_done_files *files, const fg_station_file *file);
fg_status fg_done_files_end(fg_context *ctx, fg_done_files *files); /* status of all calls */

/* Returns true when the file's newest card is the same already. */
fg_status fg_station_card_stands(fg_context *ctx, fg_station_database *database,
                                 const fg_station_file *file, fg_card card, const char *message,
                                 bool *stands);

/* Finds the scan with that sum: its number, 0 when there is none. */
fg_status fg_station_find_scan(fg_context *ctx, fg_station_database *database, const char *sha256,
                               int64_t *scan);

/* Keeps a card alone; `scan` 0: none. */
fg_status fg_station_keep_card(fg_context *ctx, fg_station_database *database,
                               const fg_station_file *file, fg_card card, const char *message,
                               int64_t scan);

typedef struct fg_station_scan {
  fg_station_file file;
  const char *source; /* "folder" or "scanner" */
  const fg_named *named;
  int64_t order; /* 0: none */
  const fg_lot_settings *settings;
  int64_t setup;
  const fg_measurement *measurement;
  double seconds;       /* from the file's arrival */
  const char *withheld; /* reason why there is no verdict; NULL: there is one */
  const char *note;     /* note on its card beside the verdict, or "" */
} fg_station_scan;

/* Keeps all of a measured scan with its card, or nothing. `scan` is its number. */
fg_status fg_station_keep_scan(fg_context *ctx, fg_station_database *database,
                               const fg_station_scan *kept, int64_t *scan,
                               fg_report_outcome *outcome);

#define FG_EVENT_MEASURED  "measured"
#define FG_EVENT_CORRECTED "corrected"
#define FG_EVENT_DISPOSED  "disposed"

/* Keeps that something befell a foil, with its names of now, inside the transaction of that:
 * receivers get one event after the other (station/outbox/outbox.h). */
fg_status fg_event_keep(fg_context *ctx, sqlite3 *writer, int64_t foil, const char *kind);

/* The row of a card, inside a transaction of its caller. */
fg_status fg_station_insert_card(fg_context *ctx, fg_station_database *database,
                                 const fg_station_file *file, fg_card card, const char *message,
                                 int64_t scan);

#endif

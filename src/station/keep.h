/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What goes into the database: scans with all that was measured, cards of files, setups. */
#ifndef FG_STATION_KEEP_H
#define FG_STATION_KEEP_H

#include "foilgauge/station.h"
#include "station/database.h"
#include "station/naming.h"

/* A file of the folder as it was when it was looked at. */
typedef struct fg_station_file {
  const char *name; /* below the folder, as stored (stored_name.h) */
  int64_t bytes, modified_ns;
} fg_station_file;

/* What a card says of a file. */
typedef enum fg_card {
  FG_CARD_MEASURED,
  FG_CARD_KNOWN,      /* the same scan of the same foil was measured before */
  FG_CARD_UNFINISHED, /* not whole: half-written, or cut off */
  FG_CARD_FOREIGN,    /* no scan */
  FG_CARD_UNREADABLE, /* a scan that could not be read or measured */
  FG_CARD_CHECK,      /* of the scanner */
  FG_CARD_DUPLICATE,  /* the scan of another foil once more, byte for byte: it says nothing of this
                       */
} fg_card;
const char *fg_card_word(fg_card card);

/* With what scans are measured from now on; the same setup as before is the same row. */
fg_status fg_station_keep_setup(fg_context *ctx, fg_station_database *database,
                                const fg_lot_settings *settings, int64_t *setup);

/* Whether the file was looked at as it is now, and found whole. */
fg_status fg_station_file_is_done(fg_context *ctx, fg_station_database *database,
                                  const fg_station_file *file, bool *done);

/* Many files, as fg_station_file_is_done of each: the query is prepared once. The database is not
 * opened again meanwhile. */
typedef struct fg_done_files {
  fg_station_database *database;
  fg_query query;
} fg_done_files;
void fg_done_files_begin(fg_station_database *database, fg_done_files *files);
bool fg_done_files_have(fg_done_files *files, const fg_station_file *file);
fg_status fg_done_files_end(fg_context *ctx, fg_done_files *files); /* of all of it */

/* Whether that is what the file's newest card says of it already. */
fg_status fg_station_card_stands(fg_context *ctx, fg_station_database *database,
                                 const fg_station_file *file, fg_card card, const char *message,
                                 bool *stands);

/* The scan with that sum: its number, 0 when there is none. */
fg_status fg_station_find_scan(fg_context *ctx, fg_station_database *database, const char *sha256,
                               int64_t *scan);

/* A card alone; `scan` 0: none. */
fg_status fg_station_keep_card(fg_context *ctx, fg_station_database *database,
                               const fg_station_file *file, fg_card card, const char *message,
                               int64_t scan);

typedef struct fg_station_scan {
  fg_station_file file;
  const char *source; /* "folder" or "scanner" */
  const fg_named *named;
  const fg_lot_settings *settings;
  int64_t setup;
  const fg_measurement *measurement;
  double seconds;       /* from the file's arrival */
  const char *withheld; /* why there is no verdict; NULL: there is one */
  const char *note;     /* what its card says beside the verdict, or "" */
} fg_station_scan;

/* All of a measured scan and its card, or nothing of it. `scan` is its number. */
fg_status fg_station_keep_scan(fg_context *ctx, fg_station_database *database,
                               const fg_station_scan *kept, int64_t *scan,
                               fg_report_outcome *outcome);

/* The row of a card, inside a transaction of its caller. */
fg_status fg_station_insert_card(fg_context *ctx, fg_station_database *database,
                                 const fg_station_file *file, fg_card card, const char *message,
                                 int64_t scan);

#endif

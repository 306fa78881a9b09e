/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Content of a lot in the database: its foils and their scans. */
#ifndef FG_STATION_LOT_CONTENT_H
#define FG_STATION_LOT_CONTENT_H

#include "station/database.h"

/* Further columns of the lot's manifest, where a row needs them. */
typedef enum fg_lot_more {
  FG_LOT_COIL,
  FG_LOT_OVEN,
  FG_LOT_SCANNER,
  FG_LOT_ORDER,
  FG_LOT_DISPOSITION,
  FG_LOT_WITHHELD, /* why the verdict does not hold */
  FG_LOT_MORE
} fg_lot_more;

/* A scan with foils of the lot; of a bed's foils some may be of other lots. */
typedef struct fg_lot_scan {
  int64_t id;
  /* Below the station's folder, as stored (stored_name.h). A scan whose file another scan has
   * replaced gets a name that no file has. */
  char *path;
  char sha256[65];
  size_t of; /* foils of the scan, whatever lot they belong to */
  int *numbers;
  size_t count, capacity; /* of the lot's foils among them */
  char *serial, *die, *operator_name, *more[FG_LOT_MORE];
} fg_lot_scan;

/* A foil that had to be scanned again (not measured, undecided or without a verdict) counts with
 * the later scan of its serial number; one that fails stays. */
typedef struct fg_lot_content {
  fg_lot_scan *scans;
  size_t count, capacity;
  size_t replaced; /* foils that count with a later scan */
  size_t withheld; /* foils that count but have no verdict, as the scanner's check was due */
  int64_t setup;   /* of the newest of its scans */
  char state[64];  /* changes with every foil that comes, goes or is corrected (FG_LOT_STATE) */
} fg_lot_content;

/* Foils `f` of scans `s` that count in their lot, as SQL. */
#define FG_LOT_REPLACED                                                                            \
  "((f.verdict IN ('cannot_tell', 'not_measured') OR s.withheld IS NOT NULL) AND f.serial <> ''"   \
  " AND EXISTS (SELECT 1 FROM foils AS g WHERE g.serial = f.serial AND g.lot = f.lot"              \
  " AND g.scan > f.scan))"

/* State of a lot's content, as a text that changes with it; `name` is SQL. */
#define FG_LOT_STATE(name)                                                                         \
  "(SELECT count(*) || ' ' || total(h.id) FROM foils AS h WHERE h.lot = " name ") || ' ' ||"       \
  " (SELECT coalesce(max(c.id), 0) FROM foils AS h JOIN corrections AS c ON c.foil = h.id"         \
  " WHERE h.lot = " name ") || coalesce(' ' || (SELECT max(d.id) FROM foils AS h JOIN"             \
  " dispositions AS d ON d.foil = h.id WHERE h.lot = " name "), '')"

/* Reads a lot. FG_ERR_USAGE: there is no such lot. The call alone may use `reader` meanwhile. */
fg_status fg_lot_content_read(fg_context *ctx, sqlite3 *reader, const char *lot,
                              fg_lot_content *content);
void fg_lot_content_free(fg_lot_content *content);

/* Writes the note for a foil of that lot that comes after the lot was closed; "" for an open
 * lot. */
fg_status fg_station_lot_note(fg_context *ctx, fg_station_database *database, const char *lot,
                              char *words, size_t size);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A foil of the database with the settings of its measurement and verdict, and its record. */
#ifndef FG_STATION_STORED_FOIL_H
#define FG_STATION_STORED_FOIL_H

#include "lot/run/record.h"
#include "station/request.h"

typedef struct fg_stored_foil {
  int64_t id, at;
  int number; /* in its scan */
  char *serial, *lot, *die, *operator_name, *verdict, *reasons;
  char *path, *sha256, *source, *withheld; /* of the scan; withheld NULL: not */
  char *program;                           /* its version */
  char *model;                             /* of the scanner, its file; NULL: none */
  bool readable;                           /* settings, record and foil are there */
  char problem[400];                       /* else: the reason */
  fg_lot_settings settings;
  fg_record record;
  const fg_foil *foil; /* of the record */
} fg_stored_foil;

/* Loads a foil; `id`: as in the request. FG_ERR_USAGE: there is no such foil. A record of an
 * earlier program that this one cannot read is no failure: `problem` has the reason. */
fg_status fg_stored_foil_load(fg_context *ctx, sqlite3 *reader, const char *id,
                              fg_stored_foil **stored);
void fg_stored_foil_free(fg_stored_foil *stored);

/* Writes the verdict as a pill; the foil must be readable. */
fg_status fg_stored_foil_write_verdict(fg_context *ctx, const fg_stored_foil *stored, FILE *out);

/* Writes rows of a list of facts, its provenance, as on every page (page/provenance.h). */
fg_status fg_stored_foil_write_provenance(fg_context *ctx, const fg_stored_foil *stored, FILE *out);

/* Writes tables of every bump and the whole foil, each value with its limits and verdict; a
 * sentence where the record is not readable. */
void fg_stored_foil_write_tables(const fg_stored_foil *stored, FILE *out);

#endif

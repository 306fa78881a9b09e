/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A foil of the database with what it was measured and judged with, and the record of then. */
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
  char problem[400];                       /* else: why not */
  fg_lot_settings settings;
  fg_record record;
  const fg_foil *foil; /* of the record */
} fg_stored_foil;

/* `id`: as it stands in a request. FG_ERR_USAGE: there is no such foil. What this program cannot
 * read of what an earlier one kept is no failure: `problem` says what it is. */
fg_status fg_stored_foil_load(fg_context *ctx, sqlite3 *reader, const char *id,
                              fg_stored_foil **stored);
void fg_stored_foil_free(fg_stored_foil *stored);

/* The verdict as a pill; `past` is readable. */
fg_status fg_stored_foil_write_verdict(fg_context *ctx, const fg_stored_foil *stored, FILE *out);

/* Rows of a list of facts: where it comes from, as on every page (page/provenance.h). */
fg_status fg_stored_foil_write_provenance(fg_context *ctx, const fg_stored_foil *stored, FILE *out);

/* Every bump and the whole foil, each value with its limits and what they say of it; a sentence
 * where the record is not readable. */
void fg_stored_foil_write_tables(const fg_stored_foil *stored, FILE *out);

#endif

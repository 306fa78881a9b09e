/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One measured scan as a line of results.jsonl: compact, and exact to the ten digits of a report.
 *
 * {"scan", "sha256", "date", "measured_with", "error", "foils": [{"number", "flags", "error",
 * "values", "calibrated", "bumps": [{"number", "flags", "values", "calibrated"}]}], "checksum"}
 * Of a cantilever the foils have "beams" besides, of the same members.
 * `calibrated`, where a calibration is stated: fg_calibrated, source by source. `scan_bytes`
 * follows `scan` where a file name is not UTF-8: its bytes as hex digits. The checksum is of the
 * line itself (lot/run/seal.h). `values` are those of the rows of quantities (quantity.h) in its
 * order; the first line of the file names them. A quantity with an uncertainty takes two places, a
 * pair four. */
#ifndef FG_LOT_RUN_RECORD_H
#define FG_LOT_RUN_RECORD_H

#include <stdio.h>

#include "core/json_writer.h"
#include "foilgauge/report.h"

typedef struct fg_record {
  char *scan;
  char sha256[65];        /* "": the scan could not be read, so the record is not reused */
  char measured_with[65]; /* SHA-256 of version, design without tolerances, resolution, fields */
  char date[11];          /* of the scan's file, UTC, "2026-11-20"; "": unknown */
  char *error;            /* NULL: it was measured */
  fg_foil *foils;         /* without strips and labels; owned, with their bumps */
  size_t foil_count;
  size_t repeat_of; /* item + 1 of an earlier scan with the same bytes; 0: none */
} fg_record;

/* Formats a record as a line with its newline. NULL `measurement`: `record->error` holds the
 * reason. The caller frees the line. */
fg_status fg_record_format(fg_context *ctx, const fg_record *record,
                           const fg_measurement *measurement, char **line, size_t *length);

/* FG_ERR_DATA when the line is no record or fails its checksum. */
fg_status fg_record_parse(fg_context *ctx, const char *line, fg_record *record);
void fg_record_free(fg_record *record);

/* Writes the names of `values`, as members of the first line. */
void fg_record_write_names(fg_json *json);

/* Formats these names as a text; the caller frees it. */
fg_status fg_record_format_names(fg_context *ctx, char **text);

#endif

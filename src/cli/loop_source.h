/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Source of the table for the loop on tables: a file, a lot, the scans of runs. */
#ifndef FG_CLI_LOOP_SOURCE_H
#define FG_CLI_LOOP_SOURCE_H

#include "cli/output_set.h"
#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"
#include "foilgauge/lot_table.h"
#include "foilgauge/run_sheet.h"

enum { FG_LOOP_WITHOUTS = 100 };

/* The source as the command line names it: one of table, lot and runs. */
typedef struct fg_loop_source_request {
  const char *table, *lot, *runs;
  const char *forming_model;             /* a report of `forming`; NULL: none */
  const char *scans;                     /* of runs: a folder, or a column; NULL: column `scan` */
  const char *without[FG_LOOP_WITHOUTS]; /* columns to leave out */
  size_t withouts;
  double dpi;
  unsigned threads;
  bool allow_lossy;
  bool complete;   /* of a table only rows without an empty cell */
  bool has_design; /* the caller names one; else that of a lot holds */
} fg_loop_source_request;

typedef struct fg_loop_source {
  const fg_table *table;
  const char *path;
  char sha256[65];
  fg_loop_input *input; /* further files, for the report */
  size_t inputs;
  const char *const *row_name;
  char *said;
  bool failed; /* some of the scans could not be measured */
  /* Private: owns the data that the others point into. */
  fg_table read;
  fg_lot_table lot;
  fg_run_sheet measured;
  char **name;
  size_t names;
  char *forming_path, forming_sha256[65];
} fg_loop_source;

/* Checks, before anything is read, that no input of the source is an output. */
fg_status fg_loop_source_check(fg_context *ctx, const fg_loop_source_request *request,
                               fg_output_set *outputs);

/* Reads the table for a response and its model; `spec->group` is chosen where it is NULL, and
 * `design` is the lot's without `has_design`. Free with fg_loop_source_free. */
fg_status fg_loop_source_read(fg_context *ctx, const fg_loop_source_request *request,
                              fg_output_set *outputs, fg_loop_table_spec *spec, fg_design *design,
                              fg_loop_source *source);
void fg_loop_source_free(fg_loop_source *source);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measurements of the scans of a table of runs, for `doe` and `loop`. */
#ifndef FG_CLI_RUNS_H
#define FG_CLI_RUNS_H

#include "cli/output_set.h"
#include "foilgauge/run_sheet.h"

typedef struct fg_runs_scans {
  const char *sheet_path; /* of the table, for messages and relative paths */
  const char *folder;     /* of relative paths; NULL: that of the sheet */
  const char *column;     /* that names the scans */
  const char *quantity;   /* quantity to measure */
  const fg_design *design;
  fg_measure_options measure;
  fg_output_set *outputs; /* no scan may be one of them */
} fg_runs_scans;

/* Measures the scans, and names on standard error those that failed. */
fg_status fg_runs_measure(fg_context *ctx, const fg_table *sheet, const fg_runs_scans *how,
                          fg_run_sheet *measured);

#endif

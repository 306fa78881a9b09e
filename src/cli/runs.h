/* Tables of runs, as `doe` and `loop` read them: the CSV, and what the scans of the runs give. */
#ifndef FG_CLI_RUNS_H
#define FG_CLI_RUNS_H

#include "cli/output_set.h"
#include "foilgauge/run_sheet.h"

/* The table and its sum; "-" is standard input. */
fg_status fg_runs_read(fg_context *ctx, const char *path, fg_table *table, char sha256[65]);

typedef struct fg_runs_scans {
  const char *sheet_path; /* of the table, for messages and relative paths */
  const char *folder;     /* of relative paths; NULL: that of the sheet */
  const char *column;     /* that names the scans */
  const char *quantity;   /* to measure */
  const fg_design *design;
  fg_measure_options measure;
  fg_output_set *outputs; /* none of the scans may be one of them */
} fg_runs_scans;

/* Measures the scans, and names on standard error those that could not be. */
fg_status fg_runs_measure(fg_context *ctx, const fg_table *sheet, const fg_runs_scans *how,
                          fg_run_sheet *measured);

#endif

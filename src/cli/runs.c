/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/runs.h"

#include <stdio.h>
#include <string.h>

/* fg_run_sheet_visit */
static fg_status check_scan(fg_context *ctx, void *user, const char *scan) {
  return fg_output_set_check(ctx, user, &(fg_input){scan, "the scan"}, 1);
}

fg_status fg_runs_measure(fg_context *ctx, const fg_table *sheet, const fg_runs_scans *how,
                          fg_run_sheet *measured) {
  const char *path = how->sheet_path, *slash = strrchr(path, '/');
  char folder[4096];
  snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) + (slash == path) : 0, path);
  const fg_run_sheet_options options = {.column = how->column,
                                        .quantity = how->quantity,
                                        .folder = how->folder ? how->folder : folder,
                                        .design = how->design,
                                        .measure = how->measure,
                                        .visit = check_scan,
                                        .user = how->outputs};
  FG_TRY(fg_run_sheet_measure(ctx, sheet, &options, measured));
  for (size_t i = 0; i < measured->scans; i++)
    if (measured->scan[i].error)
      fprintf(stderr, "foilgauge: row %zu: %s\n", measured->scan[i].run, measured->scan[i].error);
  return FG_OK;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plan that `doe plan` kept beside a run sheet, for `doe` to read again. */
#ifndef FG_CLI_DOE_KEPT_PLAN_H
#define FG_CLI_DOE_KEPT_PLAN_H

#include "foilgauge/experiment.h"
#include "foilgauge/plan.h"
#include "foilgauge/table.h"

typedef struct fg_doe_plan {
  char *path;     /* of the plan that was found; owned; NULL: none */
  char note[400]; /* a note for the user; "": none */
  fg_plan_limits limits;
} fg_doe_plan;

/* The analysis that the plan is for. `coding` and `round`, of FG_FORMULA_VARIABLES entries, hold
 * those of the options; the plan's limits and steps are added behind them. */
typedef struct fg_doe_plan_request {
  const char *path; /* NULL: beside the table, if it is there */
  const char *data; /* the table's path, "-" for standard input */
  const fg_table *sheet;
  fg_experiment_options *options;
  fg_coding *coding;
  fg_rounding *round;
} fg_doe_plan_request;

/* FG_ERR_IO, FG_ERR_DATA as fg_plan_limits_load; the message says how to go on. Free with
 * fg_doe_plan_free. */
fg_status fg_doe_plan_find(fg_context *ctx, const fg_doe_plan_request *request, fg_doe_plan *plan);
void fg_doe_plan_free(fg_doe_plan *plan);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of an experiment's JSON report. */
#ifndef FG_REPORT_DOE_JSON_PARTS_H
#define FG_REPORT_DOE_JSON_PARTS_H

#include "core/json_writer.h"
#include "foilgauge/experiment.h"

/* Begins the object of that name, or writes null and returns false. */
bool fg_doe_json_begin_part(fg_json *json, const char *name, bool there);

void fg_doe_json_taken(fg_json *json, const fg_experiment *experiment);
fg_status fg_doe_json_order(fg_context *ctx, fg_json *json, const fg_experiment_report *report);

#endif

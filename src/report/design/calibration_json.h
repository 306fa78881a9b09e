/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `calibration` of a design, of a recipe and of reports (foilgauge/calibration.h). */
#ifndef FG_REPORT_CALIBRATION_JSON_H
#define FG_REPORT_CALIBRATION_JSON_H

#include <cjson/cJSON.h>

#include "core/json_writer.h"
#include "foilgauge/calibration.h"

/* null: none is stated. Messages begin with the member: "calibration.scale.k: ...". */
fg_status fg_calibration_read(fg_context *ctx, const cJSON *item, fg_calibration *calibration);

/* As it is read. */
void fg_json_calibration(fg_json *json, const char *name, const fg_calibration *calibration);

/* In a report: with what follows from it; null where none is stated. Or its members alone. */
void fg_json_calibration_used(fg_json *json, const char *name, const fg_calibration *calibration);
void fg_json_calibration_members(fg_json *json, const fg_calibration *calibration);

#endif

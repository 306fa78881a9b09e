/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `calibration` of a design, of a recipe and of reports (foilgauge/calibration.h). */
#ifndef FG_REPORT_CALIBRATION_JSON_H
#define FG_REPORT_CALIBRATION_JSON_H

#include <cjson/cJSON.h>

#include "core/json_writer.h"
#include "foilgauge/calibration.h"

/* Reads the member; null: none is stated. Messages begin with the member: "calibration.scale.k:
 * ...". */
fg_status fg_calibration_read(fg_context *ctx, const cJSON *item, fg_calibration *calibration);

/* Writes the member as it is read. */
void fg_json_calibration(fg_json *json, const char *name, const fg_calibration *calibration);

/* Write it in a report with its derived values, null where none is stated; or its members alone. */
void fg_json_calibration_used(fg_json *json, const char *name, const fg_calibration *calibration);
void fg_json_calibration_members(fg_json *json, const fg_calibration *calibration);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `calibration` of a report: as stated, with its derived values (report/design/members.h has the
 * rows, as they are read and written). */
#ifndef FG_REPORT_CALIBRATION_JSON_H
#define FG_REPORT_CALIBRATION_JSON_H

#include "core/json_writer.h"
#include "foilgauge/calibration.h"

/* Write it in a report with its derived values, null where none is stated; or its members alone. */
void fg_json_calibration_used(fg_json *json, const char *name, const fg_calibration *calibration);
void fg_json_calibration_members(fg_json *json, const fg_calibration *calibration);

#endif

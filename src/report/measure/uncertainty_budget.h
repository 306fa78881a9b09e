/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of u: the scan's statistics, and the uncertainty of the calibration. */
#ifndef FG_REPORT_MEASURE_UNCERTAINTY_BUDGET_H
#define FG_REPORT_MEASURE_UNCERTAINTY_BUDGET_H

#include "core/json_writer.h"
#include "foilgauge/report.h"

/* Writes the member `calibration` of a report: as stated, its derived values, and its budget;
 * null where none is stated. */
void fg_json_report_calibration(fg_json *json, const fg_report *report);

/* Writes a table of the quantities of a foil and its bumps, or of a scan's discs; nothing
 * without a calibration. */
void fg_html_uncertainty_budget(FILE *out, const fg_measurement *measurement, const fg_foil *foil);

#endif

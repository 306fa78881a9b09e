/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What u is made of: the scan's statistics, and what the calibration leaves in doubt. */
#ifndef FG_REPORT_MEASURE_UNCERTAINTY_BUDGET_H
#define FG_REPORT_MEASURE_UNCERTAINTY_BUDGET_H

#include "core/json_writer.h"
#include "foilgauge/report.h"

/* The member `calibration` of a report: what is stated, what follows from it, and its budget; null
 * where none is stated. */
void fg_json_report_calibration(fg_json *json, const fg_report *report);

/* A table of the quantities of a foil and its bumps, or of a scan's discs; without a calibration
 * nothing. */
void fg_html_uncertainty_budget(FILE *out, const fg_measurement *measurement, const fg_foil *foil);

#endif

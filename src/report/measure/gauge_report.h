/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gauges on the glass, for reports. */
#ifndef FG_REPORT_GAUGE_REPORT_H
#define FG_REPORT_GAUGE_REPORT_H

#include <stdio.h>

#include "core/json_writer.h"
#include "foilgauge/foil.h"

/* Writes the member `gauges` of one scan: as stated, and as found. */
void fg_json_gauges(fg_json *json, const fg_measurement *measurement);

/* Writes a line for each, for the terminal. */
void fg_text_gauges(FILE *out, const fg_measurement *measurement);

/* Writes a section of a page; nothing where none is stated. */
void fg_html_gauges(FILE *out, const fg_measurement *measurement);

#endif

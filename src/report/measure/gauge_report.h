/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gauges on the glass, for reports. */
#ifndef FG_REPORT_GAUGE_REPORT_H
#define FG_REPORT_GAUGE_REPORT_H

#include <stdio.h>

#include "core/member.h"
#include "foilgauge/foil.h"

/* Rows of a gauge of a scan, as stated and as found; its elements in an fg_measurement. */
extern const fg_members fg_gauge_reading_members;
bool fg_gauge_reading_at(const fg_subject *list, size_t i, fg_subject *element);

/* Writes a line for each, for the terminal. */
void fg_text_gauges(FILE *out, const fg_measurement *measurement);

/* Writes a section of a page; nothing where none is stated. */
void fg_html_gauges(FILE *out, const fg_measurement *measurement);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The channels of a colour scan against each other, for reports. */
#ifndef FG_REPORT_COLOUR_LINES_REPORT_H
#define FG_REPORT_COLOUR_LINES_REPORT_H

#include <stdio.h>

#include "core/json_writer.h"
#include "foilgauge/foil.h"

/* Writes the member `colour_lines` of a scan; nothing for a gray one. */
void fg_json_colour_lines(fg_json *json, const fg_measurement *measurement);

/* Writes one line for the terminal; nothing for a gray scan. */
void fg_text_colour_lines(FILE *out, const fg_measurement *measurement);

/* Writes a section of a page; nothing for a gray scan. */
void fg_html_colour_lines(FILE *out, const fg_measurement *measurement);

#endif

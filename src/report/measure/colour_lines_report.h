/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The channels of a colour scan against each other, for reports. */
#ifndef FG_REPORT_COLOUR_LINES_REPORT_H
#define FG_REPORT_COLOUR_LINES_REPORT_H

#include <stdio.h>

#include "core/json_writer.h"
#include "foilgauge/foil.h"

/* Member `colour_lines` of one scan; nothing of a gray one. */
void fg_json_colour_lines(fg_json *json, const fg_measurement *measurement);

/* One line for the terminal; nothing of a gray scan. */
void fg_text_colour_lines(FILE *out, const fg_measurement *measurement);

/* A section of a page; nothing of a gray scan. */
void fg_html_colour_lines(FILE *out, const fg_measurement *measurement);

#endif

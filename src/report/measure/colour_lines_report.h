/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The channels of a colour scan against each other, for reports. */
#ifndef FG_REPORT_COLOUR_LINES_REPORT_H
#define FG_REPORT_COLOUR_LINES_REPORT_H

#include <stdio.h>

#include "core/member.h"
#include "foilgauge/foil.h"

/* Rows of an fg_colour_lines, and of one channel of it (an fg_colour_shift). Their subjects' whole
 * is the measurement. */
extern const fg_members fg_colour_lines_members, fg_colour_shift_members;

/* Writes one line for the terminal; nothing for a gray scan. */
void fg_text_colour_lines(FILE *out, const fg_measurement *measurement);

/* Writes a section of a page; nothing for a gray scan. */
void fg_html_colour_lines(FILE *out, const fg_measurement *measurement);

#endif

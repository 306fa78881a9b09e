/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of the picture, for reports. */
#ifndef FG_REPORT_PICTURE_REPORT_H
#define FG_REPORT_PICTURE_REPORT_H

#include <stdio.h>

#include "core/json_writer.h"
#include "foilgauge/foil.h"

/* Writes the member `picture` of one scan: its state, and its findings with the settings that
 * cause them. */
void fg_json_picture_state(fg_json *json, const fg_measurement *measurement);

/* Writes a line for each finding, for the terminal; nothing without findings. */
void fg_text_picture_state(FILE *out, const fg_measurement *measurement);

/* Writes a section of a page. */
void fg_html_picture_state(FILE *out, const fg_measurement *measurement);

#endif

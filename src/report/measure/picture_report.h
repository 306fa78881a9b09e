/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of the picture, for reports. */
#ifndef FG_REPORT_PICTURE_REPORT_H
#define FG_REPORT_PICTURE_REPORT_H

#include <stdio.h>

#include "core/json_writer.h"
#include "foilgauge/foil.h"

/* Member `picture` of one scan: its state, and what was found with the settings that cause it. */
void fg_json_picture_state(fg_json *json, const fg_measurement *measurement);

/* For the terminal: a line for each finding; nothing of a picture as it should be. */
void fg_text_picture_state(FILE *out, const fg_measurement *measurement);

/* A section of a page. */
void fg_html_picture_state(FILE *out, const fg_measurement *measurement);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of the picture, for reports. */
#ifndef FG_REPORT_PICTURE_REPORT_H
#define FG_REPORT_PICTURE_REPORT_H

#include <stdio.h>

#include "core/member.h"
#include "foilgauge/foil.h"

/* Rows of an fg_picture_state: its values, and its findings with the settings that cause them. */
extern const fg_members fg_picture_state_members;

/* Writes a line for each finding, for the terminal; nothing without findings. */
void fg_text_picture_state(FILE *out, const fg_measurement *measurement);

/* Writes a section of a page. */
void fg_html_picture_state(FILE *out, const fg_measurement *measurement);

#endif

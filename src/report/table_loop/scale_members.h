/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scale of the response, for the report of the loop on tables. */
#ifndef FG_REPORT_TABLE_LOOP_SCALE_MEMBERS_H
#define FG_REPORT_TABLE_LOOP_SCALE_MEMBERS_H

#include "core/member.h"
#include "report/table_loop/words.h"

/* Of an fg_loop_response_scale; the whole of its subject is an fg_loop_report. */
extern const fg_members fg_loop_scale_members;

/* Returns true when a scale is to be told: another one that is proven, or makes claims needless. */
bool fg_loop_tells_scale(const fg_loop_result *result);
/* "on the scale 1/time (power -0.75, -1.1 to -0.4; p = 1e-8 ...) ...". */
void fg_loop_scale_words(const fg_loop_report *report, char text[FG_LOOP_WORDS]);

#endif

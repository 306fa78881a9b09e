/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows that lead the fit, for the report of the loop on tables. */
#ifndef FG_REPORT_TABLE_LOOP_INFLUENCE_MEMBERS_H
#define FG_REPORT_TABLE_LOOP_INFLUENCE_MEMBERS_H

#include "core/member.h"
#include "report/table_loop/words.h"

/* Of an fg_loop_influence; the whole of its subject is an fg_loop_report. */
extern const fg_members fg_loop_influence_members;

/* "row 9 leads distance_ft: without it 0.0105 instead of 0.0144 (...)". */
void fg_loop_influence_words(const fg_loop_report *report, const fg_loop_influence *influence,
                             char text[FG_LOOP_WORDS]);

#endif

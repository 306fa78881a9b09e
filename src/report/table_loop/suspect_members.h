/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Suspects of the loop on tables: members of JSON, page and terminal, and their words. The whole of
 * every subject is an fg_loop_report. */
#ifndef FG_REPORT_TABLE_LOOP_SUSPECT_MEMBERS_H
#define FG_REPORT_TABLE_LOOP_SUSPECT_MEMBERS_H

#include "core/member.h"
#include "report/table_loop/words.h"

/* Of an fg_loop_suspect. */
extern const fg_members fg_loop_suspect_members;
fg_member_element fg_loop_find_suspect;

/* "14 more rows, half of them at batch = E, half at batch = F". */
void fg_loop_suspect_decides(const fg_loop_report *report, const fg_loop_suspect *suspect,
                             char text[FG_LOOP_WORDS]);
/* Appends the suspects with their p-values, their aliases, and the rows that would decide. */
fg_status fg_loop_append_suspects(fg_context *ctx, const fg_loop_report *report, char **text);

#endif

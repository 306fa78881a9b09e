/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shares of the kinds of candidates in the error rate, for the report of the loop on tables. */
#ifndef FG_REPORT_TABLE_LOOP_FAMILY_MEMBERS_H
#define FG_REPORT_TABLE_LOOP_FAMILY_MEMBERS_H

#include "core/member.h"
#include "report/table_loop/words.h"

/* Of fg_loop_result. */
extern const fg_members fg_loop_share_members;

/* "recorded columns 30 %, ..." */
void fg_loop_shares_words(const fg_loop_result *result, char text[FG_LOOP_WORDS]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of claims, rejected candidates and residual tests, of JSON, page and terminal. The whole
 * of every subject is an fg_loop_report. */
#ifndef FG_REPORT_TABLE_LOOP_CLAIM_MEMBERS_H
#define FG_REPORT_TABLE_LOOP_CLAIM_MEMBERS_H

#include "core/member.h"
#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"

/* Of an fg_loop_claim, an fg_loop_rejected, an fg_loop_checked. Claims and rejected candidates have
 * the same columns of a page. */
extern const fg_members fg_loop_claim_members, fg_loop_rejected_members, fg_loop_check_members;
/* Of a row of the problem (size_t): its number in the table. */
extern const fg_members fg_loop_row_members;
/* Of an fg_loop_alias. */
extern const fg_members fg_loop_alias_members;
/* Of a parameter of the declared model, and of the list of them; of two doubles. */
extern const fg_members fg_loop_parameter_members, fg_loop_point_members;
fg_member_element fg_loop_find_parameter;

/* Of an fg_loop_error_row, in the list of those at `object`, whose number is `index`. */
extern const fg_members fg_loop_error_row_members;
fg_member_element fg_loop_find_error;

/* Residual tests that were done. */
fg_member_element fg_loop_find_check;
/* Words and size of a claim. */
const char *fg_loop_find_sentence(const fg_subject *claim, char buffer[FG_MEMBER_TEXT_MAX]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recommended steps after a loop on tables: one for each finding, in words. */
#ifndef FG_REPORT_TABLE_LOOP_NEXT_H
#define FG_REPORT_TABLE_LOOP_NEXT_H

#include "report/table_loop/words.h"

enum { FG_LOOP_STEP = 1600 };

/* "The declared model is not enough; what it lacks was found." */
const char *fg_loop_outcome_meaning(const fg_loop_result *result);
size_t fg_loop_next_count(const fg_loop_report *report);
void fg_loop_next_step(const fg_loop_report *report, size_t step, char text[FG_LOOP_STEP]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tests of the whole residual that `clean` rests on, in words. */
#ifndef FG_REPORT_TABLE_LOOP_CHECKS_H
#define FG_REPORT_TABLE_LOOP_CHECKS_H

#include "report/table_loop/words.h"

/* "lack_of_fit", as the JSON names it. */
const char *fg_loop_check_id(fg_loop_check check);
/* What a test asks; "yes" where it is passed: "Are rows 2 to 10 apart independent?". */
void fg_loop_check_words(const fg_loop_report *report, fg_loop_check check,
                         char text[FG_LOOP_WORDS]);
/* What the test that fails says, as a sentence without its full stop. */
void fg_loop_failed_words(const fg_loop_report *report, char text[FG_LOOP_WORDS]);
/* What to do about it. */
void fg_loop_failed_advice(const fg_loop_report *report, char text[FG_LOOP_WORDS]);
/* The coordinate that it lives on, or the names of several: "load", "T, D". */
void fg_loop_failed_coordinate(const fg_loop_report *report, char text[FG_LOOP_WORDS]);

#endif

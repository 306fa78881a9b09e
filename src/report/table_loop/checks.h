/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words for the residual tests that `clean` requires. */
#ifndef FG_REPORT_TABLE_LOOP_CHECKS_H
#define FG_REPORT_TABLE_LOOP_CHECKS_H

#include "report/table_loop/words.h"

/* Names in JSON of findings that no effect explains: "curve", then the residual tests. */
extern const char *const fg_loop_finding_kinds[];
/* Writes a test's question, "yes" if it passes: "Are rows 2 to 10 apart independent?". */
void fg_loop_check_words(const fg_loop_report *report, fg_loop_check check,
                         char text[FG_LOOP_WORDS]);
/* Writes the finding of the failed test, as a sentence without its full stop. */
void fg_loop_failed_words(const fg_loop_report *report, char text[FG_LOOP_WORDS]);
/* Writes the remedy for the failed test. */
void fg_loop_failed_advice(const fg_loop_report *report, char text[FG_LOOP_WORDS]);
/* Writes the coordinate of the failed test, or several: "load", "T, D". */
void fg_loop_failed_coordinate(const fg_loop_report *report, char text[FG_LOOP_WORDS]);

#endif

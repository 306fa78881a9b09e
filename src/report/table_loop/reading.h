/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words for the size of a finding in its reader's units. */
#ifndef FG_REPORT_TABLE_LOOP_READING_H
#define FG_REPORT_TABLE_LOOP_READING_H

#include "report/table_loop/words.h"

/* Returns the smallest difference of that kind that would have been found, given the detectable
 * amplitude. */
double fg_loop_readable_size(const fg_loop_candidate *candidate, double amplitude);

/* Effect on the response ("it rises by 0.72 ± 0.10 from the first run to the last"); of the scatter
 * "correlation 0.94 ± 0.03", "ratio of the sd 4.1 ± 0.9". */
void fg_loop_claim_size(const fg_loop_report *report, const fg_loop_claim *claim,
                        char text[FG_LOOP_WORDS]);

/* Words and size: "levels of operator: operator B reads 0.59 ± 0.09 higher than operator A". */
void fg_loop_claim_sentence(const fg_loop_report *report, const fg_loop_claim *claim,
                            char text[2 * FG_LOOP_WORDS]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words for the size of a finding in its reader's units. */
#ifndef FG_REPORT_TABLE_LOOP_READING_H
#define FG_REPORT_TABLE_LOOP_READING_H

#include "report/table_loop/words.h"

/* Writes "operator B reads 0.592 ± 0.093 µm higher than operator A", "it rises by 0.72 ± 0.10 from
 * the first run to the last": for claims of the mean and of single rows. U is of 95 %, by Student's
 * t. */
void fg_loop_claim_reading(const fg_loop_report *report, const fg_loop_claim *claim,
                           char text[FG_LOOP_WORDS]);

/* Returns the smallest difference of that kind that would have been found, given the detectable
 * amplitude. */
double fg_loop_readable_size(const fg_loop_candidate *candidate, double amplitude);

#endif

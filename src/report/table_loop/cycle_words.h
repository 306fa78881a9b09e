/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words and members for cycles: their period, their orders. */
#ifndef FG_REPORT_TABLE_LOOP_CYCLE_WORDS_H
#define FG_REPORT_TABLE_LOOP_CYCLE_WORDS_H

#include "core/member.h"
#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"

/* " that returns every 90° (order 4 of 360°)", " ... every 2.003 ± 0.004 mm"; its orders where they
 * are several. */
void fg_loop_period_words(const fg_loop_report *report, const fg_loop_claim *claim, char *text,
                          size_t size);
/* "amplitude of order 1 2.00 ± 0.11 µm, highest at 57°; of order 4 ...". `times` widens u to U. */
void fg_loop_order_words(const fg_loop_report *report, const fg_loop_claim *claim, double times,
                         char *text, size_t size);
/* Of a fg_loop_order_fit. */
extern const fg_members fg_loop_order_members;

#endif

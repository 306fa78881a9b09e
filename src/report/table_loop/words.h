/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words for the effects that the loop on tables sought and found. */
#ifndef FG_REPORT_TABLE_LOOP_WORDS_H
#define FG_REPORT_TABLE_LOOP_WORDS_H

#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"

enum { FG_LOOP_WORDS = 480 };

/* Number as text for a sentence or a cell; a dash for NaN. */
typedef struct fg_loop_number {
  char text[32];
} fg_loop_number;

fg_loop_number fg_loop_number_text(const char *format, double value);
/* "p = 0.0021"; "p < 1e-12" below that. */
fg_loop_number fg_loop_p_text(double p);
/* "runs", "bumps" or "rows", by the name of their order. */
const char *fg_loop_row_words(const fg_loop_coordinate *order);

/* "a drift over the runs", "serial correlation along the runs", "a wrong response in row 3".
 */
void fg_loop_candidate_words(const fg_loop_report *report, const fg_loop_candidate *candidate,
                             char text[FG_LOOP_WORDS]);
/* "row 3", "rows 2, 5 and 54", or the rows' own names; for a candidate of single rows. */
void fg_loop_rows_words(const fg_loop_report *report, const fg_loop_candidate *candidate,
                        char text[FG_LOOP_WORDS]);
/* Writes a member of an alias class, which may be a sum of two. */
void fg_loop_alias_words(const fg_loop_report *report, const fg_loop_alias *alias,
                         char text[2 * FG_LOOP_WORDS]);
/* Writes a member's distance from the claim: "explains 15 % more", empty where unknown. */
void fg_loop_closeness_words(const fg_loop_alias *alias, char text[FG_LOOP_WORDS]);
/* A claim as a statement: "neighbouring runs are alike", "rows 2 and 54 are wrong"; of the mean as
 * its candidate's words. */
void fg_loop_claim_words(const fg_loop_report *report, const fg_loop_claim *claim,
                         char text[FG_LOOP_WORDS]);
/* Verdict of a residual test: "yes" for noise, "no", and "not sure" for a p-value that noise alone
 * reaches in one table of ten. */
const char *fg_loop_check_answer(const fg_loop_checked *check);
/* Finds the residual test of a clean result nearest to failing, if noise alone comes as near in one
 * table of ten at most. false: none. */
bool fg_loop_suspects_residual(const fg_loop_result *result, fg_loop_check *check);
/* Returns the verdict on a candidate that is not claimed. */
const char *fg_loop_rejected_word(const fg_loop_rejected *rejected);
/* +1: the scatter grows with the coordinate of a spread, -1: it falls, 0: it has levels. */
int fg_loop_spread_direction(const fg_loop_report *report, const fg_loop_claim *claim);

/* A row of the table of errors; `before` is finite. */
typedef struct fg_loop_error_row {
  const char *name;
  double before, after;
} fg_loop_error_row;

enum { FG_LOOP_ERROR_ROWS = 6 };
/* Selects the rows that this result has; returns their number. */
size_t fg_loop_error_rows(const fg_loop_report *report, fg_loop_error_row rows[FG_LOOP_ERROR_ROWS]);
/* Returns true when there is an error after the loop: an effect of the mean was found, or
 * neighbours predict a row. */
bool fg_loop_has_after(const fg_loop_result *result);
bool fg_loop_claims_scatter(const fg_loop_result *result, fg_loop_scatter scatter);

#endif

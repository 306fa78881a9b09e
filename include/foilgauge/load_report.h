/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The report of load-displacement tests: JSON, a table for the terminal, CSV, a page, and a table
 * for the loop. */
#ifndef FOILGAUGE_LOAD_REPORT_H
#define FOILGAUGE_LOAD_REPORT_H

#include "foilgauge/load_test.h"
#include "foilgauge/report.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Compares with the limits; `words` gets the outcome in a sentence, may be NULL. */
fg_verdict fg_load_judge_direction(const fg_load_test *test, const fg_load_direction *direction);
fg_verdict fg_load_judge_bearing(const fg_load_test *test,
                                 size_t bearing); /* includes its directions */
fg_verdict fg_load_judge_value(const fg_load_test *test, fg_load_quantity quantity,
                               const fg_load_value *value);
void fg_load_judge(const fg_load_test *test, fg_report_outcome *outcome, char *words, size_t size);

/* Writes the words of a direction's flags, joined; "" without flags. `plain`: for people. */
void fg_load_flag_words(unsigned flags, bool plain, char *words, size_t size);
void fg_break_away_flag_words(unsigned flags, bool plain, char *words, size_t size);

/* "foilgauge/load_test/1", reports/schema/load_test.schema.json. */
fg_status fg_load_write_json(fg_context *ctx, const fg_load_test *test, FILE *out);
fg_status fg_load_write_text(fg_context *ctx, const fg_load_test *test, FILE *out);
fg_status fg_load_write_html(fg_context *ctx, const fg_load_test *test, FILE *out);

/* CSV, a row per bearing and azimuth. */
fg_status fg_load_write_csv(fg_context *ctx, const fg_load_test *test, FILE *out);

/* Table for `foilgauge loop --table`: causes and one response, clearance_um, or difference_um where
 * a lot predicts; without values that follow from the response. */
fg_status fg_load_write_table(fg_context *ctx, const fg_load_test *test, FILE *out);

#ifdef __cplusplus
}
#endif
#endif

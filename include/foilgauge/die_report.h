/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The report of a die: JSON, a table for the terminal, a page. */
#ifndef FOILGAUGE_DIE_REPORT_H
#define FOILGAUGE_DIE_REPORT_H

#include "foilgauge/die.h"
#include "foilgauge/report.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Compares a bump with the design's tolerances for dies: those of a quantity of a die's bumps, of
 * every bump of each half, and of overall.radius_mm. The others are a foil's. */
fg_verdict fg_die_judge_bump(const fg_die *die, const fg_die_bump *bump);
fg_verdict fg_die_judge_value(const fg_die *die, const char *name, const fg_die_value *value);
/* `words` gets the outcome in a sentence; may be NULL. */
void fg_die_judge(const fg_die *die, fg_report_outcome *outcome, char *words, size_t size);

/* Returns the number of the design's tolerances that apply to a die. */
size_t fg_die_tolerances(const fg_die *die);

/* Bumps of the design that no trace of a half measured: all; those traced and lost to dust
 * (fg_die_trace); those that no trace shows completely. */
typedef enum fg_die_unseen_kind {
  FG_DIE_UNSEEN,
  FG_DIE_LOST,
  FG_DIE_UNTRACED,
} fg_die_unseen_kind;

/* Returns the number of these bumps and lists them in `words`: "1, 9". 0 for a half without
 * traces. */
size_t fg_die_unseen(const fg_die *die, fg_die_half half, fg_die_unseen_kind kind, char *words,
                     size_t size);
bool fg_die_is_lost(const fg_die_trace *trace, int number);

/* "foilgauge/die/1", reports/schema/die.schema.json. */
fg_status fg_die_write_json(fg_context *ctx, const fg_die *die, FILE *out);
fg_status fg_die_write_table(fg_context *ctx, const fg_die *die, FILE *out);

/* One self-contained page: errors by half, traces with circles, residuals, tables. */
fg_status fg_die_write_html(fg_context *ctx, const fg_die *die, FILE *out);

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of the quantities that keep a run from passing. */
#ifndef FG_REPORT_MEASURE_OUTCOME_WORDS_H
#define FG_REPORT_MEASURE_OUTCOME_WORDS_H

#include "foilgauge/report.h"

/* Writes the quantities with values of that verdict over all scans, in the design's order, with
 * counts: ": bump radius (4), bump height, foil free"; nothing without one. */
fg_status fg_report_write_quantities(fg_context *ctx, const fg_report *report, fg_verdict verdict,
                                     FILE *out);

/* Writes "What decides it: ...", a line per cure of undecided values; nothing without one. */
fg_status fg_report_write_cures(fg_context *ctx, const fg_report *report, FILE *out);

#endif

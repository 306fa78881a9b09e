/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of the quantities that keep a run from passing. */
#ifndef FG_REPORT_MEASURE_OUTCOME_WORDS_H
#define FG_REPORT_MEASURE_OUTCOME_WORDS_H

#include "foilgauge/report.h"

/* ": bump radius (4), bump height, foil free": the quantities with values of that verdict over all
 * scans, in the design's order, each with how many; nothing without one. */
fg_status fg_report_write_quantities(fg_context *ctx, const fg_report *report, fg_verdict verdict,
                                     FILE *out);

/* "What decides it: ...", a line per cure of what cannot be told; nothing without one. */
fg_status fg_report_write_cures(fg_context *ctx, const fg_report *report, FILE *out);

#endif

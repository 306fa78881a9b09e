/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Verdicts as pages show them: a coloured pill with a sign and a word. */
#ifndef FG_PAGE_VERDICT_H
#define FG_PAGE_VERDICT_H

#include <stdio.h>

#include "foilgauge/report.h"

/* Returns "Within tolerance", "Out of tolerance", ... */
const char *fg_html_verdict_title(fg_verdict verdict);
/* Writes the verdict as a pill. */
void fg_html_verdict(FILE *out, fg_verdict verdict);
/* Writes an outcome as a pill: "Rejected" when it is a defect and no value that fails. */
void fg_html_outcome(FILE *out, const fg_report_outcome *outcome);

#endif

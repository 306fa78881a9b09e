/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cure of a verdict of "cannot tell". */
#ifndef FG_REPORT_MEASURE_CURES_H
#define FG_REPORT_MEASURE_CURES_H

#include "foilgauge/report.h"

enum { FG_CURES_MAX = 4 };

/* Each once; the texts are static. */
typedef struct fg_cures {
  const char *list[FG_CURES_MAX];
  size_t count;
} fg_cures;

/* Of a quantity whose limit lies within U: the cheapest cure, where an unknown tone curve is in its
 * U and could be known; else NULL. */
const char *fg_cure_of(const fg_design *design, const fg_quantity *row);

/* Those of a decision, without what is there. */
void fg_cures_add(fg_cures *cures, const fg_decision *decision);

#endif

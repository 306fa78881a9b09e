/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cures of a verdict "cannot tell": the cheapest way to a decision. */
#ifndef FG_REPORT_MEASURE_CURES_H
#define FG_REPORT_MEASURE_CURES_H

#include "foilgauge/report.h"

enum { FG_CURES_MAX = 4 };

/* A set of cures, each once; the texts are static. */
typedef struct fg_cures {
  const char *list[FG_CURES_MAX];
  size_t count;
} fg_cures;

/* Returns the cheapest cure of a quantity whose limit lies within U: there is one where U holds
 * the error of an unknown tone curve; else NULL. */
const char *fg_cure_of(const fg_design *design, const fg_quantity *row);

/* Adds the cures of a decision that are not in the set. */
void fg_cures_add(fg_cures *cures, const fg_decision *decision);

#endif

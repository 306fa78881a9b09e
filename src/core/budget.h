/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A ceiling for the memory that grows with a scan: rows and tiles that are held.
 *
 * A job has one; threads share it. What it does not count (code, libraries, stacks, the results) is
 * small and does not grow with the bed.
 */
#ifndef FG_CORE_BUDGET_H
#define FG_CORE_BUDGET_H

#include <stdatomic.h>
#include <stddef.h>

#include "foilgauge/status.h"

typedef struct fg_budget {
  const char *name; /* of the scan, for error texts */
  size_t limit;     /* bytes; 0: none */
  atomic_size_t used;
} fg_budget;

/* Counts `bytes` in before they are allocated. FG_ERR_DATA, and nothing is counted, when they would
 * go beyond the limit. NULL is a budget without limit. */
fg_status fg_budget_take(fg_context *ctx, fg_budget *budget, size_t bytes);

void fg_budget_give(fg_budget *budget, size_t bytes);

#endif

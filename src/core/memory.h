/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checked memory, whose functions are public (foilgauge/memory.h), and a budget for it. */
#ifndef FG_CORE_MEMORY_H
#define FG_CORE_MEMORY_H

#include <stdatomic.h>
#include <stddef.h>

#include "foilgauge/memory.h"

/* Limit of the memory that grows with a scan: held rows and tiles.
 *
 * A job has one budget; threads share it. Memory that it does not count (code, libraries, stacks,
 * the results) is small and does not grow with the bed.
 */
typedef struct fg_budget {
  const char *name; /* of the scan, for error texts */
  size_t limit;     /* bytes; 0: none */
  atomic_size_t used;
} fg_budget;

/* Reserves `bytes` before they are allocated. FG_ERR_DATA, and nothing is reserved, beyond the
 * limit. NULL is a budget without limit. */
fg_status fg_budget_reserve(fg_context *ctx, fg_budget *budget, size_t bytes);

void fg_budget_release(fg_budget *budget, size_t bytes);

#endif

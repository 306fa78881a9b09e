/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/budget.h"

fg_status fg_budget_take(fg_context *ctx, fg_budget *budget, size_t bytes) {
  if (!budget) return FG_OK;
  size_t before = atomic_fetch_add(&budget->used, bytes);
  if (budget->limit == 0 || (before <= budget->limit && bytes <= budget->limit - before))
    return FG_OK;
  atomic_fetch_sub(&budget->used, bytes);
  return fg_fail(
      ctx, FG_ERR_DATA,
      "%s: needs more than the %zu MiB of memory that it may take (--max-memory): either "
      "the bed is dirty all over, or raise the ceiling",
      budget->name, budget->limit >> 20);
}

void fg_budget_give(fg_budget *budget, size_t bytes) {
  if (budget) atomic_fetch_sub(&budget->used, bytes);
}

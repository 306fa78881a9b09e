/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/memory.h"

#include <stdint.h>
#include <stdlib.h>

fg_status fg_memory_allocate(fg_context *ctx, size_t count, size_t size, void **out) {
  *out = NULL;
  if (size != 0 && count > SIZE_MAX / size)
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu items of %zu bytes", count, size);
  size_t bytes = count * size;
  *out = calloc(bytes ? bytes : 1, 1);
  if (!*out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu bytes", bytes);
  return FG_OK;
}

fg_status fg_memory_reserve(fg_context *ctx, size_t needed, size_t size, size_t *capacity,
                            void **block) {
  if (needed <= *capacity) return FG_OK;
  size_t grown = *capacity > SIZE_MAX / 2 ? needed : *capacity * 2;
  if (grown < needed) grown = needed;
  if (grown < 16) grown = 16;
  if (size != 0 && grown > SIZE_MAX / size)
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu items of %zu bytes", grown, size);
  void *moved = realloc(*block, grown * size);
  if (!moved) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu bytes", grown * size);
  *block = moved;
  *capacity = grown;
  return FG_OK;
}

fg_status fg_budget_reserve(fg_context *ctx, fg_budget *budget, size_t bytes) {
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

void fg_budget_release(fg_budget *budget, size_t bytes) {
  if (budget) atomic_fetch_sub(&budget->used, bytes);
}

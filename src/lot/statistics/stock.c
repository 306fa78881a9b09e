/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The foils that bearings are drawn from. */
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "lot/statistics/assembly.h"

fg_status fg_stock_allocate(fg_context *ctx, size_t foils, size_t places, fg_stock *stock) {
  double **const parts[] = {&stock->clearance_mm, &stock->shared_mm, &stock->own_mm};
  *stock = (fg_stock){.foils = foils, .places = places};
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    void *block;
    fg_status status = fg_memory_allocate(ctx, foils * places, sizeof(double), &block);
    if (status != FG_OK) {
      fg_stock_free(stock);
      return status;
    }
    *parts[i] = block;
  }
  return FG_OK;
}

fg_status fg_stock_copy(fg_context *ctx, const fg_stock *stock, fg_stock *copy) {
  size_t bytes = stock->foils * stock->places * sizeof(double);
  FG_TRY(fg_stock_allocate(ctx, stock->foils, stock->places, copy));
  memcpy(copy->clearance_mm, stock->clearance_mm, bytes);
  memcpy(copy->shared_mm, stock->shared_mm, bytes);
  memcpy(copy->own_mm, stock->own_mm, bytes);
  return FG_OK;
}

void fg_stock_free(fg_stock *stock) {
  free(stock->clearance_mm);
  free(stock->shared_mm);
  free(stock->own_mm);
  *stock = (fg_stock){0};
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Combinations of two factors' levels that no run has: the numbers of their interaction that cannot
 * be told, and what counts them as 0. */
#include <stdlib.h>

#include "core/memory.h"
#include "core/text.h"
#include "stats/regression_parts.h"

enum { CELLS_NAMED = 4 };

/* Finds the factors of a term that is a product of two; false: it is another. */
static bool find_two_factors(const fg_model *model, size_t term, size_t factor[2]) {
  size_t found = 0;
  for (size_t v = 0; v < model->formula.variables; v++) {
    unsigned power = model->formula.term[term].power[v];
    if (!power) continue;
    if (found == 2 || power > 1 || !model->levels[v].count) return false;
    factor[found++] = v;
  }
  return found == 2;
}

static fg_status list_empty_cells(fg_context *ctx, const fg_model *model, const size_t factor[2],
                                  char **text, size_t *empty) {
  const fg_levels *a = &model->levels[factor[0]], *b = &model->levels[factor[1]];
  const char *const names[] = {model->formula.variable[factor[0]].name,
                               model->formula.variable[factor[1]].name};
  bool *seen;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, a->count * b->count, sizeof *seen, (void **)&seen));
  for (size_t row = 0; row < model->rows; row++)
    seen[a->index[row] * b->count + b->index[row]] = true;
  for (size_t i = 0; i < a->count * b->count && status == FG_OK; i++) {
    if (seen[i] || ++*empty > CELLS_NAMED) continue;
    status = fg_text_append(ctx, text, "%s%s %s with %s %s", *empty > 1 ? ", " : "", names[0],
                            a->name[i / b->count], names[1], b->name[i % b->count]);
  }
  free(seen);
  if (status == FG_OK && *empty > CELLS_NAMED)
    status = fg_text_append(ctx, text, " and %zu more combinations", *empty - CELLS_NAMED);
  return status;
}

fg_status fg_regression_empty_cells(fg_context *ctx, const fg_model *model, fg_regression *reg) {
  fg_status status = FG_OK;
  for (size_t term = 0; term < model->formula.terms && status == FG_OK; term++) {
    size_t factor[2], empty = 0, told = 0, columns = 0;
    char *cells = NULL;
    for (size_t j = 0; j < model->columns; j++) {
      if (model->column[j].term != term) continue;
      columns++;
      told += !reg->coefficient[j].aliased;
    }
    if (told == columns || !find_two_factors(model, term, factor)) continue;
    status = list_empty_cells(ctx, model, factor, &cells, &empty);
    if (status == FG_OK && empty)
      status = fg_regression_note(
          ctx, reg,
          "no run has %s: %zu of %zu numbers of the interaction %s can be told. The tests of %s "
          "and "
          "%s take means over all combinations, in which the others count as 0",
          cells, told, columns, model->term_name[term], model->formula.variable[factor[0]].name,
          model->formula.variable[factor[1]].name);
    free(cells);
  }
  return status;
}

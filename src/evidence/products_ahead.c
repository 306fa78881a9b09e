/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/products_ahead.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "evidence/products.h"
#include "evidence/unnamed.h"

/* Columns of some models, each once. */
typedef struct column_list {
  size_t *column, count;
  bool *listed;
} column_list;

static void add_columns(column_list *list, size_t first, size_t count) {
  for (size_t c = first; c < first + count; c++) {
    if (!list->listed[c]) list->column[list->count++] = c;
    list->listed[c] = true;
  }
}

static bool may_join_any(const fg_evidence_model *const *models, size_t count,
                         const fg_evidence_option *option, fg_evidence_may_join *may_join) {
  for (size_t m = 0; m < count; m++)
    if (may_join(models[m], option)) return true;
  return false;
}

fg_status fg_evidence_find_products_ahead(fg_context *ctx, fg_evidence_search *s,
                                          const fg_evidence_model *const *models, size_t count,
                                          bool named, fg_evidence_may_join *may_join) {
  size_t all = s->problem.count + 1;
  column_list list = {0};
  bool *wanted = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, all, sizeof *list.column, (void **)&list.column));
  FG_TRY_EXIT(fg_memory_allocate(ctx, all, 2 * sizeof *wanted, (void **)&wanted));
  list.listed = wanted + all;
  add_columns(&list, s->scatter.first, fg_evidence_common_columns(&s->scatter));
  for (size_t m = 0; m < count; m++)
    for (size_t k = 0; k < models[m]->parts; k++)
      add_columns(&list, models[m]->part[k]->first, models[m]->part[k]->count);
  for (size_t o = 0; o < s->option_count; o++) {
    const fg_evidence_option *option = &s->options[o];
    if (named && !fg_effect_bears_name(option->effect)) continue;
    if (may_join_any(models, count, option, may_join))
      memset(wanted + option->first, true, option->sets * option->each);
  }
  FG_TRY_EXIT(fg_evidence_find_products(ctx, &s->problem, list.column, list.count, wanted,
                                        s->request.threads));
exit:
  free(list.column);
  free(wanted);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/trial.h"

#include <stdlib.h>

#include "core/memory.h"
#include "effect/columns.h"

fg_status fg_evidence_trial_open(fg_context *ctx, const fg_evidence_problem *p,
                                 const fg_effect *effect, size_t each, size_t shapes,
                                 fg_evidence_trial *t) {
  size_t all = p->edge_fit->row_count, columns = each * shapes;
  *t = (fg_evidence_trial){.effect = effect, .each = each};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, columns, sizeof *t->column, (void **)&t->column));
  FG_TRY_EXIT(fg_memory_allocate(ctx, columns * (p->rows + p->rank), sizeof *t->values,
                                 (void **)&t->values));
  FG_TRY_EXIT(fg_memory_allocate(ctx, (each + 1) * all, sizeof *t->raw, (void **)&t->raw));
exit:
  if (status != FG_OK) fg_evidence_trial_close(t);
  return status;
}

void fg_evidence_trial_close(fg_evidence_trial *t) {
  free(t->column);
  free(t->values);
  free(t->raw);
  *t = (fg_evidence_trial){.effect = NULL};
}

void fg_evidence_trial_add(const fg_evidence_problem *p, const double *shape,
                           fg_evidence_trial *t) {
  size_t all = p->edge_fit->row_count;
  double *white = t->raw + t->each * all;
  fg_effect_columns(p->edge_fit, t->effect, shape, t->raw);
  for (size_t c = 0; c < t->each; c++) {
    fg_evidence_column *to = &t->column[t->count];
    to->values = t->values + t->count * (p->rows + p->rank);
    to->along = to->values + p->rows;
    fg_evidence_make(p, t->raw + c * all, white, to);
    t->count++;
  }
}

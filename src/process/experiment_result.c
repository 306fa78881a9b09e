/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Predictions of an analysed experiment, its notes, and freeing it. */
#include <stdarg.h>
#include <stdlib.h>

#include "core/text.h"
#include "process/experiment_parts.h"

fg_status fg_experiment_note(fg_context *ctx, fg_experiment *e, const char *format, ...) {
  va_list values;
  va_start(values, format);
  fg_status status = fg_notes_add(ctx, &e->note, &e->notes, &e->note_capacity, format, values);
  va_end(values);
  return status;
}

double fg_factor_real(const fg_factor *factor, double x) {
  return factor->coded ? fg_coding_to_real(&factor->coding, x) : x;
}

const fg_experiment *fg_experiment_best(const fg_experiment *e) {
  return e->reduced ? e->reduced : e;
}

void fg_experiment_free(fg_experiment *e) {
  if (!e) return;
  fg_experiment_free(e->reduced);
  free(e->reduced);
  for (size_t i = 0; i < e->askeds; i++)
    free(e->asked[i].text);
  free(e->asked);
  fg_notes_free(e->note, e->notes);
  for (size_t i = 0; i < e->constraints; i++)
    free(e->constraint[i]);
  free(e->constraint);
  fg_split_plot_free(&e->split_plot);
  fg_regression_free(&e->regression);
  fg_model_free(&e->model);
  fg_table_free(&e->table);
  free(e->effect);
  free(e->setting);
  free(e->u);
  free(e->weight);
  free(e->taken);
  free(e->taken_out);
  free(e->order_value);
  free(e->response);
  free(e->formula);
  free(e->block);
  free(e->whole_plot);
  *e = (fg_experiment){0};
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Result of a run of the loop: its words, its notes, a claim's value at a row. */
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "table_loop/run.h"

const char *const fg_loop_verdict_words[] = {
    "found", "tied", "absent", "inconclusive", "absorbed by geometry", "explained by others", NULL};

const char *fg_loop_verdict_word(fg_loop_verdict verdict) {
  return fg_loop_verdict_words[verdict];
}

const char *const fg_loop_outcome_words[] = {"clean",        "explained", "partly explained",
                                             "unattributed", "suspected", NULL};

const char *fg_loop_outcome_word(fg_loop_outcome outcome) {
  return fg_loop_outcome_words[outcome];
}

fg_status fg_engine_note(fg_context *ctx, fg_loop_result *result, const char *format, ...) {
  va_list values;
  va_start(values, format);
  fg_status status =
      fg_notes_add(ctx, &result->note, &result->notes, &result->note_capacity, format, values);
  va_end(values);
  return status;
}

void fg_loop_result_free(fg_loop_result *result) {
  fg_notes_free(result->note, result->notes);
  free(result->curve.shape);
  free(result->setting);
  free(result->rejected);
  free(result->parameter);
  free(result->parameter_u);
  free(result->before_fit);
  free(result->after_fit);
  free(result->effect_fit);
  free(result->suspect_fit);
  *result = (fg_loop_result){0};
}

fg_status fg_loop_claim_evaluate(fg_context *ctx, const fg_loop_problem *problem,
                                 const fg_loop_claim *claim, double *effect) {
  double *columns = NULL;
  size_t rows = problem->rows;
  memset(effect, 0, rows * sizeof *effect);
  if (claim->columns == 0) return FG_OK; /* of the scatter */
  FG_TRY(fg_memory_allocate(ctx, rows, (claim->columns + 1) * sizeof *columns, (void **)&columns));
  claim->candidate.effect->basis(problem, &claim->candidate, claim->shape, columns);
  for (size_t k = 0; k < claim->columns; k++)
    for (size_t i = 0; i < rows; i++)
      effect[i] += claim->coefficient[k] * columns[k * rows + i];
  free(columns);
  return FG_OK;
}

double fg_loop_curve_at(const fg_loop_curve *curve, double value) {
  size_t k = 0;
  if (value <= curve->shape[0][0]) return curve->shape[0][1];
  while (k + 1 < curve->count && curve->shape[k + 1][0] < value)
    k++;
  if (k + 1 >= curve->count) return curve->shape[curve->count - 1][1];
  double share = (value - curve->shape[k][0]) / (curve->shape[k + 1][0] - curve->shape[k][0]);
  return curve->shape[k][1] + share * (curve->shape[k + 1][1] - curve->shape[k][1]);
}

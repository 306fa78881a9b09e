/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Predictions of a fitted regression, its notes, and freeing it. */
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>

#include "core/extended.h"
#include "core/text.h"
#include "foilgauge/distribution.h"
#include "stats/regression_parts.h"

fg_status fg_regression_note(fg_context *ctx, fg_regression *regression, const char *format, ...) {
  va_list values;
  va_start(values, format);
  fg_status status = fg_notes_add(ctx, &regression->note, &regression->notes,
                                  &regression->note_capacity, format, values);
  va_end(values);
  return status;
}

fg_status fg_regression_predict(fg_context *ctx, const fg_regression *regression, const double *row,
                                fg_prediction *prediction) {
  size_t n = regression->columns;
  fg_extended mean = {0, 0}, length = {0, 0};
  if (!regression->inverse_root) return fg_fail(ctx, FG_ERR_USAGE, "nothing has been fitted");
  for (size_t j = 0; j < n; j++) {
    fg_extended sum = {0, 0};
    for (size_t i = 0; i < n; i++)
      sum = fg_extended_add(
          sum, fg_extended_multiply(fg_extended_of(row[i]), regression->inverse_root[i * n + j]));
    length = fg_extended_add(length, fg_extended_square(sum));
    mean = fg_extended_add(
        mean, fg_extended_multiply(fg_extended_of(row[j]), regression->estimate_extended[j]));
  }
  double sd = regression->residual_sd;
  double dof = (double)regression->residual_dof;
  double quantile = fg_distribution_t_quantile((1 + regression->confidence) / 2, dof);
  double standard_error = sd * sqrt(length.value), run = sd * sqrt(1 + length.value);
  *prediction = (fg_prediction){.mean = mean.value,
                                .standard_error = standard_error,
                                .run_standard_error = run,
                                .low = mean.value - quantile * standard_error,
                                .high = mean.value + quantile * standard_error,
                                .run_low = mean.value - quantile * run,
                                .run_high = mean.value + quantile * run,
                                .coverage_factor = quantile,
                                .dof = dof,
                                .run_dof = dof};
  return FG_OK;
}

static void free_rows(fg_anova_row *rows, size_t count) {
  for (size_t i = 0; rows && i < count; i++)
    free(rows[i].name);
  free(rows);
}

void fg_regression_free(fg_regression *r) {
  if (!r) return;
  for (size_t i = 0; r->coefficient && i < r->columns; i++)
    free(r->coefficient[i].name);
  for (size_t i = 0; r->alias && i < r->aliases; i++) {
    free(r->alias[i].with);
    free(r->alias[i].factor);
  }
  fg_notes_free(r->note, r->notes);
  free_rows(r->sequential, r->terms);
  free_rows(r->partial, r->terms);
  free(r->coefficient);
  free(r->alias);
  free(r->fitted);
  free(r->residual);
  free(r->leverage);
  free(r->internal);
  free(r->external);
  free(r->cook);
  free(r->estimate_extended);
  free(r->inverse_root);
  *r = (fg_regression){0};
}

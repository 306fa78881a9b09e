/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots of residuals, and of the runs with large leverage. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "foilgauge/distribution.h"
#include "report/doe/axes.h"
#include "report/doe/plots.h"

/* Returns a run's residual, externally studentised where that exists: in standard deviations. */
static double residual_of(const fg_experiment *e, size_t run, bool studentised) {
  return studentised ? e->regression.external[run] : e->regression.residual[run];
}

typedef struct scatter {
  const char *title, *x_title, *y_title;
  const double *x, *y;
  size_t count;
} scatter;

static void put_scatter(FILE *out, const scatter *s, bool zero) {
  double x[2] = {INFINITY, -INFINITY}, y[2] = {INFINITY, -INFINITY};
  size_t step = s->count / FG_DOE_POINTS_SHOWN + 1;
  for (size_t i = 0; i < s->count; i++) {
    fg_range_add(x, s->x[i], 0);
    fg_range_add(y, s->y[i], 0);
  }
  if (zero) fg_range_add(y, 0, 0);
  fg_plot at = fg_axes_begin(out, &(fg_plot_frame){s->title, .x = x, .y = y, .y_title = s->y_title,
                                                   .x_title = s->x_title});
  for (size_t i = 0; i < s->count; i += step)
    fg_axes_dot(&at, "s2", s->x[i], s->y[i], s->count > 200 ? 2 : 4.5);
  fg_axes_end(&at);
}

fg_status fg_doe_plot_residuals(fg_context *ctx, FILE *out, const fg_experiment_report *report) {
  const fg_experiment *e = report->experiment;
  size_t rows = e->regression.rows, finite = 0;
  bool studentised = true;
  double *x = NULL, *y = NULL;
  fg_status status = FG_OK;
  if (!e->regression.residual_dof) return FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, sizeof *x, (void **)&x));
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, sizeof *y, (void **)&y));
  for (size_t i = 0; i < rows; i++)
    studentised = studentised && isfinite(e->regression.external[i]);
  const char *name = studentised ? "studentised residual" : "residual";
  for (size_t i = 0; i < rows; i++)
    y[i] = residual_of(e, i, studentised);
  put_scatter(out,
              &(scatter){"Residual over fitted value", "fitted response", name,
                         e->regression.fitted, y, rows},
              true);
  for (size_t i = 0; i < rows; i++)
    x[i] = (double)(report->row ? report->row[i] : i + 1);
  if (e->has_order && e->order.column)
    put_scatter(out,
                &(scatter){"Residual over the order of the runs", e->order.column, name,
                           e->order.value, y, rows},
                true);
  else
    put_scatter(out, &(scatter){"Residual in the order of the sheet", "row", name, x, y, rows},
                true);
  put_scatter(
      out,
      &(scatter){"Influence of the runs", "row", "Cook's distance", x, e->regression.cook, rows},
      true);
  for (size_t i = 0; i < rows; i++)
    if (isfinite(y[i])) y[finite++] = y[i];
  fg_sort(y, finite);
  for (size_t i = 0; i < finite; i++)
    x[i] = fg_distribution_normal_quantile(((double)i + 0.5) / (double)finite);
  put_scatter(out, &(scatter){"Normal plot of residuals", "normal quantile", name, x, y, finite},
              true);
exit:
  free(x);
  free(y);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/table_loop/fitted.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "report/table_loop/panel.h"

static int by_place(const void *a, const void *b) {
  const fg_loop_point *p = a, *q = b;
  if (p->x != q->x) return p->x < q->x ? -1 : 1;
  return (p->y > q->y) - (p->y < q->y);
}

static void set_ordinate(const double *response, size_t rows, fg_loop_panel *panel) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < rows; i++) {
    low = fmin(low, fmin(response[i], panel->line[i].y));
    high = fmax(high, fmax(response[i], panel->line[i].y));
  }
  panel->middle = (low + high) / 2;
  panel->limit = high > low && isfinite(high - low) ? 1.08 * (high - low) / 2 : 1;
}

/* One value at every place is a curve; where other columns move it, each row has its own dash. */
static bool is_function(const fg_loop_panel *panel) {
  for (size_t i = 1; i < panel->points; i++)
    if (panel->line[i].x == panel->line[i - 1].x &&
        panel->line[i].y - panel->line[i - 1].y > 1e-6 * panel->limit)
      return false;
  return panel->points > 1;
}

/* Mean change from place to place, over the range: a curve is smooth. */
static bool is_smooth(const fg_loop_panel *panel) {
  double way = 0;
  for (size_t i = 1; i < panel->points; i++)
    way += fabs(panel->line[i].y - panel->line[i - 1].y);
  return way / (double)panel->points < 0.3 * panel->limit;
}

fg_status fg_loop_fitted_put(fg_context *ctx, FILE *out, const fg_loop_report *report,
                             const fg_loop_coordinate *at, const double *left) {
  const fg_loop_problem *problem = &report->problem->problem;
  fg_loop_panel panel = {.at = at,
                         .residual = problem->response,
                         .caption = "As measured, and as the model has it with all that was found"};
  if (!problem->response) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, problem->rows, sizeof *panel.line, (void **)&panel.line));
  for (size_t i = 0; i < problem->rows; i++)
    panel.line[i] = (fg_loop_point){at->value[i], problem->response[i] - left[i]};
  panel.points = problem->rows;
  fg_sort_items(panel.line, panel.points, sizeof *panel.line, by_place);
  set_ordinate(problem->response, problem->rows, &panel);
  panel.dashes = at->levels || !is_function(&panel) || !is_smooth(&panel);
  fg_status status = fg_loop_panel_put(ctx, out, report, &panel);
  free(panel.line);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The picture's grid, and where its points really lie. */
#include <math.h>

#include "core/memory.h"
#include "scan_loop/result.h"
#include "scan_loop/state.h"

enum { LINES_MAX = 140, SAMPLES = FG_SCAN_RESULT_GRID_SAMPLES - 1 };

static double largest(const fg_field_list *fields) {
  const fg_field_frame *f = &fields->frame;
  double size = 0;
  for (int i = 0; i <= SAMPLES; i++)
    for (int k = 0; k <= SAMPLES; k++) {
      fg_point at = {f->low_mm[0] + (f->high_mm[0] - f->low_mm[0]) * i / SAMPLES,
                     f->low_mm[1] + (f->high_mm[1] - f->low_mm[1]) * k / SAMPLES};
      fg_point d = fg_field_at(fields, at);
      size = fmax(size, hypot(d.x, d.y));
    }
  return size;
}

static double shortest_period(const fg_effect_set *set) {
  double period = INFINITY;
  for (size_t e = 0; e < set->count; e++)
    if (set->effects[e].kind->numbers == FG_EFFECT_WAVE)
      period = fmin(period, set->effects[e].shape[0]);
  return period;
}

/* Lines of a grid one cell apart; a ripple needs several lines in each period to be seen. */
static int lines_along(const fg_scan_result_grid *grid, int axis) {
  double range = grid->high_mm[axis] - grid->low_mm[axis], lines = range / grid->cell_mm;
  if (axis == 1) lines = fmax(lines, 6 * range / grid->period_mm);
  return (int)fmin(LINES_MAX, fmax(4, ceil(lines)));
}

static void fill_grid_line(const fg_field_list *fields, int axis, double across,
                           fg_scan_result_grid_line *line) {
  const fg_field_frame *f = &fields->frame;
  int along = 1 - axis;
  line->axis = axis;
  for (int i = 0; i <= SAMPLES; i++) {
    double at[2];
    at[axis] = across;
    at[along] = f->low_mm[along] + (f->high_mm[along] - f->low_mm[along]) * i / SAMPLES;
    line->at_mm[i] = (fg_point){at[0], at[1]};
    line->move_mm[i] = fg_field_at(fields, line->at_mm[i]);
  }
}

fg_status fg_scan_result_put_grid(fg_context *ctx, const fg_scan_loop *loop,
                                  fg_scan_result *result) {
  fg_scan_result_grid *grid = &result->grid;
  fg_field_list fields;
  fg_effect_set_fields(&loop->edge_fit, &loop->set, &fields);
  const fg_field_frame *f = &fields.frame;
  double width = f->high_mm[0] - f->low_mm[0], height = f->high_mm[1] - f->low_mm[1];
  if (!fields.count) return FG_OK;
  *grid = (fg_scan_result_grid){.low_mm = {f->low_mm[0], f->low_mm[1]},
                                .high_mm = {f->high_mm[0], f->high_mm[1]},
                                .cell_mm = fmax(width, height) / 14,
                                .largest_mm = largest(&fields),
                                .period_mm = shortest_period(&loop->set)};
  if (!(grid->largest_mm > 0) || !(width > 0) || !(height > 0)) return FG_OK;
  int count[2] = {lines_along(grid, 0), lines_along(grid, 1)};
  FG_TRY(fg_memory_allocate(ctx, (size_t)(count[0] + count[1] + 2), sizeof *grid->line,
                            (void **)&grid->line));
  for (int axis = 0; axis < 2; axis++)
    for (int i = 0; i <= count[axis]; i++)
      fill_grid_line(&fields, axis, f->low_mm[axis] + (axis ? height : width) * i / count[axis],
                     &grid->line[grid->lines++]);
  return FG_OK;
}

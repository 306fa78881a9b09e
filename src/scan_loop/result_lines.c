/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects as lines over their coordinates. Effects on one coordinate may cancel each other in part,
 * so their sum is drawn. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "effect/columns.h"
#include "foilgauge/report.h"
#include "scan_loop/result.h"
#include "scan_loop/state.h"
#include "table_loop/engine.h"

enum { SAMPLES = FG_SCAN_RESULT_SAMPLES };

typedef fg_scan_result_line drawn_line;

static fg_point field_at(const fg_field *field, const fg_field_frame *frame, int axis, double t) {
  fg_field_list one = {.frame = *frame, .fields = {*field}, .count = 1};
  fg_point at = {frame->centre_mm[0], frame->centre_mm[1]};
  if (axis == 0)
    at.x = frame->low_mm[0] + t * (frame->high_mm[0] - frame->low_mm[0]);
  else
    at.y = frame->low_mm[1] + t * (frame->high_mm[1] - frame->low_mm[1]);
  return fg_field_at(&one, at);
}

/* Every field of the table runs over one axis of the scan: the one along which it changes. */
static int axis_of(const fg_field *field, const fg_field_frame *frame) {
  double change[2] = {0, 0};
  for (int axis = 0; axis < 2; axis++)
    for (int i = 0; i < SAMPLES; i++) {
      fg_point a = field_at(field, frame, axis, 0);
      fg_point b = field_at(field, frame, axis, (double)i / (SAMPLES - 1));
      change[axis] = fmax(change[axis], hypot(b.x - a.x, b.y - a.y));
    }
  return change[0] > change[1] ? 0 : 1;
}

static void put_expanded(const fg_field *field, const fg_field_frame *frame, int axis,
                         drawn_line *line) {
  for (int i = 0; i < SAMPLES; i++) {
    double square = 0;
    for (size_t c = 0; c < field->columns; c++) {
      fg_field one = *field;
      memset(one.amplitude_mm, 0, sizeof one.amplitude_mm);
      one.amplitude_mm[c] = field->u_amplitude_mm[c];
      fg_point d = field_at(&one, frame, axis, (double)i / (SAMPLES - 1));
      square += pow(1000 * (line->axis == 'y' ? d.y : d.x), 2);
    }
    line->expanded_um[i] = FG_COVERAGE_FACTOR * sqrt(square);
  }
}

/* Sums the fields on one axis and direction; returns their number. The columns of a free curve are
 * correlated, so its uncertainty is not computed from them one by one. */
static size_t sum_fields(const fg_field_list *list, int axis, drawn_line *line) {
  const fg_field_frame *frame = &list->frame;
  size_t count = 0;
  for (int i = 0; i < SAMPLES; i++) {
    double t = (double)i / (SAMPLES - 1);
    line->x[i] = frame->low_mm[axis] + t * (frame->high_mm[axis] - frame->low_mm[axis]);
    line->um[i] = 0;
    line->expanded_um[i] = NAN;
  }
  for (size_t f = 0; f < list->count; f++) {
    const fg_field *field = &list->fields[f];
    double size = 0;
    if (axis_of(field, frame) != axis) continue;
    for (int i = 0; i < SAMPLES; i++) {
      fg_point d = field_at(field, frame, axis, (double)i / (SAMPLES - 1));
      double value = 1000 * (line->axis == 'y' ? d.y : d.x);
      line->um[i] += value;
      size = fmax(size, fabs(value));
    }
    if (!(size > 0)) continue;
    if (!count++ && !fg_effect_is_free(fg_effect_find(field->id)))
      put_expanded(field, frame, axis, line);
  }
  for (int i = 0; i < SAMPLES && count > 1; i++)
    line->expanded_um[i] = NAN;
  return count;
}

/* ---- the part ---- */

static bool row_place(const fg_edge_fit_row *row, fg_effect_coordinate coordinate, double *x) {
  double degrees = 180 / M_PI;
  *x = coordinate == FG_EFFECT_PHI      ? row->phi
       : coordinate == FG_EFFECT_INDEX  ? fg_edge_fit_along_bumps(row)
       : coordinate == FG_EFFECT_NORMAL ? row->normal_rad * degrees
                                        : row->psi * degrees;
  return (coordinate != FG_EFFECT_PHI && coordinate != FG_EFFECT_INDEX) || row->bump;
}

/* Returns the share of a row. Rows are measured along the normal of their own arc, which on a bump
 * points to the shaft; over the foil the deviation is reported outward, in the direction of the
 * effect's basis. */
static double share_of(const fg_edge_fit_row *row, fg_effect_coordinate coordinate,
                       const char *direction) {
  double along = row->radial.x * row->normal.x + row->radial.y * row->normal.y;
  if (coordinate != FG_EFFECT_FOIL) return 1;
  return direction && !strcmp(direction, "radial") ? along : along < 0 ? -1 : 1;
}

/* Adds an effect to the bins; with `n` the bins count their rows. */
static size_t add_effect(const fg_edge_fit *edge_fit, const fg_effect_found *effect,
                         fg_effect_coordinate coordinate, const double range[2], double *columns,
                         drawn_line *line, double *n) {
  size_t filled = fg_effect_columns(edge_fit, effect->kind, effect->shape, columns);
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    double x;
    if (!row_place(&edge_fit->rows[i], coordinate, &x)) continue;
    double share = share_of(&edge_fit->rows[i], coordinate, effect->kind->direction);
    size_t bin = (size_t)fmin(SAMPLES - 1, (x - range[0]) / (range[1] - range[0]) * SAMPLES);
    for (size_t c = 0; c < filled; c++)
      line->um[bin] += effect->coefficient_um[c] * columns[c * edge_fit->row_count + i] / share;
    if (n) n[bin] += filled > 0;
  }
  return filled;
}

/* Sum of the part's effects on one coordinate, from their columns at the rows, in bins. */
static fg_status sum_parts(fg_context *ctx, const fg_scan_loop *loop,
                           fg_effect_coordinate coordinate, drawn_line *line, size_t *count) {
  const fg_edge_fit *edge_fit = &loop->edge_fit;
  double *columns = NULL, n[SAMPLES] = {0}, range[2] = {INFINITY, -INFINITY}, x;
  *count = 0;
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    if (!row_place(&edge_fit->rows[i], coordinate, &x)) continue;
    range[0] = fmin(range[0], x);
    range[1] = fmax(range[1], x);
  }
  if (!(range[1] > range[0])) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, edge_fit->row_count, FG_EFFECT_COLUMNS_MAX * sizeof *columns,
                            (void **)&columns));
  for (size_t e = 0; e < loop->set.count; e++) {
    const fg_effect_found *effect = &loop->set.effects[e];
    if (effect->kind->glass || effect->kind->coordinate != coordinate) continue;
    *count += add_effect(edge_fit, effect, coordinate, range, columns, line, *count ? NULL : n) > 0;
  }
  for (int i = 0; i < SAMPLES; i++) {
    line->x[i] = range[0] + (i + 0.5) * (range[1] - range[0]) / SAMPLES;
    line->um[i] /= n[i];
    line->expanded_um[i] = NAN;
  }
  free(columns);
  return FG_OK;
}

/* Removes from a free curve the part that circles absorb: the bump's own, or the overall circle
 * with its centre. */
static void remove_circles(fg_effect_coordinate coordinate, drawn_line *line) {
  double columns[3 * SAMPLES], basis[3 * SAMPLES], d[SAMPLES];
  size_t n = 0, at[SAMPLES];
  for (size_t i = 0; i < SAMPLES; i++)
    if (isfinite(line->um[i])) at[n++] = i;
  for (size_t k = 0; k < n; k++) {
    double x = line->x[at[k]], angle = x * M_PI / 180;
    columns[k] = 1;
    columns[n + k] = coordinate == FG_EFFECT_PHI ? x : cos(angle);
    columns[2 * n + k] = coordinate == FG_EFFECT_PHI ? x * x : sin(angle);
    d[k] = line->um[at[k]];
  }
  size_t rank = fg_engine_orthonormal(n, NULL, 0, columns, 3, basis, NULL);
  fg_engine_project_out(n, basis, rank, d);
  for (size_t k = 0; k < n; k++)
    line->um[at[k]] = d[k];
}

/* Bridges gaps of a few bins; wider ones stay, because no edge has these directions. */
static void bridge_gaps(drawn_line *line) {
  enum { WIDEST = 12 };
  size_t last = SAMPLES;
  for (size_t i = 0; i < SAMPLES; i++) {
    if (!isfinite(line->um[i])) continue;
    for (size_t k = last + 1; last < SAMPLES && i - last <= WIDEST && k < i; k++)
      line->um[k] =
          line->um[last] + (line->um[i] - line->um[last]) * (double)(k - last) / (double)(i - last);
    last = i;
  }
}

static bool has_free(const fg_effect_set *set, fg_effect_coordinate coordinate) {
  for (size_t e = 0; e < set->count; e++) {
    const fg_effect *kind = set->effects[e].kind;
    if (fg_effect_is_free(kind) && !kind->glass && kind->coordinate == coordinate) return true;
  }
  return false;
}

static fg_status fill_part_line(fg_context *ctx, const fg_scan_loop *loop,
                                fg_effect_coordinate coordinate, fg_scan_result *result) {
  drawn_line *line = &result->line[result->lines];
  size_t count;
  *line = (drawn_line){0};
  FG_TRY(sum_parts(ctx, loop, coordinate, line, &count));
  if (!count) return FG_OK;
  line->coordinate = (fg_scan_coordinate)coordinate;
  line->free = has_free(&loop->set, coordinate);
  /* Effects of single bumps are relative to their circles already. */
  if (line->free && coordinate != FG_EFFECT_NORMAL && coordinate != FG_EFFECT_INDEX)
    remove_circles(coordinate, line);
  bridge_gaps(line);
  result->lines++;
  return FG_OK;
}

fg_status fg_scan_result_put_lines(fg_context *ctx, const fg_scan_loop *loop,
                                   fg_scan_result *result) {
  enum { LINES = 2 * 2 + FG_EFFECT_COORDINATES - FG_EFFECT_FOIL };
  fg_field_list fields;
  if (!loop->set.count) return FG_OK;
  fg_effect_set_fields(&loop->edge_fit, &loop->set, &fields);
  /* One more: a place to try the next one in. */
  FG_TRY(fg_memory_allocate(ctx, LINES + 1, sizeof *result->line, (void **)&result->line));
  for (int axis = 0; axis < 2; axis++)
    for (int direction = 0; direction < 2; direction++) {
      drawn_line *line = &result->line[result->lines];
      *line = (drawn_line){
          .coordinate = axis ? FG_SCAN_Y : FG_SCAN_X, .glass = true, .axis = direction ? 'y' : 'x'};
      if (!sum_fields(&fields, axis, line)) continue;
      bridge_gaps(line);
      result->lines++;
    }
  for (int c = FG_EFFECT_FOIL; c < FG_EFFECT_COORDINATES; c++)
    FG_TRY(fill_part_line(ctx, loop, (fg_effect_coordinate)c, result));
  return FG_OK;
}

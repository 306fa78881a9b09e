/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainty of every value by that of the model. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "quantity/quantity_rows.h"
#include "scan_loop/scanner_model.h"
#include "scan_loop/state.h"

/* Calls for every measured object of `m` in turn, with the same of `other`; NULL where it has none.
 */
typedef void visitor(fg_quantity_owner owner, void *object, const void *same, void *user);

static void visit_all(fg_measurement *m, const fg_measurement *other, visitor *visit, void *user) {
  for (size_t f = 0; f < m->foil_count; f++) {
    fg_foil *foil = &m->foils[f];
    const fg_foil *same = other && f < other->foil_count ? &other->foils[f] : NULL;
    if (same && same->bump_count != foil->bump_count) same = NULL;
    visit(FG_QUANTITY_OF_FOIL, foil, same, user);
    for (size_t b = 0; b < foil->bump_count; b++)
      visit(FG_QUANTITY_OF_BUMP, &foil->bumps[b], same ? &same->bumps[b] : NULL, user);
  }
  for (size_t d = 0; d < m->disc_count; d++)
    visit(FG_QUANTITY_OF_DISC, &m->discs[d],
          other && d < other->disc_count ? &other->discs[d] : NULL, user);
}

/* Displacement of every value that has an uncertainty, in the visits' order. */
typedef struct moves {
  double *each; /* NULL: only counted */
  size_t at;
  double share;
} moves;

static void take_moves(fg_quantity_owner owner, void *object, const void *same, void *user) {
  moves *m = user;
  if (m->each && same) fg_quantity_keep_farthest(owner, object, same, m->each + m->at);
  m->at += fg_quantity_moves(owner);
}

static void widen_value_u(fg_quantity_owner owner, void *object, const void *same, void *user) {
  moves *m = user;
  (void)same;
  fg_quantity_widen(owner, object, m->each + m->at, m->share);
  m->at += fg_quantity_moves(owner);
}

static fg_status find_moves(fg_context *ctx, fg_measurement *from, const fg_measurement *to,
                            double **each) {
  moves all = {.each = NULL};
  visit_all(from, NULL, take_moves, &all);
  FG_TRY(fg_memory_allocate(ctx, all.at, sizeof **each, (void **)each));
  all = (moves){.each = *each};
  visit_all(from, to, take_moves, &all);
  return FG_OK;
}

static void add_moves(fg_measurement *m, double *each, double share) {
  visit_all(m, NULL, widen_value_u, &(moves){.each = each, .share = share});
}

static size_t number_count(const fg_field *field) {
  return field->columns + field->shapes;
}

/* Moves the k-th number by its uncertainty; false where it has none. */
static bool move_number(fg_field *field, size_t k) {
  size_t columns = field->columns;
  double u = k < columns ? field->u_amplitude_mm[k] : field->u_shape[k - columns];
  *(k < columns ? &field->amplitude_mm[k] : &field->shape[k - columns]) += u;
  return u > 0;
}

/* Measures `own` again with one number of the model displaced. */
static fg_status step_number(fg_context *ctx, const fg_field_list *fields, const fg_measurement *m,
                             unsigned threads, fg_model_uncertainty *uncertainty) {
  fg_measurement other;
  FG_TRY(fg_scan_loop_correct(ctx, m, fields, threads, &other));
  fg_benefits_add_step(&uncertainty->benefits, &uncertainty->each[0], &other);
  fg_status status =
      find_moves(ctx, &uncertainty->each[0], &other, &uncertainty->step[uncertainty->steps]);
  if (other.grid && uncertainty->each[0].grid)
    uncertainty->grid_step[uncertainty->steps] =
        fg_grid_find_moves(uncertainty->each[0].grid, other.grid);
  fg_measurement_free(&other);
  if (status == FG_OK) uncertainty->steps++;
  return status;
}

static fg_status step_all(fg_context *ctx, const fg_field_list *fields, const fg_measurement *m,
                          unsigned threads, fg_model_uncertainty *uncertainty) {
  for (size_t f = 0; f < fields->count; f++)
    for (size_t c = 0; c < number_count(&fields->fields[f]); c++) {
      fg_field_list moved = *fields;
      if (!move_number(&moved.fields[f], c)) continue;
      FG_TRY(step_number(ctx, &moved, m, threads, uncertainty));
    }
  return FG_OK;
}

/* Displaces the map by each of its modes. */
static fg_status step_modes(fg_context *ctx, const fg_scanner_model *model, const fg_measurement *m,
                            unsigned threads, fg_model_uncertainty *uncertainty) {
  size_t numbers = 2 * fg_map_splines(&model->map.frame);
  double *mm;
  fg_field_list moved = model->fields;
  if (!model->fields.map) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, numbers, sizeof *mm, (void **)&mm));
  fg_status status = FG_OK;
  moved.map_mm = mm;
  for (size_t k = 0; k < model->map.mode_count && status == FG_OK; k++) {
    for (size_t i = 0; i < numbers; i++)
      mm[i] = model->map.mm[i] + model->map.modes[k][i];
    status = step_number(ctx, &moved, m, threads, uncertainty);
  }
  free(mm);
  return status;
}

/* ---- beyond the region of a map ---- */

enum { SIDES = 4, BORDER_POINTS = 21 };

/* Side `side` of a region: its axis, and the way out of the region along it. */
static int axis_of_side(int side) {
  return side / 2;
}

static double border_of_side(const double low_mm[2], const double high_mm[2], int side) {
  return side % 2 ? high_mm[axis_of_side(side)] : low_mm[axis_of_side(side)];
}

static double way_out(int side) {
  return side % 2 ? 1 : -1;
}

/* Bounds of all parts. */
static void find_bounds(const fg_measurement *m, double low[2], double high[2]) {
  for (int axis = 0; axis < 2; axis++) {
    low[axis] = INFINITY;
    high[axis] = -INFINITY;
    for (size_t f = 0; f < m->foil_count; f++) {
      const double *place = m->foils[f].place_mm;
      low[axis] = fmin(low[axis], place[axis]);
      high[axis] = fmax(high[axis], place[axis] + place[2 + axis]);
    }
    for (size_t d = 0; d < m->disc_count; d++) {
      fg_point c = m->discs[d].centre_mm;
      double at = axis ? c.y : c.x, r = m->discs[d].radius_mm;
      low[axis] = fmin(low[axis], at - r);
      high[axis] = fmax(high[axis], at + r);
    }
    for (size_t k = 0; m->grid && k < m->grid->count; k++) {
      double at = axis ? m->grid->marks[k].at_mm.y : m->grid->marks[k].at_mm.x;
      low[axis] = fmin(low[axis], at);
      high[axis] = fmax(high[axis], at);
    }
  }
}

/* Share of the way from a border, shape[0], to shape[1]; both components. */
static void beyond_border(int axis, const double *shape, fg_point at, fg_point *d) {
  double share = fmax(0, ((axis ? at.y : at.x) - shape[0]) / (shape[1] - shape[0]));
  d[0] = (fg_point){share, 0};
  d[1] = (fg_point){0, share};
}

static void beyond_border_x(const fg_field_frame *frame, const double *shape, fg_point at,
                            fg_point *d) {
  (void)frame;
  beyond_border(0, shape, at, d);
}

static void beyond_border_y(const fg_field_frame *frame, const double *shape, fg_point at,
                            fg_point *d) {
  (void)frame;
  beyond_border(1, shape, at, d);
}

/* Root mean square change of the map, x and y, from a border inwards by a distance. */
static void find_change_at_border(const fg_scanner_model *model, int side, double distance,
                                  double change[2]) {
  const fg_map_frame *frame = &model->map.frame;
  int axis = axis_of_side(side);
  double length = frame->high_mm[axis] - frame->low_mm[axis];
  double square[2] = {0, 0}, inwards = -way_out(side) * fmin(distance, 0.5 * length);
  for (int i = 0; i < BORDER_POINTS; i++) {
    double at[2], share = i / (BORDER_POINTS - 1.0);
    at[axis] = border_of_side(frame->low_mm, frame->high_mm, side);
    at[!axis] = frame->low_mm[!axis] + share * (frame->high_mm[!axis] - frame->low_mm[!axis]);
    fg_point border = fg_map_at(frame, model->map.mm, (fg_point){at[0], at[1]});
    at[axis] += inwards;
    fg_point inside = fg_map_at(frame, model->map.mm, (fg_point){at[0], at[1]});
    square[0] += pow(border.x - inside.x, 2);
    square[1] += pow(border.y - inside.y, 2);
  }
  for (int k = 0; k < 2; k++)
    change[k] = sqrt(square[k] / BORDER_POINTS) * fmax(1, distance / (0.5 * length));
}

/* Beyond its region a map keeps the border's value. It may change there as much as it does over the
 * same distance inside. */
static fg_status step_beyond(fg_context *ctx, const fg_scanner_model *model,
                             const fg_measurement *m, unsigned threads,
                             fg_model_uncertainty *uncertainty) {
  double low[2], high[2];
  const fg_map_frame *frame = &model->map.frame;
  if (!model->fields.map) return FG_OK;
  find_bounds(m, low, high);
  for (int side = 0; side < SIDES; side++) {
    double border = border_of_side(frame->low_mm, frame->high_mm, side);
    double end = border_of_side(low, high, side), change[2];
    double distance = way_out(side) * (end - border);
    if (!(distance > 0) || model->fields.count == FG_FIELDS_MAX) continue;
    find_change_at_border(model, side, distance, change);
    for (int k = 0; k < 2; k++) {
      fg_field_list moved = model->fields;
      fg_field *field = &moved.fields[moved.count++];
      *field = (fg_field){.id = "beyond",
                          .basis = axis_of_side(side) ? beyond_border_y : beyond_border_x,
                          .columns = 2,
                          .shape = {border, end}};
      field->amplitude_mm[k] = change[k];
      FG_TRY(step_number(ctx, &moved, m, threads, uncertainty));
    }
  }
  return FG_OK;
}

static fg_status explain(fg_context *ctx, const fg_field_list *fields, const fg_measurement *m,
                         unsigned threads, fg_model_uncertainty *uncertainty) {
  FG_TRY(fg_scan_loop_correct(ctx, m, fields, threads, &uncertainty->each[uncertainty->count]));
  fg_benefits_add(&uncertainty->benefits, m, &uncertainty->each[uncertainty->count++]);
  return FG_OK;
}

static void weigh(const fg_scanner_model *model, fg_benefits *benefits) {
  fg_benefit_weights weights = {.weight = model->weight, .count = model->weights};
  for (size_t f = 0; f < model->fields.count; f++) {
    const fg_effect *effect = fg_effect_find(model->fields.fields[f].id);
    weights.curve = weights.curve || (effect && fg_effect_is_free(effect));
    weights.loose = weights.loose || (effect && effect->loose);
  }
  fg_benefits_weigh(benefits, &weights);
}

fg_status fg_model_uncertainty_open(fg_context *ctx, const fg_scanner_model *model,
                                    const fg_measurement *m, unsigned threads,
                                    fg_model_uncertainty *uncertainty) {
  fg_status status = FG_OK;
  *uncertainty = (fg_model_uncertainty){.model = model};
  FG_TRY_EXIT(fg_benefits_open(ctx, m, &uncertainty->benefits));
  if (model->weights) weigh(model, &uncertainty->benefits);
  FG_TRY_EXIT(explain(ctx, &model->fields, m, threads, uncertainty));
  FG_TRY_EXIT(step_all(ctx, &model->fields, m, threads, uncertainty));
  FG_TRY_EXIT(step_modes(ctx, model, m, threads, uncertainty));
  FG_TRY_EXIT(step_beyond(ctx, model, m, threads, uncertainty));
  for (size_t k = 0; k < model->others; k++)
    FG_TRY_EXIT(explain(ctx, &model->other[k], m, threads, uncertainty));
exit:
  if (status != FG_OK) fg_model_uncertainty_close(uncertainty);
  return status;
}

void fg_model_uncertainty_close(fg_model_uncertainty *uncertainty) {
  for (size_t k = 0; k < uncertainty->count; k++)
    fg_measurement_free(&uncertainty->each[k]);
  for (size_t k = 0; k < uncertainty->steps; k++)
    free(uncertainty->step[k]);
  fg_benefits_close(&uncertainty->benefits);
  *uncertainty = (fg_model_uncertainty){.model = NULL};
}

/* Widens a grid's lattice by all numbers of the model, and by the explanations tied with it. */
static void widen_grid(const fg_model_uncertainty *uncertainty, fg_grid *grid) {
  const fg_grid kept = *grid;
  for (size_t k = 0; k < uncertainty->steps; k++)
    fg_grid_widen(grid, &uncertainty->grid_step[k], 1);
  for (size_t k = 1; k < uncertainty->count; k++) {
    const fg_grid_moves by_tie = fg_grid_find_moves(&kept, uncertainty->each[k].grid);
    fg_grid_widen(grid, &by_tie, sqrt(fg_scanner_model_weight(uncertainty->model, k)));
  }
}

fg_status fg_model_uncertainty_widen(fg_context *ctx, const fg_model_uncertainty *uncertainty,
                                     fg_measurement *kept) {
  if (kept->grid) widen_grid(uncertainty, kept->grid);
  for (size_t k = 0; k < uncertainty->steps; k++)
    add_moves(kept, uncertainty->step[k], 1);
  for (size_t k = 0; k < uncertainty->count; k++) {
    double *each = NULL;
    FG_TRY(find_moves(ctx, kept, &uncertainty->each[k], &each));
    add_moves(kept, each, sqrt(fg_scanner_model_weight(uncertainty->model, k)));
    free(each);
  }
  return FG_OK;
}

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

static fg_status explain(fg_context *ctx, const fg_field_list *fields, const fg_measurement *m,
                         unsigned threads, fg_model_uncertainty *uncertainty) {
  FG_TRY(fg_scan_loop_correct(ctx, m, fields, threads, &uncertainty->each[uncertainty->count]));
  fg_benefits_add(&uncertainty->benefits, m, &uncertainty->each[uncertainty->count++]);
  return FG_OK;
}

fg_status fg_model_uncertainty_open(fg_context *ctx, const fg_scanner_model *model,
                                    const fg_measurement *m, unsigned threads,
                                    fg_model_uncertainty *uncertainty) {
  fg_status status = FG_OK;
  *uncertainty = (fg_model_uncertainty){.count = 0};
  FG_TRY_EXIT(fg_benefits_open(ctx, m, &uncertainty->benefits));
  FG_TRY_EXIT(explain(ctx, &model->fields, m, threads, uncertainty));
  FG_TRY_EXIT(step_all(ctx, &model->fields, m, threads, uncertainty));
  FG_TRY_EXIT(step_modes(ctx, model, m, threads, uncertainty));
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
  *uncertainty = (fg_model_uncertainty){.count = 0};
}

/* Widens a grid's lattice by all numbers of the model, and by the explanations tied with it. */
static void widen_grid(const fg_model_uncertainty *uncertainty, fg_grid *grid) {
  const fg_grid kept = *grid;
  for (size_t k = 0; k < uncertainty->steps; k++)
    fg_grid_widen(grid, &uncertainty->grid_step[k], 1);
  for (size_t k = 1; k < uncertainty->count; k++) {
    const fg_grid_moves by_tie = fg_grid_find_moves(&kept, uncertainty->each[k].grid);
    fg_grid_widen(grid, &by_tie, 1 / sqrt((double)uncertainty->count));
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
    add_moves(kept, each, 1 / sqrt((double)uncertainty->count));
    free(each);
  }
  return FG_OK;
}

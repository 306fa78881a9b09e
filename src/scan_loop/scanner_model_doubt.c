/* What the model does not know makes every value less certain. */
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

/* The farthest that each value is moved over several visits, in the visits' order. */
typedef struct moves {
  double *farthest; /* NULL: only counted */
  size_t at;
  double share;
} moves;

static void take_moves(fg_quantity_owner owner, void *object, const void *same, void *user) {
  moves *m = user;
  if (m->farthest && same) fg_quantity_take_moves(owner, object, same, m->farthest + m->at);
  m->at += fg_quantity_moves(owner);
}

static void widen(fg_quantity_owner owner, void *object, const void *same, void *user) {
  moves *m = user;
  (void)same;
  fg_quantity_widen(owner, object, m->farthest + m->at, m->share);
  m->at += fg_quantity_moves(owner);
}

/* Adds to every u_ of `m` the farthest that its value is moved by the others, times `share`. */
static fg_status widen_by(fg_context *ctx, const fg_measurement *others, size_t other_count,
                          double share, fg_measurement *m) {
  moves all = {.share = share};
  visit_all(m, NULL, take_moves, &all);
  FG_TRY(fg_memory_allocate(ctx, all.at, sizeof *all.farthest, (void **)&all.farthest));
  for (size_t o = 0; o < other_count; o++) {
    all.at = 0;
    visit_all(m, &others[o], take_moves, &all);
  }
  all.at = 0;
  visit_all(m, NULL, widen, &all);
  free(all.farthest);
  return FG_OK;
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

fg_status fg_scanner_model_widen(fg_context *ctx, const fg_scanner_model *model,
                                 const fg_measurement *m, unsigned threads,
                                 fg_measurement *corrected) {
  for (size_t f = 0; f < model->fields.count; f++)
    for (size_t c = 0; c < number_count(&model->fields.fields[f]); c++) {
      fg_field_list moved = model->fields;
      fg_measurement other;
      if (!move_number(&moved.fields[f], c)) continue;
      FG_TRY(fg_scan_loop_correct(ctx, m, &moved, threads, &other));
      fg_status status = widen_by(ctx, &other, 1, 1, corrected);
      fg_measurement_free(&other);
      FG_TRY(status);
    }
  return FG_OK;
}

fg_status fg_scanner_model_widen_tie(fg_context *ctx, const fg_scanner_model *model,
                                     const fg_measurement *m, unsigned threads,
                                     fg_measurement *corrected) {
  fg_measurement others[FG_EXPLANATIONS_MAX];
  fg_status status = FG_OK;
  size_t count = 0;
  while (count < model->others && status == FG_OK) {
    status = fg_scan_loop_correct(ctx, m, &model->other[count], threads, &others[count]);
    if (status == FG_OK) count++;
  }
  if (status == FG_OK) status = widen_by(ctx, others, count, 1 / sqrt(3), corrected);
  for (size_t o = 0; o < count; o++)
    fg_measurement_free(&others[o]);
  return status;
}

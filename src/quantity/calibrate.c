/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainty of every value by a calibration. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/measure.h"
#include "foilgauge/traceability.h"
#include "measure/again.h"
#include "quantity/quantity_rows.h"

/* Relative stretch of the edges; their moves are proportional to it. Large beside the rounding of a
 * fit, small enough to be linear (within a thousandth). */
static const double step = 1e-3;

static void add_moves(fg_quantity_owner owner, const void *from, const void *to, double share,
                      double *move) {
  memset(move, 0, FG_CALIBRATED_MAX * sizeof *move);
  fg_quantity_keep_farthest(owner, from, to, move);
  for (size_t k = 0; k < fg_quantity_moves(owner); k++)
    move[k] *= share;
}

static const fg_bump *bump_of(const fg_foil *foil, int number) {
  for (size_t b = 0; b < foil->bump_count; b++)
    if (foil->bumps[b].number == number) return &foil->bumps[b];
  return NULL;
}

static const char lost[] = "its edges, stretched by a thousandth, are not the same foil: what the "
                           "calibration does not know cannot be told";

static void give_up(fg_foil *foil) {
  fg_foil_give_up(foil, lost);
  foil->bump_count = 0;
}

static const fg_beam *beam_of(const fg_foil *foil, int number) {
  for (size_t b = 0; b < foil->beam_count; b++)
    if (foil->beams[b].number == number) return &foil->beams[b];
  return NULL;
}

static void add_beam_moves(const fg_foil *from, const fg_foil *to, double share, size_t source,
                           fg_foil *foil) {
  for (size_t b = 0; b < foil->beam_count; b++) {
    fg_beam *beam = &foil->beams[b];
    const fg_beam *here = beam_of(from, beam->number), *there = beam_of(to, beam->number);
    if (here && there)
      add_moves(FG_QUANTITY_OF_BEAM, here, there, share, beam->calibrated.move[source]);
  }
}

static bool is_lost(double value, const double *here, const double *there) {
  return isfinite(value) && !(here && there && isfinite(*there - *here));
}

static void add_foil_moves(const fg_foil *from, const fg_foil *to, double share, size_t source,
                           fg_foil *foil) {
  if (foil->flags & FG_FOIL_NOT_MEASURED) return;
  add_beam_moves(from, to, share, source, foil);
  if (is_lost(foil->overall.radius_mm, &from->overall.radius_mm, &to->overall.radius_mm)) {
    give_up(foil);
    return;
  }
  add_moves(FG_QUANTITY_OF_FOIL, from, to, share, foil->calibrated.move[source]);
  for (size_t b = 0; b < foil->bump_count; b++) {
    fg_bump *bump = &foil->bumps[b];
    const fg_bump *here = bump_of(from, bump->number), *there = bump_of(to, bump->number);
    if (is_lost(bump->radius_mm, here ? &here->radius_mm : NULL,
                there ? &there->radius_mm : NULL)) {
      give_up(foil);
      return;
    }
    if (here && there)
      add_moves(FG_QUANTITY_OF_BUMP, here, there, share, bump->calibrated.move[source]);
  }
}

static void add_all_moves(const fg_measurement *from, const fg_measurement *to, double share,
                          size_t source, fg_measurement *m) {
  for (size_t f = 0; f < m->foil_count; f++)
    add_foil_moves(&from->foils[f], &to->foils[f], share, source, &m->foils[f]);
  for (size_t d = 0; d < m->disc_count; d++)
    add_moves(FG_QUANTITY_OF_DISC, &from->discs[d], &to->discs[d], share,
              m->discs[d].calibrated.move[source]);
}

void fg_quantity_widen_calibrated(fg_quantity_owner owner, void *object,
                                  const fg_calibrated *calibrated) {
  for (size_t s = 0; s < FG_CALIBRATION_SOURCES; s++)
    fg_quantity_widen(owner, object, calibrated->move[s], 1);
}

static void widen_all(fg_measurement *m) {
  for (size_t f = 0; f < m->foil_count; f++) {
    fg_foil *foil = &m->foils[f];
    fg_quantity_widen_calibrated(FG_QUANTITY_OF_FOIL, foil, &foil->calibrated);
    for (size_t b = 0; b < foil->bump_count; b++)
      fg_quantity_widen_calibrated(FG_QUANTITY_OF_BUMP, &foil->bumps[b],
                                   &foil->bumps[b].calibrated);
    for (size_t b = 0; b < foil->beam_count; b++)
      fg_quantity_widen_calibrated(FG_QUANTITY_OF_BEAM, &foil->beams[b],
                                   &foil->beams[b].calibrated);
  }
  for (size_t d = 0; d < m->disc_count; d++)
    fg_quantity_widen_calibrated(FG_QUANTITY_OF_DISC, &m->discs[d], &m->discs[d].calibrated);
}

static fg_status find_source(fg_context *ctx, const fg_measurement *same, const double stretch[2],
                             size_t source, unsigned threads, fg_measurement *m) {
  double max = fmax(fabs(stretch[0]), fabs(stretch[1])), share = max / step;
  fg_measurement other;
  if (max == 0) return FG_OK;
  const double factor[2] = {1 + stretch[0] / share, 1 + stretch[1] / share};
  FG_TRY(fg_measure_stretched(ctx, m, factor, threads, &other));
  add_all_moves(same, &other, share, source, m);
  if (m->grid) {
    fg_grid_moves by_stretch = fg_grid_find_moves(same->grid, other.grid);
    by_stretch.residual_mm2 = 0; /* that is of a scanner's model */
    fg_grid_widen(m->grid, &by_stretch, share);
  }
  fg_measurement_free(&other);
  return FG_OK;
}

static fg_status check_due(fg_context *ctx, const fg_measurement *m) {
  const fg_calibration *c = &m->design.calibration;
  fg_artefact artefact = {{0}, {0}, {0}, {0}};
  const char *name = c->artefact[0] ? c->artefact : c->certificate;
  fg_text_clip(artefact.name, sizeof artefact.name, "%s", name[0] ? name : "the calibration");
  memcpy(artefact.due, c->due, sizeof artefact.due);
  return fg_artefact_check_due(ctx, m->scan, &artefact, m->date);
}

fg_status fg_measurement_calibrate(fg_context *ctx, unsigned threads, fg_measurement *m) {
  double stretch[FG_CALIBRATION_SOURCES][2];
  fg_measurement
      same; /* a partly omitted correction is not one of the edges: both states are measured */
  if (!m->design.calibration.stated || m->calibrated) return FG_OK;
  FG_TRY(check_due(ctx, m));
  fg_calibration_sources(&m->design.calibration, stretch);
  FG_TRY(fg_measure_stretched(ctx, m, (const double[]){1, 1}, threads, &same));
  fg_status status = FG_OK;
  for (size_t s = 0; s < FG_CALIBRATION_SOURCES && status == FG_OK; s++)
    status = find_source(ctx, &same, stretch[s], s, threads, m);
  fg_measurement_free(&same);
  if (status != FG_OK) return status;
  widen_all(m);
  m->calibrated = true;
  return FG_OK;
}

size_t fg_quantity_move_of(fg_quantity_owner owner, const fg_quantity *quantity) {
  size_t count, at = 0;
  for (const fg_quantity *row = fg_quantities(owner, &count); row != quantity; row++)
    if (fg_quantity_has_u(row)) at += fg_quantity_values(row);
  return at;
}

double fg_quantity_calibration(fg_quantity_owner owner, const fg_quantity *quantity,
                               const fg_calibrated *calibrated) {
  if (!fg_quantity_has_u(quantity)) return NAN;
  size_t at = fg_quantity_move_of(owner, quantity);
  double squares = 0;
  for (size_t s = 0; s < FG_CALIBRATION_SOURCES; s++)
    squares += calibrated->move[s][at] * calibrated->move[s][at];
  return sqrt(squares);
}

void fg_quantity_narrow_calibrated(fg_quantity_owner owner, void *object,
                                   const fg_calibrated *calibrated) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++) {
    double numbers[FG_QUANTITY_NUMBERS_MAX], own;
    if (!fg_quantity_has_u(&rows[i]) || rows[i].kind == FG_QUANTITY_PAIR) continue;
    fg_quantity_numbers(&rows[i], object, numbers);
    own = fg_quantity_calibration(owner, &rows[i], calibrated);
    numbers[1] = sqrt(fmax(0, (numbers[1] - own) * (numbers[1] + own)));
    fg_quantity_restore(&rows[i], object, numbers);
  }
}

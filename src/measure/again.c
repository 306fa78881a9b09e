/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/again.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "foilgauge/foil_kind.h"
#include "geometry/disc_fit.h"
#include "geometry/mark_nodes.h"

static fg_status copy_strip(fg_context *ctx, const fg_strip *from, fg_strip *to) {
  *to = *from;
  to->stations = NULL;
  FG_TRY(fg_memory_allocate(ctx, from->count, sizeof *to->stations, (void **)&to->stations));
  memcpy(to->stations, from->stations, from->count * sizeof *to->stations);
  return FG_OK;
}

void fg_strip_move(fg_strip *strip, fg_point (*move)(const void *user, fg_point at),
                   const void *user) {
  for (size_t k = 0; k < strip->count; k++) {
    fg_station *s = &strip->stations[k];
    if (isfinite(s->left.x)) s->left = move(user, s->left);
    if (isfinite(s->right.x)) s->right = move(user, s->right);
  }
  for (int i = 0; i < 2; i++) {
    strip->ends[i].left = move(user, strip->ends[i].left);
    strip->ends[i].right = move(user, strip->ends[i].right);
  }
}

static fg_status copy_edge(fg_context *ctx, const fg_measure_mover *mover, const fg_beam_edge *from,
                           fg_beam_edge *to) {
  *to = *from;
  to->stations = NULL;
  FG_TRY(fg_memory_allocate(ctx, from->count, sizeof *to->stations, (void **)&to->stations));
  for (size_t k = 0; k < from->count; k++) {
    to->stations[k] = from->stations[k];
    if (mover->flat) to->stations[k].at = mover->flat(mover->user, from->stations[k].at);
  }
  return FG_OK;
}

static fg_status copy_beams(fg_context *ctx, const fg_measure_mover *mover, const fg_foil *foil,
                            fg_foil *again) {
  FG_TRY(fg_memory_allocate(ctx, foil->beam_count, sizeof *again->beams, (void **)&again->beams));
  for (size_t i = 0; i < foil->beam_count; i++) {
    fg_beam *beam = &again->beams[again->beam_count++];
    *beam = foil->beams[i];
    for (int side = 0; side < FG_BEAM_SIDES; side++)
      beam->edges[side].stations = NULL;
    for (int side = 0; side < FG_BEAM_SIDES; side++)
      FG_TRY(copy_edge(ctx, mover, &foil->beams[i].edges[side], &beam->edges[side]));
  }
  return FG_OK;
}

/* Measures a flat foil by its beams; its other members are theirs or the scan's. */
static fg_status measure_flat(fg_context *ctx, const fg_foil *foil, const fg_design *design,
                              const fg_measure_mover *mover, fg_foil *again) {
  *again = *foil;
  again->beams = NULL;
  again->beam_count = 0;
  fg_status status = copy_beams(ctx, mover, foil, again);
  if (status == FG_OK) status = fg_beams_measure(ctx, design, again);
  if (status != FG_OK) fg_foil_free(again);
  return status;
}

static fg_status measure_foil(fg_context *ctx, const fg_foil *foil, const fg_design *design,
                              const fg_measure_mover *mover, unsigned threads, fg_foil *again) {
  if (fg_foil_traits_of(design->kind)->lies_flat)
    return measure_flat(ctx, foil, design, mover, again);
  memset(again, 0, sizeof *again);
  memcpy(again->place_mm, foil->place_mm, sizeof again->place_mm);
  again->number = foil->number;
  if (foil->flags & FG_FOIL_NOT_MEASURED) { /* nothing to measure; the reason stays */
    fg_foil_give_up(again, foil->error);
    again->flags = foil->flags;
    return FG_OK;
  }
  FG_TRY(copy_strip(ctx, &foil->strip, &again->strip));
  mover->strip(mover->user, foil, &again->strip);
  fg_status status = fg_strip_measure_thickness(ctx, &again->strip);
  if (status == FG_OK) status = fg_foil_measure(ctx, design, threads, again);
  if (status != FG_OK) fg_foil_free(again);
  return status;
}

static fg_status measure_disc(fg_context *ctx, const fg_disc *disc, const fg_measure_mover *mover,
                              fg_disc *again) {
  *again = *disc;
  again->edge = NULL;
  again->residual_um = NULL;
  again->stations = NULL;
  FG_TRY(fg_memory_allocate(ctx, disc->station_count, sizeof *disc->stations,
                            (void **)&again->stations));
  memcpy(again->stations, disc->stations, disc->station_count * sizeof *disc->stations);
  for (size_t k = 0; k < disc->station_count; k++)
    again->stations[k].at = mover->point(mover->user, disc, again->stations[k].at);
  return fg_disc_measure_again(ctx, again);
}

/* Discs of a measurement, each by a thread. */
typedef struct disc_task {
  const fg_measurement *from;
  const fg_measure_mover *mover;
  fg_measurement *to;
} disc_task;

static fg_status measure_one_disc(fg_context *ctx, void *shared, size_t d) {
  const disc_task *task = shared;
  return measure_disc(ctx, &task->from->discs[d], task->mover, &task->to->discs[d]);
}

static fg_status measure_discs_again(fg_context *ctx, const fg_measurement *m,
                                     const fg_measure_mover *mover, unsigned threads,
                                     fg_measurement *again) {
  disc_task task = {m, mover, again};
  FG_TRY(fg_memory_allocate(ctx, m->disc_count, sizeof *m->discs, (void **)&again->discs));
  again->disc_count = m->disc_count;
  return fg_parallel_run(ctx, threads, m->disc_count, measure_one_disc, &task);
}

/* A mark moves by the mean over its edges, along both axes of its lattice. */
static fg_point moved_mark(const fg_grid *grid, const fg_mark *mark,
                           const fg_measure_mover *mover) {
  enum { NODES = 12 };
  double length = hypot(grid->axis_mm[0][0], grid->axis_mm[0][1]);
  fg_point first = {grid->axis_mm[0][0] / length, grid->axis_mm[0][1] / length};
  const fg_point axes[2] = {first, {-first.y, first.x}};
  fg_point moved = mark->at_mm;
  if (!(length > 0) || !(mark->reach_mm > 0)) return mover->flat(mover->user, mark->at_mm);
  for (int a = 0; a < 2; a++) {
    fg_mark_node nodes[FG_MARK_NODES_MAX];
    size_t count = fg_mark_nodes(mark, axes[a], NODES, nodes);
    double move = 0;
    for (size_t k = 0; k < count; k++) {
      fg_point to = mover->flat(mover->user, nodes[k].at);
      move +=
          nodes[k].weight.x * (to.x - nodes[k].at.x) + nodes[k].weight.y * (to.y - nodes[k].at.y);
    }
    moved.x += move * axes[a].x;
    moved.y += move * axes[a].y;
  }
  return moved;
}

static fg_status measure_grid_again(fg_context *ctx, const fg_measurement *m,
                                    const fg_measure_mover *mover, fg_measurement *again) {
  const fg_grid *from = m->grid;
  if (!from || !mover->flat) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *again->grid, (void **)&again->grid));
  fg_grid *to = again->grid;
  *to = *from;
  to->marks = NULL;
  to->picture = NULL;
  to->per_step = 0;
  FG_TRY(fg_memory_allocate(ctx, from->count, sizeof *to->marks, (void **)&to->marks));
  memcpy(to->marks, from->marks, from->count * sizeof *to->marks);
  for (size_t i = 0; i < to->count; i++)
    to->marks[i].at_mm = moved_mark(from, &from->marks[i], mover);
  if (fg_grid_fit(to, m->dpi)) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "%s: the marks lie on one line", m->scan);
}

fg_status fg_measure_again(fg_context *ctx, const fg_measurement *m, const fg_measure_mover *mover,
                           unsigned threads, fg_measurement *again) {
  *again = *m;
  again->foils = NULL;
  again->foil_count = 0;
  again->discs = NULL;
  again->disc_count = 0;
  again->grid = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, m->foil_count, sizeof *m->foils, (void **)&again->foils));
  for (size_t f = 0; f < m->foil_count; f++) {
    FG_TRY_EXIT(measure_foil(ctx, &m->foils[f], &m->design, mover, threads, &again->foils[f]));
    again->foil_count++;
  }
  FG_TRY_EXIT(measure_discs_again(ctx, m, mover, threads, again));
  FG_TRY_EXIT(measure_grid_again(ctx, m, mover, again));
exit:
  if (status != FG_OK) fg_measurement_free(again);
  return status;
}

static fg_point stretched_point(const void *user, fg_point at) {
  const double *factor = user;
  return (fg_point){at.x * factor[0], at.y * factor[1]};
}

static void stretch_strip(const void *user, const fg_foil *foil, fg_strip *strip) {
  (void)foil;
  fg_strip_move(strip, stretched_point, user);
}

static fg_point stretch_point(const void *user, const fg_disc *disc, fg_point at) {
  (void)disc;
  return stretched_point(user, at);
}

fg_status fg_measure_stretched(fg_context *ctx, const fg_measurement *m, const double factor[2],
                               unsigned threads, fg_measurement *again) {
  const fg_measure_mover mover = {stretch_strip, stretch_point, stretched_point, factor};
  return fg_measure_again(ctx, m, &mover, threads, again);
}

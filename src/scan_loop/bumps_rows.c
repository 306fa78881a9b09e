/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The measured bumps as rows, one per bump of a part. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "foilgauge/foil_kind.h"
#include "scan_loop/bumps.h"

enum { RADIUS = FG_SCAN_LOOP_BUMP_RADIUS, ANGLE = FG_SCAN_LOOP_BUMP_ANGLE };

static bool is_usable(const fg_bump *bump) {
  const unsigned wrong = FG_BUMP_CRUSHED | FG_BUMP_NOT_FITTED | FG_BUMP_NO_CROSSING;
  return !(bump->flags & wrong) && isfinite(bump->radius_mm) && isfinite(bump->bump_angle_deg) &&
         isfinite(bump->height_mm);
}

static const fg_bump *find_number(const fg_foil *foil, int number) {
  for (size_t b = 0; b < foil->bump_count; b++)
    if (foil->bumps[b].number == number) return &foil->bumps[b];
  return NULL;
}

static fg_scan_loop_bump *find_row(fg_scan_loop_bumps *bumps, size_t part, int number) {
  for (size_t i = 0; i < bumps->count; i++)
    if (bumps->bump[i].part == part && bumps->bump[i].number == number) return &bumps->bump[i];
  return NULL;
}

/* Returns the error of one view's value that is common to all views. */
static double uncertainty_of(double u, double before, double after, bool open) {
  double moved = isfinite(before) ? after - before : 0;
  return open ? hypot(u, moved) : u;
}

/* Adds a view to a bump's sums; `views` counts them. */
static void add_view(fg_scan_loop_bump *row, const fg_foil *foil, const fg_bump *bump,
                     const fg_bump *before, bool open) {
  double was[2] = {before ? before->radius_mm : NAN, before ? before->bump_angle_deg : NAN};
  row->overall_mm += foil->overall.radius_mm;
  row->height_mm += bump->height_mm;
  row->value[RADIUS] += bump->radius_mm;
  row->value[ANGLE] += bump->bump_angle_deg;
  row->uncertainty[RADIUS] += uncertainty_of(bump->u_radius_mm, was[RADIUS], bump->radius_mm, open);
  row->uncertainty[ANGLE] +=
      uncertainty_of(bump->u_bump_angle_deg, was[ANGLE], bump->bump_angle_deg, open);
}

static void divide(fg_scan_loop_bump *row, double views) {
  row->overall_mm /= views;
  row->height_mm /= views;
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES; r++) {
    row->value[r] /= views;
    row->uncertainty[r] /= views;
  }
}

static int by_place(const void *a, const void *b) {
  const fg_scan_loop_bump *x = a, *y = b;
  if (x->part != y->part) return x->part < y->part ? -1 : 1;
  return (x->number > y->number) - (x->number < y->number);
}

static void add_foil_bumps(const fg_scan_loop_bumps_request *request, size_t scan, size_t foil,
                           size_t part, fg_scan_loop_bumps *bumps, double *views) {
  const fg_foil *after = &request->after[scan].foils[foil];
  const fg_foil *before = &request->before[scan].foils[foil];
  if (after->flags & FG_FOIL_NOT_MEASURED) return;
  if (after->flags & FG_FOIL_NO_LIP) bumps->lip = false;
  for (size_t b = 0; b < after->bump_count; b++) {
    const fg_bump *bump = &after->bumps[b];
    if (!is_usable(bump)) continue;
    fg_scan_loop_bump *row = find_row(bumps, part, bump->number);
    if (!row) {
      row = &bumps->bump[bumps->count++];
      *row = (fg_scan_loop_bump){
          .part = part, .number = bump->number, .held_out = request->hold_out[scan]};
    }
    add_view(row, after, bump, find_number(before, bump->number), request->open);
    views[row - bumps->bump]++;
  }
}

fg_status fg_scan_loop_bumps_collect(fg_context *ctx, const fg_scan_loop_bumps_request *request,
                                     fg_scan_loop_bumps *bumps) {
  size_t total = 0, part = 0;
  double *views = NULL;
  for (size_t s = 0; s < request->scan_count; s++)
    for (size_t f = 0; f < request->after[s].foil_count; f++)
      total += request->after[s].foils[f].bump_count;
  FG_TRY(fg_memory_allocate(ctx, total, sizeof *bumps->bump, (void **)&bumps->bump));
  FG_TRY(fg_memory_allocate(ctx, total, sizeof *views, (void **)&views));
  bumps->lip = fg_foil_traits_of(request->before[0].design.kind)->has_lip;
  for (size_t s = 0; s < request->scan_count; s++) {
    if (request->same_foil && request->hold_out[s]) continue;
    for (size_t f = 0; f < request->after[s].foil_count; f++)
      add_foil_bumps(request, s, f, request->same_foil ? f : part++, bumps, views);
  }
  for (size_t i = 0; i < bumps->count; i++)
    divide(&bumps->bump[i], views[i]);
  free(views);
  fg_sort_items(bumps->bump, bumps->count, sizeof *bumps->bump, by_place);
  for (size_t i = 0; i < bumps->count; i++)
    bumps->parts += !i || bumps->bump[i].part != bumps->bump[i - 1].part;
  return FG_OK;
}

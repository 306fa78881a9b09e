/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clearance of the bearings that the lot makes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/select.h"
#include "lot/statistics/analysis.h"
#include "quantity/quantity_rows.h"

static fg_status add_bearing(fg_context *ctx, fg_lot_analysis *analysis, const char *name,
                             fg_lot_bearing **bearing) {
  FG_TRY(fg_memory_reserve(ctx, analysis->bearing_count + 1, sizeof *analysis->bearings,
                           &analysis->bearing_capacity, (void **)&analysis->bearings));
  *bearing = &analysis->bearings[analysis->bearing_count++];
  **bearing = (fg_lot_bearing){.name = name, .number = analysis->bearing_count};
  return fg_memory_allocate(ctx, analysis->layout.pads, sizeof *(*bearing)->pad,
                            (void **)&(*bearing)->pad);
}

/* A foil that was scanned again takes no second place. */
static bool takes_a_place(const fg_lot_foil *foil) {
  return fg_foil_is_measured(foil->foil) && !foil->again;
}

/* Assumes bearings of foils in a row, as many as pads; the remainder makes none. */
static fg_status assume_bearings(fg_context *ctx, fg_lot_analysis *analysis) {
  size_t pads = analysis->layout.pads, pad = 0;
  const fg_lot_foil *set[FG_BEARING_BUMPS_MAX];
  for (size_t i = 0; i < analysis->foil_count; i++) {
    if (!takes_a_place(&analysis->foils[i])) continue;
    set[pad++] = &analysis->foils[i];
    if (pad < pads) continue;
    fg_lot_bearing *bearing;
    FG_TRY(add_bearing(ctx, analysis, NULL, &bearing));
    memcpy(bearing->pad, set, pads * sizeof *set);
    pad = 0;
  }
  analysis->unplaced.without = pad;
  return FG_OK;
}

/* Foil of a named bearing. */
typedef struct named_foil {
  const char *name;
  size_t at; /* in the lot */
} named_foil;

static int compare_named(const void *a, const void *b) {
  const named_foil *p = a, *q = b;
  int order = strcmp(p->name, q->name);
  return order ? order : (p->at > q->at) - (p->at < q->at);
}

/* Finds for each foil of a named bearing the first foil of that name. */
static fg_status find_first_foils(fg_context *ctx, const fg_lot_analysis *analysis, size_t column,
                                  size_t *first) {
  size_t count = 0;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, analysis->foil_count, sizeof(named_foil), &block));
  named_foil *named = block;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const char *name = fg_manifest_cell(&analysis->lot->manifest, analysis->foils[i].item, column);
    if (*name) named[count++] = (named_foil){name, i};
  }
  fg_sort_items(named, count, sizeof *named, compare_named);
  for (size_t i = 0; i < count; i++) {
    bool same = i > 0 && !strcmp(named[i].name, named[i - 1].name);
    first[named[i].at] = same ? first[named[i - 1].at] : named[i].at;
  }
  free(named);
  return FG_OK;
}

/* Returns the pad that the manifest says, else the next free one; `pads` when there is none. */
static size_t choose_pad(const fg_lot_bearing *bearing, const char *text, size_t pads, bool *bad) {
  char *end;
  unsigned long pad = strtoul(text, &end, 10);
  bool right = *text && !*end && pad >= 1 && pad <= pads;
  *bad = *text && !right;
  if (right) return bearing->pad[pad - 1] ? pads : pad - 1;
  size_t next = 0;
  while (next < pads && bearing->pad[next])
    next++;
  return next;
}

/* A foil that could not be measured leaves its place unknown. */
static void place_foil(fg_lot_analysis *analysis, const fg_lot_foil *foil,
                       fg_lot_bearing *bearing) {
  const fg_manifest *manifest = &analysis->lot->manifest;
  size_t pad_column = fg_manifest_column(manifest, analysis->lot->settings.pad_column);
  bool bad;
  if (!takes_a_place(foil)) return;
  const char *cell = fg_manifest_cell(manifest, foil->item, pad_column);
  size_t pad = choose_pad(bearing, cell, analysis->layout.pads, &bad);
  analysis->unplaced.bad_pads += bad;
  analysis->unplaced.displaced += pad == analysis->layout.pads;
  if (pad < analysis->layout.pads) bearing->pad[pad] = foil;
}

/* Places the foils in bearings, which are numbered as their first foils come. first[i] is the first
 * foil of foil i's bearing; `number` is room for the bearing's number by its first foil. */
static fg_status place_by_first(fg_context *ctx, fg_lot_analysis *analysis, size_t column,
                                const size_t *first, size_t *number) {
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_lot_foil *foil = &analysis->foils[i];
    const char *name = fg_manifest_cell(&analysis->lot->manifest, foil->item, column);
    fg_lot_bearing *bearing;
    analysis->unplaced.without += !*name && !foil->again;
    if (!*name) continue;
    if (first[i] == i) {
      number[i] = analysis->bearing_count;
      FG_TRY(add_bearing(ctx, analysis, name, &bearing));
    }
    place_foil(analysis, foil, &analysis->bearings[number[first[i]]]);
  }
  return FG_OK;
}

static fg_status place_foils(fg_context *ctx, fg_lot_analysis *analysis, size_t column) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, 2 * analysis->foil_count, sizeof(size_t), &block));
  size_t *first = block;
  fg_status status = find_first_foils(ctx, analysis, column, first);
  if (status == FG_OK)
    status = place_by_first(ctx, analysis, column, first, first + analysis->foil_count);
  free(block);
  return status;
}

/* Returns the common uncertainty of all clearances of a bearing: that of the strip's thickness and
 * of the calibration, which contains its share of the thickness. Independent errors of the two axes
 * agree only in bumps that lie alike on the glass. Taken as common in all, this uncertainty is not
 * underestimated in the smallest and the mean clearance. */
static double shared_uncertainty(const fg_lot_analysis *analysis, const fg_foil *foil,
                                 const fg_bump *bump) {
  const fg_quantity *thickness = fg_quantity_find(FG_QUANTITY_OF_FOIL, "thickness_mm");
  const fg_quantity *clearance = fg_quantity_find(FG_QUANTITY_OF_BUMP, "clearance_fitted_mm");
  double u = fg_foil_thickness(&analysis->lot->settings.design, foil).u_mm;
  double of_it = fg_quantity_calibration(FG_QUANTITY_OF_FOIL, thickness, &foil->calibrated);
  double all = fg_quantity_calibration(FG_QUANTITY_OF_BUMP, clearance, &bump->calibrated);
  if (all == 0) return u;
  return hypot(sqrt(fmax(0, (u - of_it) * (u + of_it))), all);
}

fg_lot_clearance fg_lot_clearance_of(const fg_lot_analysis *analysis, const fg_lot_foil *foil,
                                     int number) {
  const fg_lot_clearance unknown = {NAN, NAN, NAN};
  for (size_t i = 0; foil && i < foil->foil->bump_count; i++) {
    const fg_bump *bump = &foil->foil->bumps[i];
    if (bump->number != number) continue;
    if (!fg_lot_bump_counts(foil->foil, bump)) return unknown;
    double u = bump->u_clearance_fitted_mm;
    double shared = shared_uncertainty(analysis, foil->foil, bump);
    if (!isfinite(u)) u = 0;
    if (!(shared >= 0)) shared = 0;
    return (fg_lot_clearance){.mm = bump->clearance_fitted_mm,
                              .u_shared_mm = fmin(u, shared),
                              .u_own_mm = sqrt(fmax(0, (u - shared) * (u + shared)))};
  }
  return unknown;
}

static fg_status allocate_places(fg_context *ctx, size_t places, fg_lot_bearing *bearing) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, 3 * places, sizeof *bearing->angle_deg, &block));
  bearing->angle_deg = block;
  bearing->clearance_mm = bearing->angle_deg + places;
  bearing->u_clearance_mm = bearing->clearance_mm + places;
  return FG_OK;
}

static fg_status assess_bearing(fg_context *ctx, void *shared_analysis, size_t i) {
  fg_lot_analysis *analysis = shared_analysis;
  fg_lot_bearing *bearing = &analysis->bearings[i];
  const fg_bearing_layout *layout = &analysis->layout;
  double shared[FG_BEARING_BUMPS_MAX], own[FG_BEARING_BUMPS_MAX];
  size_t pads[FG_BEARING_BUMPS_MAX];
  fg_context unused;
  FG_TRY(allocate_places(ctx, layout->pads * layout->bumps_per_pad, bearing));
  for (size_t pad = 0; pad < layout->pads; pad++)
    for (size_t bump = 0; bump < layout->bumps_per_pad; bump++) {
      size_t at = bearing->places++;
      fg_lot_clearance c =
          fg_lot_clearance_of(analysis, bearing->pad[pad], (int)(layout->first_bump + bump));
      bearing->angle_deg[at] = fg_bearing_angle_deg(layout, pad, bump);
      bearing->clearance_mm[at] = c.mm;
      bearing->u_clearance_mm[at] = hypot(c.u_shared_mm, c.u_own_mm);
      shared[at] = c.u_shared_mm;
      own[at] = c.u_own_mm;
      pads[at] = pad;
    }
  const fg_bearing_uncertainty uncertainty = {shared, own, pads};
  bearing->known =
      fg_bearing_assess_uncertainty(&unused, bearing->angle_deg, bearing->clearance_mm,
                                    bearing->places, &uncertainty, &bearing->clearance) == FG_OK;
  return FG_OK;
}

/* Decides the bearings. A tolerance that judges no bearing must not read as a pass. */
static fg_status decide_bearings(fg_context *ctx, fg_lot_analysis *analysis) {
  const fg_design *design = &analysis->lot->settings.design;
  for (size_t i = 0; i < analysis->bearing_count; i++) {
    fg_lot_bearing *bearing = &analysis->bearings[i];
    bool whole = bearing->known && bearing->clearance.count == bearing->places;
    FG_TRY(fg_bearing_decide(ctx, design, bearing->known ? &bearing->clearance : NULL, whole,
                             &bearing->decision));
    analysis->bearings_by_verdict[bearing->decision.outcome.verdict]++;
    fg_outcome_add(&analysis->outcome, &bearing->decision.outcome);
  }
  const fg_report_outcome none = {.verdict = FG_VERDICT_NOT_MEASURED, .not_measured = 1};
  if (!analysis->bearing_count && fg_report_of_bearing(design, NULL, 0))
    fg_outcome_add(&analysis->outcome, &none);
  return FG_OK;
}

/* Describes clearances as figure 5.13 of the thesis: 100 (C_local - C_D) / C_D. */
static fg_status describe_relative_clearance(fg_context *ctx, const fg_lot_analysis *analysis,
                                             const char *name, fg_lot_spread *spread) {
  const fg_lot_quantity *quantity = fg_lot_find_quantity(analysis, name);
  double nominal = analysis->lot->nominal.clearance_mm;
  void *block;
  if (!quantity || !(fabs(nominal) > 0)) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, quantity->count, sizeof(double), &block));
  double *relative = block;
  for (size_t i = 0; i < quantity->count; i++)
    relative[i] = 100 * (quantity->value[i] - nominal) / nominal;
  fg_status status =
      fg_lot_find_spread(ctx, relative, quantity->count, analysis->lot->settings.bandwidth, spread);
  free(relative);
  return status;
}

fg_status fg_lot_analyse_bearings(fg_context *ctx, fg_lot_analysis *analysis) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  size_t column = fg_manifest_column(&analysis->lot->manifest, settings->bearing_column);
  fg_lot_find_layout(analysis);
  if (column == FG_NO_COLUMN)
    FG_TRY(assume_bearings(ctx, analysis));
  else
    FG_TRY(place_foils(ctx, analysis, column));
  FG_TRY(fg_parallel_run(ctx, analysis->lot->threads, analysis->bearing_count, assess_bearing,
                         analysis));
  FG_TRY(decide_bearings(ctx, analysis));
  FG_TRY(describe_relative_clearance(ctx, analysis, "clearance_mm", &analysis->clearance_pct));
  return describe_relative_clearance(ctx, analysis, "clearance_fitted_mm",
                                     &analysis->clearance_fitted_pct);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lot/statistics/foil_levels.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"

/* Limit of the sweeps over foils and places. With few bumps missing the residual falls tenfold in
 * each. */
enum { SWEEPS_MAX = 200 };
static const double CONVERGED = 1e-12; /* relative to the largest level */

typedef struct entry {
  size_t foil, place;
  double value;
} entry;

typedef struct layout {
  entry *entry;
  size_t entries, places;
  double *effect; /* by place, mean 0 */
  double *sum;    /* by place or foil */
  size_t *count;  /* by place */
  fg_foil_levels *levels;
} layout;

static size_t find_foil(fg_foil_levels *levels, size_t group, size_t owner) {
  /* The search starts at the last foil: scans of a foil follow each other in most lots. */
  for (size_t i = levels->count; i-- > 0;)
    if (levels->foil[i].group == group && levels->foil[i].owner == owner) return i;
  levels->foil[levels->count] = (fg_foil_level){.group = group, .owner = owner};
  return levels->count++;
}

static void add_entry(layout *l, size_t foil, int number, double value) {
  size_t place = number > 0 ? (size_t)number : 0;
  if (!isfinite(value)) return;
  l->entry[l->entries++] = (entry){foil, place, value};
  l->levels->foil[foil].values++;
  if (place >= l->places) l->places = place + 1;
}

static void gather_entries(const fg_lot_analysis *analysis, const fg_lot_quantity *quantity,
                           const size_t *group, const size_t *owner, layout *l) {
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_foil *foil = analysis->foils[i].foil;
    if (group[i] == FG_NO_COLUMN || !fg_foil_is_measured(foil)) continue;
    size_t at = owner[i] == i ? l->levels->count : find_foil(l->levels, group[i], owner[i]);
    if (at == l->levels->count)
      l->levels->foil[l->levels->count++] = (fg_foil_level){.group = group[i], .owner = i};
    if (quantity->owner == FG_QUANTITY_OF_FOIL)
      add_entry(l, at, 0, fg_quantity_value(quantity->row, foil));
    for (size_t k = 0; k < fg_part_count(foil, quantity->owner); k++) {
      const fg_foil_part part = fg_part_at(foil, quantity->owner, k);
      if (fg_lot_part_counts(foil, quantity->owner, &part))
        add_entry(l, at, fg_lot_part_number(foil, &part),
                  fg_quantity_value(quantity->row, part.object));
    }
  }
}

static void fit_levels(const layout *l) {
  fg_foil_level *foil = l->levels->foil;
  for (size_t i = 0; i < l->levels->count; i++)
    foil[i].level = 0;
  for (size_t e = 0; e < l->entries; e++) {
    const entry *one = &l->entry[e];
    foil[one->foil].level += (one->value - l->effect[one->place]) / (double)foil[one->foil].values;
  }
}

/* Fits the effects of the places; returns the largest step. */
static double fit_place_effects(const layout *l) {
  double mean = 0, used = 0, step = 0;
  for (size_t p = 0; p < l->places; p++)
    l->sum[p] = 0;
  for (size_t e = 0; e < l->entries; e++) {
    const entry *one = &l->entry[e];
    l->sum[one->place] += one->value - l->levels->foil[one->foil].level;
  }
  for (size_t p = 0; p < l->places; p++) {
    if (!l->count[p]) continue;
    l->sum[p] /= (double)l->count[p];
    mean += l->sum[p];
    used += 1;
  }
  for (size_t p = 0; p < l->places; p++) {
    if (!l->count[p]) continue;
    step = fmax(step, fabs(l->sum[p] - mean / used - l->effect[p]));
    l->effect[p] = l->sum[p] - mean / used;
  }
  return step;
}

/* Alternates between the two factors, which converges to least squares (Gauss-Seidel). */
static void iterate_levels(const layout *l) {
  double size = 0;
  fit_levels(l);
  for (size_t i = 0; i < l->levels->count; i++)
    size = fmax(size, fabs(l->levels->foil[i].level));
  if (l->places < 2) return;
  for (int sweep = 0; sweep < SWEEPS_MAX; sweep++) {
    double step = fit_place_effects(l);
    fit_levels(l);
    if (step <= CONVERGED * size) return;
  }
}

/* Finds the sd within foils. The places use degrees of freedom, which all foils share by their
 * number of values. */
static void find_within_sd(const layout *l) {
  double dof = 0, places = 0;
  fg_foil_level *foil = l->levels->foil;
  for (size_t p = 0; p < l->places; p++)
    places += l->count[p] > 0;
  for (size_t i = 0; i < l->levels->count; i++) {
    foil[i].within_sd = 0;
    dof += (double)foil[i].values - 1;
  }
  for (size_t e = 0; e < l->entries; e++) {
    const entry *one = &l->entry[e];
    double rest = one->value - l->effect[one->place] - foil[one->foil].level;
    foil[one->foil].within_sd += rest * rest;
  }
  double share = dof > places - 1 ? (dof - (places - 1)) / dof : NAN;
  for (size_t i = 0; i < l->levels->count; i++) {
    double own = ((double)foil[i].values - 1) * share;
    foil[i].within_sd = own > 0 ? sqrt(foil[i].within_sd / own) : NAN;
  }
}

static void drop_empty(fg_foil_levels *levels) {
  size_t kept = 0;
  for (size_t i = 0; i < levels->count; i++)
    if (levels->foil[i].values) levels->foil[kept++] = levels->foil[i];
  levels->count = kept;
}

fg_status fg_foil_levels_make(fg_context *ctx, const fg_lot_analysis *analysis,
                              const fg_lot_quantity *quantity, const size_t *group,
                              const size_t *owner, fg_foil_levels *levels) {
  layout l = {.levels = levels};
  fg_status status = FG_OK;
  size_t max = 0;
  *levels = (fg_foil_levels){0};
  for (size_t i = 0; i < analysis->foil_count; i++)
    max += 1 + fg_part_count(analysis->foils[i].foil, quantity->owner);
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, analysis->foil_count, sizeof *levels->foil, (void **)&levels->foil));
  FG_TRY_EXIT(fg_memory_allocate(ctx, max, sizeof *l.entry, (void **)&l.entry));
  gather_entries(analysis, quantity, group, owner, &l);
  FG_TRY_EXIT(fg_memory_allocate(ctx, l.places, sizeof *l.effect, (void **)&l.effect));
  FG_TRY_EXIT(fg_memory_allocate(ctx, l.places, sizeof *l.sum, (void **)&l.sum));
  FG_TRY_EXIT(fg_memory_allocate(ctx, l.places, sizeof *l.count, (void **)&l.count));
  for (size_t e = 0; e < l.entries; e++)
    l.count[l.entry[e].place]++;
  iterate_levels(&l);
  find_within_sd(&l);
  drop_empty(levels);
exit:
  free(l.entry);
  free(l.effect);
  free(l.sum);
  free(l.count);
  if (status != FG_OK) fg_foil_levels_free(levels);
  return status;
}

void fg_foil_levels_free(fg_foil_levels *levels) {
  free(levels->foil);
  *levels = (fg_foil_levels){0};
}

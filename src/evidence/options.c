/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "effect/columns.h"

enum { OPTIONS_MAX = 128 };

/* Standard deviations of amplitudes, um at FG_FIELD_HALF_MM, where the effect's row has none. */
#define SIZE_UM 20.0

static bool is_power(const fg_effect *effect) {
  return effect->polynomial != FG_EFFECT_NO_POLYNOMIAL;
}

void fg_evidence_effect_variances(const fg_effect *effect, size_t count, double *variance) {
  static const double powers[] = {13, 20, 20}, bends[] = {5, 2, 1, 0.5, 3, 1, 0.5};
  for (size_t c = 0; c < count; c++) {
    double size = SIZE_UM;
    if (effect->polynomial == FG_EFFECT_LINEAR)
      size = 54; /* 3e-3 of 18 mm */
    else if (effect->polynomial == FG_EFFECT_CUBIC && !c)
      size = 7;
    else if (is_power(effect) && c < 3)
      size = powers[c];
    else if (effect->bends && c < 7)
      size = bends[c];
    else if (effect->ring == FG_EFFECT_RING_OF_SCANNER)
      size = 36;
    else if (effect->sought == FG_EFFECT_PLACED)
      size = effect->jumps ? 15 : 10;
    variance[c] = size * size;
  }
}

fg_status fg_evidence_add_effect(fg_context *ctx, fg_evidence_problem *p, const fg_effect *effect,
                                 const double *shape, size_t *first, size_t *count) {
  double *columns = NULL;
  FG_TRY(fg_memory_allocate(ctx, p->edge_fit->row_count, FG_EFFECT_COLUMNS_MAX * sizeof *columns,
                            (void **)&columns));
  *first = p->count;
  *count = fg_effect_columns(p->edge_fit, effect, shape, columns);
  for (size_t c = 0; c < *count && fg_evidence_has_room(p, 1); c++)
    fg_evidence_add(p, columns + c * p->edge_fit->row_count);
  free(columns);
  return FG_OK;
}

static fg_evidence_option *new_option(fg_evidence_search *s) {
  if (s->option_count == OPTIONS_MAX) return NULL;
  fg_evidence_option *option = &s->options[s->option_count++];
  *option = (fg_evidence_option){.sets = 1};
  return option;
}

/* An effect over its starting shapes. */
static fg_status add_shaped(fg_context *ctx, const fg_effect *effect, fg_evidence_search *s) {
  fg_evidence_problem *p = &s->problem;
  fg_evidence_option *option = new_option(s);
  if (!option || !fg_evidence_has_room(p, effect->starts * effect->columns + 300)) return FG_OK;
  option->effect = effect;
  option->first = p->count;
  option->sets = effect->starts;
  for (size_t i = 0; i < effect->starts; i++) {
    size_t first;
    double shape[FG_FIELD_SHAPES] = {effect->start(&p->edge_fit->frame, i, effect->starts)};
    FG_TRY(fg_evidence_add_effect(ctx, p, effect, shape, &first, &option->each));
  }
  return FG_OK;
}

static fg_status add_plain(fg_context *ctx, const fg_effect *effect, const size_t powers[2],
                           fg_evidence_search *s) {
  fg_evidence_option *option = new_option(s);
  double shape[FG_FIELD_SHAPES] = {0};
  if (!option) return FG_OK;
  option->effect = effect;
  option->shape[0] = s->problem.edge_fit->frame.centre_mm[effect->axis];
  if (!is_power(effect))
    return fg_evidence_add_effect(ctx, &s->problem, effect, shape, &option->first, &option->each);
  option->first = powers[effect->axis];
  option->each = effect->polynomial;
  return FG_OK;
}

static fg_status add_effects(fg_context *ctx, fg_evidence_search *s) {
  size_t powers[2], count;
  double none[FG_FIELD_SHAPES] = {0};
  for (int axis = 0; axis < 2; axis++)
    FG_TRY(fg_evidence_add_effect(ctx, &s->problem, &fg_effect_powers[axis], none, &powers[axis],
                                  &count));
  for (const fg_effect *effect = fg_effect_first(); effect; effect = fg_effect_next(effect)) {
    if (fg_effect_is_free(effect) || !fg_effect_shows(s->problem.edge_fit, effect)) continue;
    if (effect->start)
      FG_TRY(add_shaped(ctx, effect, s));
    else
      FG_TRY(add_plain(ctx, effect, powers, s));
  }
  return FG_OK;
}

static fg_status add_seeds(fg_context *ctx, const fg_effect_set *seed, fg_evidence_search *s) {
  for (size_t e = 0; e < seed->count; e++) {
    const fg_effect_found *from = &seed->effects[e];
    if (!from->kind->start) continue;
    fg_evidence_option *option = new_option(s);
    if (!option) return FG_OK;
    option->effect = from->kind;
    option->seeded = true;
    memcpy(option->shape, from->shape, sizeof option->shape);
    FG_TRY(fg_evidence_add_effect(ctx, &s->problem, from->kind, from->shape, &option->first,
                                  &option->each));
  }
  return FG_OK;
}

/* Columns of a rival at all rows, row by row: `values` is count × rows. */
static fg_status add_rival_columns(fg_context *ctx, const fg_rival *rival, fg_evidence_problem *p,
                                   size_t *first, size_t *count) {
  double *values = NULL, row[FG_RIVAL_COLUMNS];
  size_t rows = p->edge_fit->row_count;
  *first = p->count;
  *count = 0;
  FG_TRY(fg_memory_allocate(ctx, rows, FG_RIVAL_COLUMNS * sizeof *values, (void **)&values));
  for (size_t i = 0; i < rows; i++) {
    *count = fg_rival_columns(rival, p->edge_fit, &p->edge_fit->rows[i], row);
    for (size_t c = 0; c < *count; c++)
      values[c * rows + i] = row[c];
  }
  for (size_t c = 0; c < *count && fg_evidence_has_room(p, 1); c++)
    fg_evidence_add(p, values + c * rows);
  free(values);
  return FG_OK;
}

/* Stretches of the whole rival `of`: products up to this degree, and all harmonics and bumps. */
enum { PRODUCTS_MAX = 18 };
static void add_stretches(const fg_rival *rival, const fg_evidence_option *of,
                          fg_evidence_search *s) {
  size_t width = rival->stretch(s->problem.edge_fit), count = width ? of->each / width : 0;
  if (rival->glass && count > PRODUCTS_MAX) count = PRODUCTS_MAX;
  for (size_t k = 0; k < count; k++) {
    if (rival->has_name && rival->has_name(k)) continue;
    fg_evidence_option *option = new_option(s);
    if (!option) return;
    option->rival = rival;
    option->stretch = k;
    option->stretches = count;
    option->first = of->first + k * width;
    option->each = width;
  }
}

static fg_status add_rivals(fg_context *ctx, fg_evidence_search *s) {
  const fg_evidence_option *whole = NULL;
  for (const fg_rival *rival = fg_rivals; rival->name; rival++) {
    if (rival->stretch) {
      if (whole) add_stretches(rival, whole, s);
      continue;
    }
    fg_evidence_option *option = new_option(s);
    if (!option) return FG_OK;
    option->rival = rival;
    FG_TRY(add_rival_columns(ctx, rival, &s->problem, &option->first, &option->each));
    whole = option->each ? option : NULL;
    if (!whole) s->option_count--;
  }
  return FG_OK;
}

/* Sizes and places of the bumps: per bump X, R, and the place along the foil, um per um. */
static fg_status add_scatter(fg_context *ctx, const double *jacobian, fg_evidence_search *s) {
  fg_evidence_problem *p = &s->problem;
  const fg_edge_fit *edge_fit = p->edge_fit;
  size_t rows = edge_fit->row_count, at = 0;
  double *column = NULL;
  s->scatter.first = p->count;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *column, (void **)&column));
  for (size_t part = 0; part < edge_fit->part_count; part++) {
    for (size_t b = 0; b < edge_fit->parts[part].bump_count && fg_evidence_has_room(p, 3); b++) {
      const double *own = jacobian + (at + 1 + 3 * b) * rows;
      double per_um = 1 / edge_fit->parts[part].bumps[b].distance_mm;
      fg_evidence_add(p, own);
      fg_evidence_add(p, own + 2 * rows);
      for (size_t i = 0; i < rows; i++)
        column[i] = own[rows + i] * per_um;
      fg_evidence_add(p, column);
    }
    at += 1 + 3 * edge_fit->parts[part].bump_count;
  }
  s->scatter.count = p->count - s->scatter.first;
  free(column);
  return FG_OK;
}

fg_status fg_evidence_list_options(fg_context *ctx, const fg_effect_set *seed,
                                   const double *jacobian, fg_evidence_search *s) {
  FG_TRY(fg_memory_allocate(ctx, OPTIONS_MAX, sizeof *s->options, (void **)&s->options));
  FG_TRY(add_scatter(ctx, jacobian, s));
  FG_TRY(add_rivals(ctx, s));
  FG_TRY(add_effects(ctx, s));
  return add_seeds(ctx, seed, s);
}

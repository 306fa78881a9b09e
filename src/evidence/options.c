/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "effect/columns.h"
#include "evidence/gauges.h"
#include "evidence/unnamed.h"

static bool is_power(const fg_effect *effect) {
  return effect->polynomial != FG_EFFECT_NO_POLYNOMIAL;
}

void fg_evidence_effect_variances(const fg_evidence_prior *prior, const fg_effect *effect,
                                  size_t count, double *variance) {
  double size = 0;
  for (size_t c = 0; c < count; c++) {
    if (c < FG_EFFECT_SIZES && effect->size_um[c] > 0) size = prior->size * effect->size_um[c];
    variance[c] = size * size;
  }
}

void fg_evidence_find_start(const fg_edge_fit *edge_fit, const fg_effect *effect, size_t i,
                            double shape[FG_FIELD_SHAPES], double reach[FG_FIELD_SHAPES]) {
  memset(shape, 0, FG_FIELD_SHAPES * sizeof *shape);
  memset(reach, 0, FG_FIELD_SHAPES * sizeof *reach);
  if (effect->grid)
    effect->grid(edge_fit, i, effect->starts, shape, reach);
  else
    shape[0] = effect->start(&edge_fit->frame, i, effect->starts);
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
  if (s->option_count == FG_EVIDENCE_OPTIONS) return NULL;
  fg_evidence_option *option = &s->options[s->option_count++];
  *option = (fg_evidence_option){.sets = 1};
  return option;
}

/* Columns of an option's starts. */
typedef struct starts {
  fg_evidence_problem *problem;
  const fg_evidence_option *option;
} starts;

static fg_status make_start(fg_context *ctx, void *shared, size_t item) {
  const starts *all = shared;
  const fg_evidence_option *option = all->option;
  fg_evidence_trial trial;
  double shape[FG_FIELD_SHAPES], reach[FG_FIELD_SHAPES];
  FG_TRY(fg_evidence_trial_open(ctx, all->problem, option->effect, option->each, 1, &trial));
  fg_evidence_find_start(all->problem->edge_fit, option->effect, item, shape, reach);
  fg_evidence_trial_add(all->problem, shape, &trial);
  for (size_t c = 0; c < option->each; c++)
    fg_evidence_put(all->problem, option->first + item * option->each + c, &trial.column[c]);
  fg_evidence_trial_close(&trial);
  return FG_OK;
}

/* An effect over its starting shapes. */
static fg_status add_shaped(fg_context *ctx, const fg_effect *effect, fg_evidence_search *s) {
  fg_evidence_problem *p = &s->problem;
  size_t columns = effect->columns ? effect->columns : 1;
  if (!fg_evidence_has_room(p, effect->starts * columns + 300)) return FG_OK;
  fg_evidence_option *option = new_option(s);
  if (!option) return FG_OK;
  option->effect = effect;
  option->first = p->count;
  option->sets = effect->starts;
  option->each = columns;
  p->count += effect->starts * columns;
  starts all = {p, option};
  return fg_parallel_run(ctx, s->request.threads, effect->starts, make_start, &all);
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
    if (effect->starts)
      FG_TRY(add_shaped(ctx, effect, s));
    else
      FG_TRY(add_plain(ctx, effect, powers, s));
  }
  return FG_OK;
}

static bool is_seeded(const fg_evidence_search *s, const fg_effect_found *as) {
  for (size_t o = 0; o < s->option_count; o++)
    if (s->options[o].effect == as->kind && s->options[o].seeded &&
        !memcmp(s->options[o].shape, as->shape, sizeof as->shape))
      return true;
  return false;
}

static fg_status add_seeds(fg_context *ctx, const fg_effect_set *seed, fg_evidence_search *s) {
  for (size_t e = 0; e < seed->count; e++) {
    const fg_effect_found *from = &seed->effects[e];
    if (!from->kind->starts || is_seeded(s, from)) continue;
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

/* Returns true for a rival, or a stretch of it, that an effect which is looked for has as its own.
 */
static bool has_name(const fg_edge_fit *edge_fit, const char *rival, size_t stretch) {
  for (const fg_effect *effect = fg_effect_first(); effect; effect = fg_effect_next(effect))
    if (effect->rival && !strcmp(effect->rival, rival) && effect->stretch == stretch &&
        fg_effect_shows(edge_fit, effect))
      return true;
  return false;
}

static void add_stretches(const fg_rival *rival, const fg_evidence_sets *columns,
                          fg_evidence_search *s) {
  size_t width = rival->stretch(s->problem.edge_fit);
  size_t count = width ? columns->count * columns->each / width : 0;
  for (size_t k = 0; k < count; k++) {
    if (has_name(s->problem.edge_fit, rival->name, k)) continue;
    fg_evidence_option *option = new_option(s);
    if (!option) return;
    option->rival = rival;
    option->stretch = k;
    option->stretches = count;
    option->first = columns->first + k * width;
    option->each = width;
  }
}

static fg_status add_rivals(fg_context *ctx, fg_evidence_search *s) {
  fg_evidence_sets columns = {0};
  for (const fg_rival *rival = fg_rivals; rival->name; rival++) {
    if (!fg_rival_shows(rival, s->problem.edge_fit)) continue;
    if (!rival->of_last) {
      columns.count = 1;
      FG_TRY(add_rival_columns(ctx, rival, &s->problem, &columns.first, &columns.each));
    }
    if (rival->stretch) {
      add_stretches(rival, &columns, s);
      continue;
    }
    fg_evidence_option *option = columns.each ? new_option(s) : NULL;
    if (!option) continue;
    option->rival = rival;
    option->first = columns.first;
    option->each = columns.each;
  }
  return FG_OK;
}

/* ---- how the bumps scatter ---- */

static double turn_from_first(const fg_edge_fit_part *part, size_t b) {
  double turn = 0;
  for (size_t k = 1; k <= b; k++)
    turn += remainder(part->bumps[k].direction_rad - part->bumps[k - 1].direction_rad, 2 * M_PI);
  return turn;
}

static double scattering_um(const fg_edge_fit_part *part, size_t b, int which) {
  const fg_edge_fit_bump *bump = &part->bumps[b];
  return 1000 * (which == FG_EVIDENCE_HEIGHT ? bump->distance_mm - bump->radius_mm
                 : which == FG_EVIDENCE_RADIUS
                     ? bump->radius_mm
                     : turn_from_first(part, b) * part->bumps[0].distance_mm);
}

static void fill_scatter_column(const double *own, size_t rows, double distance_mm, int which,
                                double *column) {
  const double *distance = own, *direction = own + rows, *radius = own + 2 * rows;
  for (size_t i = 0; i < rows; i++)
    column[i] = which == FG_EVIDENCE_HEIGHT   ? distance[i]
                : which == FG_EVIDENCE_RADIUS ? distance[i] + radius[i]
                                              : direction[i] / distance_mm;
}

/* Bumps are alike in their size, not in how far the fit has moved them: the numbers of the fit
 * are put back. */
static fg_status add_scatter(fg_context *ctx, const double *jacobian, fg_evidence_search *s) {
  fg_evidence_problem *p = &s->problem;
  const fg_edge_fit *edge_fit = p->edge_fit;
  size_t rows = edge_fit->row_count, at = 0;
  double *column = NULL;
  s->scatter.first = p->count;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *column, (void **)&column));
  for (size_t k = 0; k < edge_fit->part_count; k++) {
    const fg_edge_fit_part *part = &edge_fit->parts[k];
    for (size_t b = 0; b < part->bump_count && fg_evidence_has_room(p, FG_EVIDENCE_SCATTERS); b++)
      for (int which = 0; which < FG_EVIDENCE_SCATTERS; which++) {
        fill_scatter_column(jacobian + (at + 1 + 3 * b) * rows, rows, part->bumps[b].distance_mm,
                            which, column);
        fg_evidence_put_back(p, fg_evidence_add(p, column),
                             scattering_um(part, b, which) - scattering_um(part, 0, which));
      }
    at += 1 + 3 * part->bump_count;
  }
  s->scatter.count = p->count - s->scatter.first;
  free(column);
  return FG_OK;
}

/* ---- the own form of every disc ---- */

enum { FORM_ERROR_FIRST = 2, FORM_ERROR_COLUMNS = 150 };

/* Harmonics of one disc's form, from FORM_ERROR_FIRST on, that all discs have room for. */
static size_t form_error_harmonics(const fg_edge_fit *edge_fit) {
  size_t max = 6, fit = FORM_ERROR_COLUMNS / (2 * edge_fit->part_count);
  fit -= fit % FG_EVIDENCE_SCATTERS;
  return fit < FG_EVIDENCE_SCATTERS ? FG_EVIDENCE_SCATTERS : fit < max ? fit : max;
}

/* Harmonics in groups of one variance: a third of them each. */
static fg_status add_form_errors(fg_context *ctx, fg_evidence_search *s) {
  fg_evidence_problem *p = &s->problem;
  const fg_edge_fit *edge_fit = p->edge_fit;
  size_t harmonics = form_error_harmonics(edge_fit), each = harmonics / FG_EVIDENCE_SCATTERS;
  double *column = NULL;
  s->scatter.first = p->count;
  FG_TRY(fg_memory_allocate(ctx, edge_fit->row_count, sizeof *column, (void **)&column));
  for (size_t part = 0; part < edge_fit->part_count; part++)
    for (size_t k = 0; k < 2 * each; k++)
      for (size_t which = 0; which < FG_EVIDENCE_SCATTERS; which++) {
        double order = (double)(FORM_ERROR_FIRST + which * each + k / 2);
        for (size_t i = 0; i < edge_fit->row_count; i++) {
          const fg_edge_fit_row *row = &edge_fit->rows[i];
          double turn = order * row->normal_rad;
          column[i] = row->part != part ? 0 : k % 2 ? sin(turn) : cos(turn);
        }
        fg_evidence_add(p, column);
      }
  s->scatter.count = p->count - s->scatter.first;
  free(column);
  return FG_OK;
}

/* ---- all options ---- */

/* The columns of an option's sets: options may share them. */
static void note_sets(const fg_evidence_option *option, size_t *first) {
  for (size_t c = 0; option->each && c < option->sets * option->each; c++) {
    size_t *own = &first[option->first + c], set = option->first + c - c % option->each;
    if (set < *own) *own = set;
  }
}

static fg_status find_own_products(fg_context *ctx, fg_evidence_search *s) {
  fg_evidence_problem *p = &s->problem;
  size_t *first = NULL;
  FG_TRY(fg_memory_allocate(ctx, p->count + 1, sizeof *first, (void **)&first));
  for (size_t c = 0; c < p->count; c++)
    first[c] = c;
  for (size_t o = 0; o < s->option_count; o++)
    note_sets(&s->options[o], first);
  fg_status status = fg_evidence_find_own_products(ctx, p, first, s->request.threads);
  free(first);
  return status;
}

static fg_status add_unnamed(fg_context *ctx, fg_evidence_search *s) {
  for (const fg_effect *effect = fg_unnamed_effects; effect->id; effect++)
    if (!has_name(s->problem.edge_fit, effect->id, 0) &&
        fg_unnamed_shows(effect, s->problem.edge_fit))
      FG_TRY(add_shaped(ctx, effect, s));
  return FG_OK;
}

fg_status fg_evidence_list_options(fg_context *ctx, const double *jacobian, fg_evidence_search *s) {
  FG_TRY(fg_memory_allocate(ctx, FG_EVIDENCE_OPTIONS, sizeof *s->options, (void **)&s->options));
  FG_TRY(s->problem.edge_fit->discs ? add_form_errors(ctx, s) : add_scatter(ctx, jacobian, s));
  FG_TRY(fg_evidence_add_gauges(ctx, s));
  FG_TRY(add_rivals(ctx, s));
  FG_TRY(add_effects(ctx, s));
  FG_TRY(add_unnamed(ctx, s));
  for (size_t k = 0; k < s->request.seeds; k++)
    FG_TRY(add_seeds(ctx, &s->request.seed[k], s));
  return find_own_products(ctx, s);
}

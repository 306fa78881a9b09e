/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "evidence/unnamed.h"

/* Gain from which a shape is refined; share of its gain that the best start may lack, and every
 * refinement at most half of what the one before it did. */
#define REFINE_GAIN 6.0
#define START_LACKS 0.75
/* Points of a finer grid, and how often. */
enum { FINER = 9, FINER_LEVELS = 2, FINER_LEVELS_OF_TWO = 4 };
/* Share by which the range of two shapes shrinks to either side. */
#define SHRINKS_OF_TWO 0.2
/* Amplitudes of a rival, um: from the first one on by a factor of two each. */
#define AMPLITUDE_MIN_UM 0.03

double fg_evidence_amplitude_um(const fg_evidence_prior *prior, int i) {
  return prior->size * ldexp(AMPLITUDE_MIN_UM, i);
}

static double add_logs(double a, double b) {
  return a > b ? a + log1p(exp(b - a)) : b + log1p(exp(a - b));
}

/* Best set of an option's columns beside a model. */
typedef struct hit {
  double evidence, mass; /* mass: ln of the evidence's mean over sets and sizes, less the best */
  double wide;           /* number of sets as likely as the best that have the sum of all */
  size_t set;
  int size; /* halvings of the row's */
} hit;

static hit best_of(const double *evidence, size_t sets) {
  hit best = {.evidence = -INFINITY};
  double sum = -INFINITY;
  size_t count = sets * FG_EVIDENCE_SIZES;
  for (size_t i = 0; i < count; i++) {
    sum = add_logs(sum, evidence[i]);
    if (!(evidence[i] > best.evidence)) continue;
    best.evidence = evidence[i];
    best.set = i / FG_EVIDENCE_SIZES;
    best.size = (int)(i % FG_EVIDENCE_SIZES);
  }
  best.mass = sum - best.evidence - log((double)count);
  for (size_t i = (size_t)best.size; i < count; i += FG_EVIDENCE_SIZES)
    best.wide += exp(evidence[i] - best.evidence);
  return best;
}

static fg_status score_option(fg_context *ctx, fg_evidence_search *s,
                              const fg_evidence_factor *factor, const fg_evidence_sets *sets,
                              const double *variance, hit *to) {
  double *evidence = NULL;
  FG_TRY(fg_memory_allocate(ctx, sets->count, FG_EVIDENCE_SIZES * sizeof *evidence,
                            (void **)&evidence));
  fg_status status = fg_evidence_score_sets(ctx, &s->problem, factor, sets, variance, evidence);
  if (status == FG_OK) *to = best_of(evidence, sets->count);
  free(evidence);
  return status;
}

static void set_size(const fg_evidence_search *s, fg_evidence_part *part, int size) {
  fg_evidence_effect_variances(&s->request.prior, part->effect, part->count, part->variance);
  for (size_t c = 0; c < part->count; c++)
    part->variance[c] = ldexp(part->variance[c], -2 * size);
}

/* Directions of two shapes in which a better one is sought: either alone, both together. */
static const double directions[][FG_FIELD_SHAPES] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}};
enum { DIRECTIONS = sizeof directions / sizeof *directions };

/* Range of the shapes that are tried around the best ones. */
typedef struct shape_range {
  double low[FG_FIELD_SHAPES], high[FG_FIELD_SHAPES];
  double cell;              /* distance of neighbouring starts over the range's width now */
  double width[DIRECTIONS]; /* of the evidence's peak along a direction, in cells; 0: not known */
  bool resolved[DIRECTIONS];
} shape_range;

/* Fills the shape at place `at`, 0 to 1, of a direction through the range. */
static void move_shape(const fg_evidence_part *part, const shape_range *range,
                       const double *direction, double at, double *shape) {
  const double length_min = 0.1; /* of several shapes */
  for (size_t k = 0; k < FG_FIELD_SHAPES; k++) {
    double low = range->low[k], high = range->high[k], t = direction[k] < 0 ? 1 - at : at;
    shape[k] = direction[k] == 0 ? part->shape[k] : low + (high - low) * t;
    if (part->effect->shapes > 1 && part->effect->shape_is[k] == FG_EFFECT_LENGTH)
      shape[k] = fmax(shape[k], length_min);
  }
}

/* A peak narrower than the distance of the range's points is looked at again in the next range. */
static void note_width(shape_range *range, int way, const hit *found, double evidence) {
  const double resolved = 2;
  double wide = found->wide * exp(fmin(0, found->evidence - evidence));
  if (range->resolved[way]) return;
  range->resolved[way] = wide >= resolved;
  range->width[way] = wide / ((FINER + 1) * range->cell);
}

/* Returns the share of a cell that a peak fills, as ln, at most 0: starts are as likely over their
 * cells, and a shape that must be just so is as much less likely. */
static double log_share_of_cell(const fg_evidence_part *part, const shape_range *range) {
  const double *w = range->width, correlation_max = 0.95;
  if (part->effect->shapes < 2) return w[0] > 0 ? fmin(0, log(w[0])) : 0;
  for (int k = 0; k < DIRECTIONS; k++)
    if (!(w[k] > 0)) return 0;
  double square[DIRECTIONS];
  for (int k = 0; k < DIRECTIONS; k++)
    square[k] = 1 / (w[k] * w[k]);
  double correlation = 0.25 * (square[2] - square[3]) / sqrt(square[0] * square[1]);
  correlation = fmax(-correlation_max, fmin(correlation_max, correlation));
  return fmin(0, log(w[0] * w[1] / sqrt(1 - correlation * correlation)));
}

/* Scores the shapes along a direction through the range. */
static fg_status try_along(fg_context *ctx, const fg_evidence_search *s,
                           const fg_evidence_factor *factor, const shape_range *range, int way,
                           const fg_evidence_part *part, hit *found) {
  const fg_evidence_problem *p = &s->problem;
  double variance[FG_EFFECT_COLUMNS_MAX], shape[FG_FIELD_SHAPES];
  double evidence[FINER * FG_EVIDENCE_SIZES];
  fg_evidence_trial trial;
  FG_TRY(fg_evidence_trial_open(ctx, p, part->effect, part->count, FINER, &trial));
  for (int i = 0; i < FINER; i++) {
    move_shape(part, range, directions[way], (i + 1.0) / (FINER + 1), shape);
    fg_evidence_trial_add(p, shape, &trial);
  }
  fg_evidence_effect_variances(&s->request.prior, part->effect, part->count, variance);
  fg_status status = fg_evidence_score_trial(ctx, p, factor, &trial, variance, evidence);
  if (status == FG_OK) *found = best_of(evidence, FINER);
  fg_evidence_trial_close(&trial);
  return status;
}

/* Moves the shapes along a direction to the best ones of the range. */
static fg_status refine_along(fg_context *ctx, const fg_evidence_search *s,
                              const fg_evidence_factor *factor, shape_range *range, int way,
                              fg_evidence_extension *one) {
  double shape[FG_FIELD_SHAPES];
  hit found;
  FG_TRY(try_along(ctx, s, factor, range, way, one->part, &found));
  note_width(range, way, &found, one->evidence);
  if (!(found.evidence > one->evidence)) return FG_OK;
  one->evidence = found.evidence;
  one->moved = true;
  set_size(s, one->part, found.size);
  move_shape(one->part, range, directions[way], ((double)found.set + 1) / (FINER + 1), shape);
  memcpy(one->part->shape, shape, sizeof shape);
  return FG_OK;
}

/* The range shrinks around the best shapes; of two it does so slowly. */
static void shrink_range(const fg_evidence_part *part, shape_range *range) {
  for (size_t k = 0; k < FG_FIELD_SHAPES; k++) {
    double share = part->effect->shapes > 1 ? SHRINKS_OF_TWO : 1.0 / (FINER + 1);
    double reach = share * (range->high[k] - range->low[k]);
    range->low[k] = part->shape[k] - reach;
    range->high[k] = part->shape[k] + reach;
  }
  range->cell /= part->effect->shapes > 1 ? 2 * SHRINKS_OF_TWO : 2.0 / (FINER + 1);
}

/* Finds the range between the starts on both sides of start i; of a grid, its reach. */
static void find_range(const fg_edge_fit *edge_fit, const fg_effect *effect, size_t i,
                       fg_evidence_part *part, shape_range *range) {
  double reach[FG_FIELD_SHAPES];
  size_t last = effect->starts - 1;
  *range = (shape_range){.cell = 0.5};
  fg_evidence_find_start(edge_fit, effect, i, part->shape, reach);
  for (size_t k = 0; k < FG_FIELD_SHAPES; k++) {
    range->low[k] = part->shape[k] - reach[k];
    range->high[k] = part->shape[k] + reach[k];
  }
  if (effect->grid) return;
  range->low[0] = effect->start(&edge_fit->frame, i ? i - 1 : 0, effect->starts);
  range->high[0] = effect->start(&edge_fit->frame, i < last ? i + 1 : last, effect->starts);
}

fg_status fg_evidence_fit_effect(fg_context *ctx, fg_evidence_search *s,
                                 const fg_evidence_factor *factor, const fg_evidence_option *option,
                                 fg_evidence_part *part, double *evidence) {
  const fg_effect *effect = option->effect;
  hit found;
  *part = (fg_evidence_part){.effect = effect, .count = option->each};
  memcpy(part->shape, option->shape, sizeof part->shape);
  const fg_evidence_sets sets = {option->first, option->sets, option->each};
  set_size(s, part, 0);
  FG_TRY(score_option(ctx, s, factor, &sets, part->variance, &found));
  set_size(s, part, found.size);
  *evidence = found.evidence;
  part->first = option->first + found.set * option->each;
  part->log_prior = log(s->request.prior.weight * FG_EVIDENCE_PRIOR) + found.mass;
  if (option->seeded) part->log_prior -= log((double)effect->starts);
  if (!fg_effect_bears_name(effect)) part->log_prior -= log((double)fg_unnamed_of_kind(effect));
  double reach[FG_FIELD_SHAPES];
  if (option->sets > 1)
    fg_evidence_find_start(s->problem.edge_fit, effect, found.set, part->shape, reach);
  return FG_OK;
}

/* Moves the shapes to the best ones of their ranges. */
static fg_status refine_in(fg_context *ctx, const fg_evidence_search *s,
                           const fg_evidence_factor *factor, double gain_max, shape_range *range,
                           fg_evidence_extension *one) {
  size_t shapes = one->part->effect->shapes;
  for (int level = 0; level < (shapes > 1 ? FINER_LEVELS_OF_TWO : FINER_LEVELS); level++) {
    double gain_min = fmax(REFINE_GAIN, (1 - ldexp(START_LACKS, -level)) * gain_max);
    if (one->evidence < factor->evidence + gain_min) break;
    for (int k = 0; k < (shapes > 1 ? DIRECTIONS : 1); k++)
      FG_TRY(refine_along(ctx, s, factor, range, k, one));
    shrink_range(one->part, range);
  }
  return FG_OK;
}

fg_status fg_evidence_refine_effect(fg_context *ctx, const fg_evidence_search *s,
                                    const fg_evidence_factor *factor, double gain_max,
                                    fg_evidence_extension *one) {
  const fg_evidence_option *option = one->option;
  shape_range range;
  if (option->sets < 2) return FG_OK;
  find_range(s->problem.edge_fit, option->effect, (one->part->first - option->first) / option->each,
             one->part, &range);
  FG_TRY(refine_in(ctx, s, factor, gain_max, &range, one));
  one->part->log_prior += log_share_of_cell(one->part, &range);
  return FG_OK;
}

static size_t find_nearest_start(const fg_edge_fit *edge_fit, const fg_effect *effect,
                                 double shape) {
  size_t nearest = 0;
  double closest = INFINITY;
  for (size_t i = 0; i < effect->starts; i++) {
    double distance = fabs(effect->start(&edge_fit->frame, i, effect->starts) - shape);
    if (distance >= closest) continue;
    closest = distance;
    nearest = i;
  }
  return nearest;
}

static bool has_one_place(const fg_effect *effect) {
  return effect->starts && !effect->grid && effect->shapes == 1;
}

fg_status fg_evidence_refit_effect(fg_context *ctx, fg_evidence_search *s,
                                   const fg_evidence_factor *factor, fg_evidence_part *part,
                                   double *evidence) {
  const fg_edge_fit *edge_fit = s->problem.edge_fit;
  const double at = part->shape[0];
  size_t count;
  shape_range range;
  hit found;
  set_size(s, part, 0);
  FG_TRY(score_option(ctx, s, factor, &(fg_evidence_sets){part->first, 1, part->count},
                      part->variance, &found));
  set_size(s, part, found.size);
  *evidence = found.evidence;
  if (!has_one_place(part->effect) || !fg_evidence_has_room(&s->problem, part->count)) return FG_OK;
  find_range(edge_fit, part->effect, find_nearest_start(edge_fit, part->effect, at), part, &range);
  double reach = 0.25 * (range.high[0] - range.low[0]);
  part->shape[0] = at;
  range.low[0] = at - reach;
  range.high[0] = at + reach;
  fg_evidence_extension one = {.part = part, .evidence = *evidence};
  FG_TRY(refine_in(ctx, s, factor, 0, &range, &one));
  *evidence = one.evidence;
  if (!one.moved) return FG_OK;
  return fg_evidence_add_effect(ctx, &s->problem, part->effect, part->shape, &part->first, &count);
}

fg_status fg_evidence_fit_rival(fg_context *ctx, fg_evidence_search *s,
                                const fg_evidence_factor *factor, const fg_evidence_option *option,
                                fg_evidence_part *part, double *evidence) {
  const fg_edge_fit *edge_fit = s->problem.edge_fit;
  size_t n = option->each, tried = 0;
  double *gram = NULL, variance[FG_RIVAL_COLUMNS], scaled[FG_RIVAL_COLUMNS], sum = -INFINITY;
  double best = -INFINITY;
  *part = (fg_evidence_part){
      .rival = option->rival, .stretch = option->stretch, .first = option->first, .count = n};
  FG_TRY(fg_memory_allocate(ctx, 2 * n * (n + 1), sizeof *gram, (void **)&gram));
  double *right = gram + n * n, *work = right + n;
  fg_status status =
      fg_evidence_gram_beside(ctx, &s->problem, factor, option->first, n, gram, right);
  for (size_t l = 0; status == FG_OK && option->rival->variances(edge_fit, l, variance); l++)
    for (int a = 0; a < FG_EVIDENCE_AMPLITUDES; a++) {
      double size = fg_evidence_amplitude_um(&s->request.prior, a);
      for (size_t c = 0; c < n; c++)
        scaled[c] = size * size * variance[c];
      double value = fg_evidence_of(n, gram, right, scaled, work);
      sum = add_logs(sum, value);
      tried++;
      if (!(value > best)) continue;
      best = value;
      memcpy(part->variance, scaled, n * sizeof *scaled);
    }
  *evidence = factor->evidence + best;
  part->log_prior =
      log(s->request.prior.weight * FG_EVIDENCE_PRIOR) + sum - best - log((double)tried);
  if (option->stretches) part->log_prior -= log((double)option->stretches);
  free(gram);
  return status;
}

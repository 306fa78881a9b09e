/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "evidence/options.h"
#include "evidence/unnamed.h"

/* Models that are extended in a round: of named effects alone, and with rivals if they are no
 * further than REACH from the best. */
enum { NAMED_FRONT = 4, RIVAL_FRONT = 3, NAMED_MAX = 4, RIVALS_MAX = 2, ROUNDS = 4 };
#define REACH 60.0
/* The likeliest models, of which every part is left out in turn; models that get their own scatter.
 */
enum { SHORTENED = 16, SCATTERED = 24 };
/* Gain from which a place is refined; points of a finer grid, and how often. */
#define REFINE_GAIN 6.0
enum { FINER = 9, FINER_LEVELS = 2, FINER_LEVELS_OF_TWO = 4, COPIES_MAX = 3 };
/* Share by which the range of two shapes shrinks to either side. */
#define SHRINKS_OF_TWO 0.2

/* Amplitudes of a rival, um: from the first one on by a factor of two each. */
#define AMPLITUDE_MIN_UM 0.03
enum { AMPLITUDES = 11 };

/* Scatter of bumps that is tried: of their height, of their radius as thousandths of it, along the
 * foil. */
enum { SCATTERS_TRIED = 5 };
static const double scatters[FG_EVIDENCE_SCATTERS][SCATTERS_TRIED] = {
    {1, 3, 10, 30, 100}, {2, 4, 8, 16, 32}, {3, 10, 30, 100, 300}};

static double add_logs(double a, double b) {
  return a > b ? a + log1p(exp(b - a)) : b + log1p(exp(a - b));
}

bool fg_evidence_holds(const fg_evidence_model *model, const fg_effect *effect) {
  for (size_t k = 0; k < model->parts; k++)
    if (model->part[k]->effect && fg_effect_same(model->part[k]->effect, effect)) return true;
  return false;
}

static double mean_radius_um(const fg_edge_fit *edge_fit) {
  double sum = 0;
  for (size_t p = 0; p < edge_fit->part_count; p++)
    sum += edge_fit->parts[p].mean_radius_mm;
  return edge_fit->part_count ? 1000 * sum / (double)edge_fit->part_count : 0;
}

static double scatter_um(const fg_evidence_search *s, int which, int i) {
  double unit = which == FG_EVIDENCE_RADIUS ? 1e-3 * mean_radius_um(s->problem.edge_fit) : 1;
  return unit * scatters[which][i];
}

/* ---- one model ---- */

static fg_status evaluate(fg_context *ctx, fg_evidence_search *s, fg_evidence_model *model) {
  fg_evidence_factor factor;
  FG_TRY(fg_evidence_factor_open(ctx, &s->problem, &s->scatter, model, &factor));
  model->evidence = factor.evidence;
  fg_evidence_factor_close(&factor);
  return FG_OK;
}

/* Finds the scatter of the bumps at which the model is likeliest. */
static fg_status find_scatter(fg_context *ctx, fg_evidence_search *s, fg_evidence_model *model) {
  fg_evidence_model best = *model;
  FG_TRY(evaluate(ctx, s, &best));
  for (int which = 0; s->scatter.count && which < FG_EVIDENCE_SCATTERS; which++) {
    fg_evidence_model tried = best;
    for (int i = 0; i < SCATTERS_TRIED; i++) {
      tried.scatter_um[which] = scatter_um(s, which, i);
      FG_TRY(evaluate(ctx, s, &tried));
      if (tried.evidence > best.evidence) best = tried;
    }
  }
  *model = best;
  return FG_OK;
}

static void set_score(const fg_evidence_search *s, fg_evidence_model *model) {
  double none = s->count ? s->models[0].evidence : model->evidence;
  model->score = model->evidence - none;
  for (size_t k = 0; k < model->parts; k++)
    model->score += model->part[k]->log_prior;
}

/* ---- candidates ---- */

/* Best set of an option's columns beside a model. */
typedef struct hit {
  double evidence, mass; /* mass: ln of the evidence's mean over sets and sizes, less the best */
  double wide;           /* number of sets as likely as the best that have the sum of all */
  size_t set;
  int size; /* halvings of the row's */
} hit;

static fg_status score_option(fg_context *ctx, fg_evidence_search *s,
                              const fg_evidence_factor *factor, const fg_evidence_sets *sets,
                              const double *variance, hit *to) {
  double *evidence = NULL, sum = -INFINITY;
  size_t count = sets->count * FG_EVIDENCE_SIZES;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *evidence, (void **)&evidence));
  fg_status status = fg_evidence_score_sets(ctx, &s->problem, factor, sets, variance, evidence);
  *to = (hit){.evidence = -INFINITY};
  for (size_t i = 0; status == FG_OK && i < count; i++) {
    sum = add_logs(sum, evidence[i]);
    if (!(evidence[i] > to->evidence)) continue;
    to->evidence = evidence[i];
    to->set = i / FG_EVIDENCE_SIZES;
    to->size = (int)(i % FG_EVIDENCE_SIZES);
  }
  to->mass = sum - to->evidence - log((double)count);
  for (size_t i = (size_t)to->size; status == FG_OK && i < count; i += FG_EVIDENCE_SIZES)
    to->wide += exp(evidence[i] - to->evidence);
  free(evidence);
  return status;
}

static void set_size(const fg_evidence_search *s, fg_evidence_part *part, int size) {
  fg_evidence_effect_variances(&s->prior, part->effect, part->count, part->variance);
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

/* Moves the shapes along a direction to the best ones of the range. */
static fg_status refine_along(fg_context *ctx, fg_evidence_search *s,
                              const fg_evidence_factor *factor, shape_range *range, int way,
                              fg_evidence_part *part, double *evidence) {
  const double *direction = directions[way];
  fg_evidence_problem *p = &s->problem;
  size_t from = p->count, each = part->count, first, count;
  double variance[FG_EFFECT_COLUMNS_MAX], shape[FG_FIELD_SHAPES];
  hit found;
  if (!fg_evidence_has_room(p, (FINER + 1) * each)) return FG_OK;
  fg_evidence_effect_variances(&s->prior, part->effect, each, variance);
  for (int i = 0; i < FINER; i++) {
    move_shape(part, range, direction, (i + 1.0) / (FINER + 1), shape);
    FG_TRY(fg_evidence_add_effect(ctx, p, part->effect, shape, &first, &count));
  }
  FG_TRY(score_option(ctx, s, factor, &(fg_evidence_sets){from, FINER, each}, variance, &found));
  fg_evidence_drop(p, from);
  note_width(range, way, &found, *evidence);
  if (!(found.evidence > *evidence)) return FG_OK;
  *evidence = found.evidence;
  set_size(s, part, found.size);
  move_shape(part, range, direction, ((double)found.set + 1) / (FINER + 1), shape);
  memcpy(part->shape, shape, sizeof shape);
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

/* Moves the shapes to the best ones of their ranges; the columns of the best stay. */
static fg_status refine_place(fg_context *ctx, fg_evidence_search *s,
                              const fg_evidence_factor *factor, shape_range *range,
                              fg_evidence_part *part, double *evidence) {
  double before[FG_FIELD_SHAPES];
  size_t shapes = part->effect->shapes, count;
  memcpy(before, part->shape, sizeof before);
  for (int level = 0; level < (shapes > 1 ? FINER_LEVELS_OF_TWO : FINER_LEVELS); level++) {
    for (int k = 0; k < (shapes > 1 ? DIRECTIONS : 1); k++)
      FG_TRY(refine_along(ctx, s, factor, range, k, part, evidence));
    shrink_range(part, range);
  }
  part->log_prior += log_share_of_cell(part, range);
  if (!memcmp(before, part->shape, sizeof before)) return FG_OK;
  if (!fg_evidence_has_room(&s->problem, part->count)) return FG_OK;
  return fg_evidence_add_effect(ctx, &s->problem, part->effect, part->shape, &part->first, &count);
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

static fg_status fit_effect(fg_context *ctx, fg_evidence_search *s,
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
  part->log_prior = log(s->prior.weight * FG_EVIDENCE_PRIOR) + found.mass;
  if (option->seeded) part->log_prior -= log((double)effect->starts);
  if (fg_effect_is_unnamed(effect)) part->log_prior -= log(FG_UNNAMED_EFFECTS);
  if (option->sets < 2) return FG_OK;
  shape_range range;
  find_range(s->problem.edge_fit, effect, found.set, part, &range);
  if (found.evidence < factor->evidence + REFINE_GAIN) return FG_OK;
  return refine_place(ctx, s, factor, &range, part, evidence);
}

/* Likeliest length and amplitude of a rival; the mass is over all. */
static fg_status fit_rival(fg_context *ctx, fg_evidence_search *s, const fg_evidence_factor *factor,
                           const fg_evidence_option *option, fg_evidence_part *part,
                           double *evidence) {
  const fg_edge_fit *edge_fit = s->problem.edge_fit;
  size_t n = option->each, tried = 0;
  double *gram = NULL, variance[FG_RIVAL_COLUMNS], scaled[FG_RIVAL_COLUMNS], sum = -INFINITY;
  double best = -INFINITY;
  *part = (fg_evidence_part){
      .rival = option->rival, .stretch = option->stretch, .first = option->first, .count = n};
  FG_TRY(fg_memory_allocate(ctx, 2 * n * (n + 1), sizeof *gram, (void **)&gram));
  double *right = gram + n * n, *work = right + n;
  fg_status status = fg_evidence_beside(ctx, &s->problem, factor, option->first, n, gram, right);
  for (size_t l = 0; status == FG_OK && option->rival->variances(edge_fit, l, variance); l++)
    for (int a = 0; a < AMPLITUDES; a++) {
      double size = s->prior.size * ldexp(AMPLITUDE_MIN_UM, a);
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
  part->log_prior = log(s->prior.weight * FG_EVIDENCE_PRIOR) + sum - best - log((double)tried);
  if (option->stretches) part->log_prior -= log((double)option->stretches);
  free(gram);
  return status;
}

/* ---- sets ---- */

static size_t copies_of(const fg_evidence_model *model, const fg_effect *effect) {
  size_t count = 0;
  for (size_t k = 0; k < model->parts; k++)
    count += model->part[k]->effect == effect;
  return count;
}

static bool holds_rival(const fg_evidence_model *model, const fg_evidence_option *option) {
  for (size_t k = 0; k < model->parts; k++)
    if (model->part[k]->rival == option->rival && model->part[k]->stretch == option->stretch)
      return true;
  return false;
}

static bool bears_name(const fg_evidence_option *option) {
  return option->effect && !fg_effect_is_unnamed(option->effect);
}

/* Ripples and steps may come several times, all others once, in one of their bases. */
static bool may_join(const fg_evidence_model *model, const fg_evidence_option *option) {
  if (model->parts == FG_EVIDENCE_PARTS) return false;
  if (!bears_name(option) && model->parts - model->named == RIVALS_MAX) return false;
  if (option->rival) return !holds_rival(model, option);
  if (bears_name(option) && model->named == NAMED_MAX) return false;
  if (option->effect->sought == FG_EFFECT_PLACED)
    return copies_of(model, option->effect) < COPIES_MAX;
  return !fg_evidence_holds(model, option->effect);
}

static bool same_part(const fg_evidence_part *a, const fg_evidence_part *b) {
  return a->effect == b->effect && a->rival == b->rival && a->stretch == b->stretch;
}

static bool same_parts(const fg_evidence_model *a, const fg_evidence_model *b) {
  bool taken[FG_EVIDENCE_PARTS] = {false};
  if (a->parts != b->parts) return false;
  for (size_t i = 0; i < a->parts; i++) {
    size_t k = 0;
    while (k < b->parts && (taken[k] || !same_part(a->part[i], b->part[k])))
      k++;
    if (k == b->parts) return false;
    taken[k] = true;
  }
  return true;
}

/* Adds a model, or puts it in the place of a worse one of the same parts. */
static void keep_model(fg_evidence_search *s, const fg_evidence_model *model) {
  for (size_t m = 0; m < s->count; m++)
    if (same_parts(&s->models[m], model)) {
      if (model->score > s->models[m].score) s->models[m] = *model;
      return;
    }
  if (s->count < FG_EVIDENCE_MODELS) s->models[s->count++] = *model;
}

static fg_status extend_model(fg_context *ctx, fg_evidence_search *s,
                              const fg_evidence_model *from) {
  fg_evidence_factor factor;
  fg_status status = FG_OK;
  FG_TRY(fg_evidence_factor_open(ctx, &s->problem, &s->scatter, from, &factor));
  for (size_t o = 0; o < s->option_count && s->stored < FG_EVIDENCE_STORE; o++) {
    const fg_evidence_option *option = &s->options[o];
    fg_evidence_part *part = &s->store[s->stored];
    fg_evidence_model model = *from;
    if (!may_join(from, option)) continue;
    FG_TRY_EXIT(option->rival ? fit_rival(ctx, s, &factor, option, part, &model.evidence)
                              : fit_effect(ctx, s, &factor, option, part, &model.evidence));
    s->stored++;
    model.part[model.parts++] = part;
    model.named += bears_name(option);
    set_score(s, &model);
    keep_model(s, &model);
  }
exit:
  fg_evidence_factor_close(&factor);
  return status;
}

static int compare_models(const void *a, const void *b) {
  double x = ((const fg_evidence_model *)a)->score, y = ((const fg_evidence_model *)b)->score;
  return (x < y) - (x > y);
}

/* Selects the models of `parts` parts that the next round extends. */
static size_t choose_front(const fg_evidence_search *s, size_t parts, size_t *front) {
  size_t named = 0, rivals = 0, count = 0;
  double top = s->models[0].score;
  for (size_t m = 0; m < s->count; m++)
    top = fmax(top, s->models[m].score);
  for (size_t m = 0; m < s->count; m++) {
    const fg_evidence_model *model = &s->models[m];
    if (model->parts != parts) continue;
    if (fg_evidence_is_named(model) ? named == NAMED_FRONT
                                    : rivals == RIVAL_FRONT || model->score < top - REACH)
      continue;
    fg_evidence_is_named(model) ? named++ : rivals++;
    front[count++] = m;
  }
  return count;
}

static fg_status run_rounds(fg_context *ctx, fg_evidence_search *s) {
  size_t front[NAMED_FRONT + RIVAL_FRONT];
  for (size_t parts = 0; parts < ROUNDS; parts++) {
    double before = s->models[0].score;
    for (size_t m = 0; m < s->count; m++)
      before = fmax(before, s->models[m].score);
    size_t count = choose_front(s, parts, front);
    for (size_t k = 0; k < count; k++) {
      fg_evidence_model model = s->models[front[k]];
      FG_TRY(find_scatter(ctx, s, &model));
      set_score(s, &model);
      s->models[front[k]] = model;
      FG_TRY(extend_model(ctx, s, &model));
    }
    qsort(s->models + 1, s->count - 1, sizeof *s->models, compare_models);
    if (parts && s->models[1].score <= before + 1) break;
  }
  return FG_OK;
}

/* Leaves out causes that became needless beside those added later. */
static fg_status shorten_models(fg_context *ctx, fg_evidence_search *s) {
  size_t count = s->count < SHORTENED ? s->count : SHORTENED;
  for (size_t m = 1; m < count; m++)
    for (size_t k = 0; s->models[m].parts > 1 && k < s->models[m].parts; k++) {
      fg_evidence_model shorter = s->models[m];
      const fg_effect *effect = shorter.part[k]->effect;
      shorter.parts--;
      shorter.named -= effect && !fg_effect_is_unnamed(effect);
      memmove(shorter.part + k, shorter.part + k + 1, (shorter.parts - k) * sizeof *shorter.part);
      FG_TRY(evaluate(ctx, s, &shorter));
      set_score(s, &shorter);
      keep_model(s, &shorter);
    }
  qsort(s->models + 1, s->count - 1, sizeof *s->models, compare_models);
  return FG_OK;
}

fg_status fg_evidence_search_open(fg_context *ctx, const fg_edge_fit *edge_fit,
                                  const fg_effect_set *seed, const double *residual_um,
                                  const double *jacobian, const fg_evidence_prior *prior,
                                  fg_evidence_search *s) {
  *s = (fg_evidence_search){.prior = *prior};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_evidence_open(ctx, edge_fit, residual_um, jacobian, &s->problem));
  FG_TRY_EXIT(fg_memory_allocate(ctx, FG_EVIDENCE_STORE, sizeof *s->store, (void **)&s->store));
  FG_TRY_EXIT(fg_memory_allocate(ctx, FG_EVIDENCE_MODELS, sizeof *s->models, (void **)&s->models));
  FG_TRY_EXIT(fg_evidence_list_options(ctx, seed, jacobian, s));
exit:
  if (status != FG_OK) fg_evidence_search_close(s);
  return status;
}

fg_status fg_evidence_search_run(fg_context *ctx, fg_evidence_search *s) {
  fg_evidence_model none = {.parts = 0};
  s->count = s->stored = 0;
  for (int which = 0; which < FG_EVIDENCE_SCATTERS; which++)
    none.scatter_um[which] = scatter_um(s, which, SCATTERS_TRIED / 2);
  FG_TRY(find_scatter(ctx, s, &none));
  s->models[s->count++] = none;
  FG_TRY(run_rounds(ctx, s));
  FG_TRY(shorten_models(ctx, s));
  for (size_t m = 0; m < s->count && m < SCATTERED; m++) {
    FG_TRY(find_scatter(ctx, s, &s->models[m]));
    set_score(s, &s->models[m]);
  }
  qsort(s->models, s->count, sizeof *s->models, compare_models);
  return FG_OK;
}

void fg_evidence_search_close(fg_evidence_search *s) {
  fg_evidence_close(&s->problem);
  free(s->store);
  free(s->models);
  free(s->options);
  *s = (fg_evidence_search){.count = 0};
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/select.h"
#include "evidence/fit.h"
#include "evidence/products_ahead.h"
#include "evidence/refit.h"
#include "evidence/unnamed.h"

/* Models that are extended in a round: of named effects alone, and with rivals if they are no
 * further than REACH from the best. */
enum {
  NAMED_FRONT = 4,
  RIVAL_FRONT = 3,
  NAMED_MAX = 4,
  RIVALS_MAX = 3,
  DISC_RIVALS_MAX = 2,
  ROUNDS = 4
};
#define REACH 60.0
/* The likeliest models, of which every part is left out in turn; models that get their own scatter,
 * and whose effects are fitted together. */
enum { SHORTENED = 16, SCATTERED = 24, REFITTED = 12, NAMED_REFITTED = 4 };
enum { COPIES_MAX = 3 };
/* Sets whose parts are exchanged; their rests without one part, at most; how often. */
enum { EXCHANGED = 4, EXCHANGES = 12, EXCHANGE_ROUNDS = 2 };

/* Scatter of bumps that is tried: of their height, of their radius as thousandths of it, along the
 * foil. */
enum { SCATTERS_TRIED = 5 };
static const double scatters[FG_EVIDENCE_SCATTERS][SCATTERS_TRIED] = {
    {1, 3, 10, 30, 100}, {2, 4, 8, 16, 32}, {3, 10, 30, 100, 300}};

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

/* Of the harmonics of discs' forms, um; of known radii: what a gauge and its edge are off. */
static const double form_error_um[SCATTERS_TRIED] = {0.01, 0.05, 0.25, 1, 4};
static const double gauge_error_um[SCATTERS_TRIED] = {0.1, 0.25, 0.6, 1.5, 4};

static double scatter_um(const fg_evidence_search *s, int which, int i) {
  if (which == FG_EVIDENCE_GAUGE) return gauge_error_um[i];
  if (s->problem.edge_fit->discs) return form_error_um[i];
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

/* A model at each of the sizes that its scatter may have. */
typedef struct scatter_trials {
  fg_evidence_search *search;
  fg_evidence_model model[SCATTERS_TRIED];
} scatter_trials;

static fg_status evaluate_trial(fg_context *ctx, void *shared, size_t item) {
  scatter_trials *trials = shared;
  return evaluate(ctx, trials->search, &trials->model[item]);
}

/* Finds the scatter of the bumps at which the model is likeliest. Its products are known after the
 * first evaluation, so threads may share the others, where these take longer than a thread's start.
 */
static fg_status find_scatter(fg_context *ctx, fg_evidence_search *s, fg_evidence_model *model) {
  enum { MANY = 80 };
  unsigned threads = s->scatter.count < MANY ? 1 : s->request.threads;
  fg_evidence_model best = *model;
  FG_TRY(evaluate(ctx, s, &best));
  int spreads = s->scatter.gauges ? FG_EVIDENCE_SPREADS : FG_EVIDENCE_SCATTERS;
  for (int which = 0; s->scatter.count && which < spreads; which++) {
    scatter_trials trials = {.search = s};
    for (int i = 0; i < SCATTERS_TRIED; i++) {
      trials.model[i] = best;
      trials.model[i].scatter_um[which] = scatter_um(s, which, i);
    }
    FG_TRY(fg_parallel_run(ctx, threads, SCATTERS_TRIED, evaluate_trial, &trials));
    for (int i = 0; i < SCATTERS_TRIED; i++)
      if (trials.model[i].evidence > best.evidence) best = trials.model[i];
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

static bool is_of_one_disc(const fg_effect *effect, const fg_rival *rival) {
  return (rival ? rival->coordinate : effect->coordinate) == FG_EFFECT_COORDINATES;
}

/* On few discs the own form of each is a rival: three of them, or two beside a field, would explain
 * what lost rows leave. */
static size_t rivals_max(const fg_evidence_model *model, const fg_evidence_option *option) {
  bool own = is_of_one_disc(option->effect, option->rival);
  for (size_t k = 0; k < model->parts; k++)
    own = own || is_of_one_disc(model->part[k]->effect, model->part[k]->rival);
  return own ? DISC_RIVALS_MAX : RIVALS_MAX;
}

/* Counts the named effects of a model, but for a scale: known radii show it beside any of them. */
static size_t count_named(const fg_evidence_model *model) {
  size_t count = model->named;
  for (size_t k = 0; k < model->parts; k++)
    count -= model->part[k]->effect && model->part[k]->effect->scales;
  return count;
}

/* Ripples and steps may come several times, all others once, in one of their bases. */
static bool may_join(const fg_evidence_model *model, const fg_evidence_option *option) {
  if (model->parts == FG_EVIDENCE_PARTS) return false;
  if (!fg_effect_bears_name(option->effect) &&
      model->parts - model->named >= rivals_max(model, option))
    return false;
  if (option->rival) return !holds_rival(model, option);
  if (fg_effect_bears_name(option->effect) && !option->effect->scales &&
      count_named(model) == NAMED_MAX)
    return false;
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

/* Extensions of one model that threads fit. */
typedef struct extending {
  fg_evidence_search *search;
  const fg_evidence_factor *factor;
  double gain_max;
  fg_evidence_extension *list;
  size_t count;
} extending;

/* Lists the options that may join a model, of `named` those with a name alone. */
static void list_extensions(const fg_evidence_model *from, bool named, extending *e) {
  fg_evidence_search *s = e->search;
  for (size_t o = 0; o < s->option_count && s->stored < FG_EVIDENCE_STORE; o++) {
    const fg_evidence_option *option = &s->options[o];
    if (!may_join(from, option) || (named && !fg_effect_bears_name(option->effect))) continue;
    e->list[e->count++] = (fg_evidence_extension){.option = option, .part = &s->store[s->stored++]};
  }
}

static fg_status fit_one(fg_context *ctx, void *shared, size_t item) {
  const extending *e = shared;
  fg_evidence_extension *one = &e->list[item];
  return one->option->rival ? fg_evidence_fit_rival(ctx, e->search, e->factor, one->option,
                                                    one->part, &one->evidence)
                            : fg_evidence_fit_effect(ctx, e->search, e->factor, one->option,
                                                     one->part, &one->evidence);
}

static fg_status refine_one(fg_context *ctx, void *shared, size_t item) {
  const extending *e = shared;
  if (!e->list[item].option->effect) return FG_OK;
  return fg_evidence_refine_effect(ctx, e->search, e->factor, e->gain_max, &e->list[item]);
}

static fg_status keep_extension(fg_context *ctx, fg_evidence_search *s,
                                const fg_evidence_model *from, const fg_evidence_extension *one) {
  fg_evidence_model model = *from;
  size_t count;
  if (one->moved) {
    if (!fg_evidence_has_room(&s->problem, one->part->count)) return FG_OK;
    FG_TRY(fg_evidence_add_effect(ctx, &s->problem, one->part->effect, one->part->shape,
                                  &one->part->first, &count));
  }
  model.evidence = one->evidence;
  model.part[model.parts++] = one->part;
  model.named += fg_effect_bears_name(one->option->effect);
  set_score(s, &model);
  keep_model(s, &model);
  return FG_OK;
}

/* The products of the model's columns with those of the options are known: threads would otherwise
 * write them to one place. */
static fg_status extend_model(fg_context *ctx, fg_evidence_search *s, const fg_evidence_model *from,
                              bool named) {
  fg_evidence_extension list[FG_EVIDENCE_OPTIONS];
  fg_evidence_factor factor;
  extending e = {.search = s, .factor = &factor, .list = list};
  unsigned threads = s->request.threads;
  fg_status status = FG_OK;
  FG_TRY(fg_evidence_factor_open(ctx, &s->problem, &s->scatter, from, &factor));
  list_extensions(from, named, &e);
  FG_TRY_EXIT(fg_parallel_run(ctx, threads, e.count, fit_one, &e));
  for (size_t i = 0; i < e.count; i++)
    e.gain_max = fmax(e.gain_max, list[i].evidence - factor.evidence);
  FG_TRY_EXIT(fg_parallel_run(ctx, threads, e.count, refine_one, &e));
  for (size_t i = 0; i < e.count; i++)
    FG_TRY_EXIT(keep_extension(ctx, s, from, &list[i]));
exit:
  fg_evidence_factor_close(&factor);
  return status;
}

static const fg_evidence_option *find_option(const fg_evidence_search *s,
                                             const fg_effect_found *of) {
  for (size_t o = 0; o < s->option_count; o++) {
    const fg_evidence_option *option = &s->options[o];
    if (option->effect != of->kind) continue;
    if (!of->kind->starts || (option->seeded && option->shape[0] == of->shape[0])) return option;
  }
  return NULL;
}

/* Effects added one by one do not reach all sets: what stands for two of them leads each alone. The
 * first of a set's were sized beside what the others explain: `together` fits them anew. */
static fg_status propose_set(fg_context *ctx, const fg_effect_set *set, bool together,
                             fg_evidence_search *s) {
  fg_evidence_model model = s->models[0];
  for (size_t e = 0; e < set->count; e++) {
    const fg_evidence_option *option = find_option(s, &set->effects[e]);
    fg_evidence_part *part = &s->store[s->stored];
    fg_evidence_factor factor;
    if (!option || model.parts == FG_EVIDENCE_PARTS || s->stored == FG_EVIDENCE_STORE) return FG_OK;
    FG_TRY(fg_evidence_factor_open(ctx, &s->problem, &s->scatter, &model, &factor));
    fg_status status = fg_evidence_fit_effect(ctx, s, &factor, option, part, &model.evidence);
    fg_evidence_factor_close(&factor);
    if (status != FG_OK) return status;
    s->stored++;
    model.part[model.parts++] = part;
    model.named++;
  }
  if (!model.parts) return FG_OK;
  for (int turn = 0; together && turn < 2; turn++) {
    FG_TRY(fg_evidence_refit_model(ctx, s, &model));
    FG_TRY(find_scatter(ctx, s, &model));
  }
  set_score(s, &model);
  keep_model(s, &model);
  return FG_OK;
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

/* Fits a model's parts together and finds its scatter, before it is extended. */
static fg_status prepare_model(fg_context *ctx, fg_evidence_search *s, fg_evidence_model *model) {
  if (model->parts > 1 && fg_evidence_is_named(model))
    FG_TRY(fg_evidence_refit_model(ctx, s, model));
  FG_TRY(find_scatter(ctx, s, model));
  set_score(s, model);
  return FG_OK;
}

/* Extends models of a round; their extensions have one part more and take no place of theirs. */
static fg_status extend_front(fg_context *ctx, fg_evidence_search *s, const size_t *front,
                              size_t count) {
  const fg_evidence_model *models[NAMED_FRONT + RIVAL_FRONT];
  for (size_t k = 0; k < count; k++)
    models[k] = &s->models[front[k]];
  FG_TRY(fg_evidence_find_products_ahead(ctx, s, models, count, false, may_join));
  for (size_t k = 0; k < count; k++) {
    fg_evidence_model model = *models[k];
    FG_TRY(extend_model(ctx, s, &model, false));
  }
  return FG_OK;
}

static fg_status run_rounds(fg_context *ctx, fg_evidence_search *s) {
  size_t front[NAMED_FRONT + RIVAL_FRONT], rounds = ROUNDS + (s->scatter.gauges > 0);
  for (size_t parts = 0; parts < rounds; parts++) {
    double before = s->models[0].score;
    for (size_t m = 0; m < s->count; m++)
      before = fmax(before, s->models[m].score);
    size_t count = choose_front(s, parts, front);
    for (size_t k = 0; k < count; k++)
      FG_TRY(prepare_model(ctx, s, &s->models[front[k]]));
    FG_TRY(extend_front(ctx, s, front, count));
    fg_sort_items(s->models + 1, s->count - 1, sizeof *s->models, compare_models);
    if (parts && s->models[1].score <= before + 1) break;
  }
  return FG_OK;
}

/* Fills a model without one of its parts. */
static void leave_out(const fg_evidence_model *model, size_t k, fg_evidence_model *shorter) {
  *shorter = *model;
  shorter->parts--;
  shorter->named -= fg_effect_bears_name(model->part[k]->effect);
  memmove(shorter->part + k, shorter->part + k + 1, (shorter->parts - k) * sizeof *shorter->part);
}

static bool same_shapes(const fg_evidence_model *a, const fg_evidence_model *b) {
  if (!same_parts(a, b)) return false;
  for (size_t i = 0; i < a->parts; i++) {
    size_t k = 0;
    while (k < b->parts && memcmp(a->part[i]->shape, b->part[k]->shape, sizeof a->part[i]->shape))
      k++;
    if (k == b->parts) return false;
  }
  return true;
}

/* Lists the likeliest sets of named effects without one of their parts, each once. */
static void list_rests(const fg_evidence_search *s, fg_evidence_model *rest, size_t *rests) {
  size_t sets = 0;
  for (size_t m = 1; m < s->count && sets < EXCHANGED; m++) {
    if (!fg_evidence_is_named(&s->models[m]) || s->models[m].parts < 2) continue;
    sets++;
    for (size_t k = 0; k < s->models[m].parts && *rests < EXCHANGES; k++) {
      bool known = false;
      leave_out(&s->models[m], k, &rest[*rests]);
      for (size_t r = 0; r < *rests && !known; r++)
        known = same_shapes(&rest[r], &rest[*rests]);
      *rests += !known;
    }
  }
}

/* Exchanges every part of the likeliest sets of named effects for another one, and fits it anew
 * beside the rest: what leads alone need not be of the best pair, nor is its shape the same. */
static fg_status exchange_parts(fg_context *ctx, fg_evidence_search *s) {
  fg_evidence_model rest[EXCHANGES];
  const fg_evidence_model *models[EXCHANGES];
  size_t rests = 0, done = 0;
  for (size_t k = 0; k < EXCHANGES; k++)
    models[k] = &rest[k];
  for (int round = 0; round < EXCHANGE_ROUNDS; round++) {
    list_rests(s, rest, &rests);
    if (done < rests)
      FG_TRY(fg_evidence_find_products_ahead(ctx, s, models + done, rests - done, true, may_join));
    for (; done < rests; done++)
      FG_TRY(extend_model(ctx, s, &rest[done], true));
    fg_sort_items(s->models + 1, s->count - 1, sizeof *s->models, compare_models);
  }
  return FG_OK;
}

/* Leaves out causes that became needless beside those added later. */
static fg_status shorten_models(fg_context *ctx, fg_evidence_search *s) {
  size_t count = s->count < SHORTENED ? s->count : SHORTENED;
  for (size_t m = 1; m < count; m++)
    for (size_t k = 0; s->models[m].parts > 1 && k < s->models[m].parts; k++) {
      fg_evidence_model shorter;
      leave_out(&s->models[m], k, &shorter);
      FG_TRY(evaluate(ctx, s, &shorter));
      set_score(s, &shorter);
      keep_model(s, &shorter);
    }
  fg_sort_items(s->models + 1, s->count - 1, sizeof *s->models, compare_models);
  return FG_OK;
}

/* A form that discs have alike is scatter to every model that lacks it: a model with it is scored
 * by the scatter it leaves. */
static bool explains_scatter(const fg_evidence_search *s, const fg_evidence_model *model) {
  return s->problem.edge_fit->discs && model->parts == 1 && model->part[0]->rival;
}

/* Fits the likeliest models together, and finds the scatter of the bumps beside them. Sets of named
 * effects alone get as many turns where those of one that holds a rival fill the first places. */
static fg_status refit_models(fg_context *ctx, fg_evidence_search *s) {
  double top = s->models[0].score;
  size_t named = 0;
  for (size_t m = 0; m < s->count; m++) {
    fg_evidence_model *model = &s->models[m];
    bool among_named = fg_evidence_is_named(model) && model->parts && named++ < NAMED_REFITTED;
    if (m >= SCATTERED && !among_named && !explains_scatter(s, model)) continue;
    if ((m < REFITTED || among_named) && model->parts > 1 && model->score > top - REACH)
      FG_TRY(fg_evidence_refit_model(ctx, s, model));
    FG_TRY(find_scatter(ctx, s, model));
    set_score(s, model);
  }
  return FG_OK;
}

fg_status fg_evidence_search_open(fg_context *ctx, const fg_edge_fit *edge_fit,
                                  const fg_evidence_request *request, const double *residual_um,
                                  const double *jacobian, fg_evidence_search *s) {
  *s = (fg_evidence_search){.request = *request};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_evidence_open(ctx, edge_fit, residual_um, jacobian, &s->problem));
  FG_TRY_EXIT(fg_memory_allocate(ctx, FG_EVIDENCE_STORE, sizeof *s->store, (void **)&s->store));
  FG_TRY_EXIT(fg_memory_allocate(ctx, FG_EVIDENCE_MODELS, sizeof *s->models, (void **)&s->models));
  FG_TRY_EXIT(fg_evidence_list_options(ctx, jacobian, s));
exit:
  if (status != FG_OK) fg_evidence_search_close(s);
  return status;
}

fg_status fg_evidence_search_run(fg_context *ctx, fg_evidence_search *s) {
  fg_evidence_model none = {.parts = 0};
  s->count = s->stored = 0;
  for (int which = 0; which < FG_EVIDENCE_SPREADS; which++)
    none.scatter_um[which] = scatter_um(s, which, SCATTERS_TRIED / 2);
  FG_TRY(find_scatter(ctx, s, &none));
  s->models[s->count++] = none;
  FG_TRY(run_rounds(ctx, s));
  for (size_t k = 0; k < s->request.seeds; k++)
    FG_TRY(propose_set(ctx, &s->request.seed[k], k == 0, s));
  fg_sort_items(s->models + 1, s->count - 1, sizeof *s->models, compare_models);
  FG_TRY(exchange_parts(ctx, s));
  FG_TRY(shorten_models(ctx, s));
  FG_TRY(refit_models(ctx, s));
  fg_sort_items(s->models, s->count, sizeof *s->models, compare_models);
  return FG_OK;
}

void fg_evidence_search_close(fg_evidence_search *s) {
  fg_evidence_close(&s->problem);
  free(s->store);
  free(s->models);
  free(s->options);
  *s = (fg_evidence_search){.count = 0};
}

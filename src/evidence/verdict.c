/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/verdict.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "evidence/unnamed.h"

/* Share of the whole evidence by which a cause leads, too: with edges so sharp the error of linear
 * columns decides. */
#define LEAD_SHARE 3e-4
/* The same where the edges lie so far from where the columns were taken that these err. */
#define LEAD_SHARE_FAR 0.03
#define CLEAN_P        0.05
/* Standard errors of the number that gives a polynomial its name; largest distance of its middle,
 * in picture sizes: else it is a lower one. */
#define LEADING_SIGMAS 2.0
#define MIDDLE_REACH   1.5
/* Causes at once from which they are as likely the pieces of one that nobody has named: about one
 * is expected (FG_EVIDENCE_PRIOR), so each further one is a chance of 3 %, while the shape of an
 * unnamed cause takes as many pieces as it needs. */
enum { PIECES = 3 };
/* Share of the whole evidence from which a jump is certain beside what has no name: that follows
 * nothing so well that a small one is not a part of it. */
#define CERTAIN_SHARE 0.1
/* Share of the lowest polynomial in a crown or skew. */
#define LOWEST_SHARE 0.6

/* ---- models whose numbers do not bear their name ---- */

static bool polynomial_deserves_name(const fg_evidence_search *s, const fg_evidence_part *part,
                                     const double *mean, const double *covariance, size_t n,
                                     double *middle_mm) {
  size_t lead = part->count - 1;
  const fg_field_frame *frame = &s->problem.edge_fit->frame;
  int axis = part->effect->axis;
  double extent = fmax(frame->high_mm[0] - frame->low_mm[0], frame->high_mm[1] - frame->low_mm[1]);
  if (!lead) return true;
  if (fabs(mean[lead]) < LEADING_SIGMAS * sqrt(covariance[lead * n + lead])) return false;
  double t = -mean[lead - 1] / ((double)part->count * mean[lead]);
  *middle_mm = frame->centre_mm[axis] + FG_FIELD_HALF_MM * t;
  return fabs(t) * FG_FIELD_HALF_MM <= MIDDLE_REACH * extent;
}

/* Gain, ln, up to which a cause may be an error of the columns. */
static double margin_of(const fg_evidence_search *s, double share) {
  return fmax(FG_EVIDENCE_LEAD, share * s->models[0].score);
}

/* A scale along one way is, but for the size of the whole, one along the other. */
static bool holds_scale(const fg_evidence_model *model) {
  for (size_t k = 0; k < model->parts; k++) {
    const fg_effect *effect = model->part[k]->effect;
    if (effect && effect->polynomial == FG_EFFECT_LINEAR) return true;
  }
  return false;
}

/* Returns true where a cubic has as much of its lowest power as its middle gives: the rest would be
 * a scale. */
static bool is_cubic_alone(const double *mean, const double *covariance, size_t n, double margin) {
  double ratio = mean[1] / (3 * mean[2]), excess = mean[0] - ratio * mean[1], variance = 0;
  const double by[] = {1, -2 * ratio, 3 * ratio * ratio};
  for (size_t i = 0; i < 3; i++)
    for (size_t k = 0; k < 3; k++)
      variance += by[i] * by[k] * covariance[i * n + k];
  return excess * excess <= 2 * margin * variance;
}

static bool lowest_leads(fg_evidence_problem *p, const fg_evidence_part *part, const double *mean) {
  double lead = 0, rest = 0;
  for (size_t c = 0; c < part->count; c++) {
    double square;
    fg_evidence_products(p, part->first + c, part->first + c, 1, &square);
    *(c ? &rest : &lead) += mean[c] * mean[c] * square;
  }
  return lead >= LOWEST_SHARE * (lead + rest);
}

/* Returns true for an effect that extends another one by its first number. */
static bool is_extension(const fg_effect *effect) {
  return effect && effect->extends && effect->numbers == FG_EFFECT_LED;
}

/* `mean` and `covariance` begin with the numbers of the effect. */
static bool has_defining_column(const fg_effect *effect, const double *mean,
                                const double *covariance) {
  if (!is_extension(effect)) return true;
  return fabs(mean[0]) >= LEADING_SIGMAS * sqrt(covariance[0]);
}

static bool holds_extension(const fg_evidence_model *model) {
  for (size_t k = 0; k < model->parts; k++)
    if (is_extension(model->part[k]->effect)) return true;
  return false;
}

fg_status fg_evidence_has_defining_columns(fg_context *ctx, fg_evidence_search *s,
                                           const fg_evidence_model *model, bool *has) {
  fg_evidence_posterior posterior;
  *has = true;
  if (!holds_extension(model)) return FG_OK;
  FG_TRY(fg_evidence_find_posterior(ctx, s, model, &posterior));
  for (size_t k = 0; k < model->parts; k++) {
    size_t at = fg_evidence_first_of(s, model, k), n = posterior.count;
    *has = *has && has_defining_column(model->part[k]->effect, posterior.mean + at,
                                       posterior.covariance + at * n + at);
  }
  fg_evidence_posterior_close(&posterior);
  return FG_OK;
}

static fg_status deserves_names(fg_context *ctx, fg_evidence_search *s,
                                const fg_evidence_model *model, double middle_mm[FG_EVIDENCE_PARTS],
                                bool *deserves) {
  fg_evidence_posterior posterior;
  *deserves = true;
  FG_TRY(fg_evidence_find_posterior(ctx, s, model, &posterior));
  for (size_t k = 0; k < model->parts; k++) {
    const fg_evidence_part *part = model->part[k];
    size_t at = fg_evidence_first_of(s, model, k), n = posterior.count;
    const double *mean = posterior.mean + at, *covariance = posterior.covariance + at * n + at;
    middle_mm[k] = NAN;
    if (!part->effect) continue;
    if (part->effect->polynomial)
      *deserves =
          *deserves && polynomial_deserves_name(s, part, mean, covariance, n, &middle_mm[k]);
    if (part->effect->polynomial == FG_EFFECT_CUBIC && !holds_scale(model))
      *deserves = *deserves && is_cubic_alone(mean, covariance, n, margin_of(s, LEAD_SHARE));
    *deserves = *deserves && has_defining_column(part->effect, mean, covariance);
    if (part->effect->bends) *deserves = *deserves && lowest_leads(&s->problem, part, mean);
  }
  fg_evidence_posterior_close(&posterior);
  return FG_OK;
}

/* ---- what leads ---- */

static bool holds_rival_of(const fg_evidence_model *model, const fg_evidence_part *rival) {
  for (size_t k = 0; k < model->parts; k++)
    if (model->part[k]->rival == rival->rival && model->part[k]->stretch == rival->stretch)
      return true;
  return false;
}

/* Returns true for an effect in a model, or one that is it with a number of 0. */
static bool holds_or_extends(const fg_evidence_model *model, const fg_effect *effect) {
  for (size_t k = 0; k < model->parts; k++) {
    const fg_effect *own = model->part[k]->effect;
    if (own && own->extends && !strcmp(own->extends, effect->id)) return true;
  }
  return fg_evidence_holds(model, effect);
}

bool fg_evidence_includes(const fg_evidence_model *model, const fg_evidence_model *other) {
  for (size_t k = 0; k < other->parts; k++) {
    const fg_evidence_part *part = other->part[k];
    if (part->effect ? !holds_or_extends(model, part->effect) : !holds_rival_of(model, part))
      return false;
  }
  return true;
}

static double probability_of_none(const fg_evidence_search *s) {
  double sum = 0, none = 0, top = 0;
  for (size_t m = 0; m < s->count; m++)
    top = fmax(top, s->models[m].score);
  for (size_t m = 0; m < s->count; m++) {
    double weight = exp(s->models[m].score - top);
    sum += weight;
    if (!s->models[m].parts) none = weight;
  }
  return none / sum;
}

/* Models that a tie is chosen from. */
typedef struct tie_range {
  double floor;                     /* score */
  const fg_evidence_model *unnamed; /* those without a name alone, no larger than this one; NULL:
                                        all */
} tie_range;

static bool is_in_range(const fg_evidence_model *model, const tie_range *range) {
  if (!model->parts) return false; /* it was refuted */
  return !range->unnamed || (!model->named && model->parts <= range->unnamed->parts);
}

/* Returns true for a model of all causes of another and some more; on discs also for one of the
 * same causes of which one is there twice. */
static bool is_more(const fg_evidence_search *s, const fg_evidence_model *model,
                    const fg_evidence_model *other) {
  return fg_evidence_includes(model, other) &&
         (!fg_evidence_includes(other, model) ||
          (s->problem.edge_fit->discs && model->parts > other->parts));
}

/* Lists the models of a range that include no other one of them. */
static fg_status list_ties(fg_context *ctx, fg_evidence_search *s, const tie_range *range,
                           fg_evidence_verdict *v) {
  for (size_t m = 0; m < s->count && v->ties < FG_EVIDENCE_TIES; m++) {
    const fg_evidence_model *model = &s->models[m];
    bool deserves = true, more = false;
    if (model->score < range->floor) break; /* sorted */
    if (!is_in_range(model, range)) continue;
    for (size_t k = 0; k < v->ties && !more; k++)
      more = fg_evidence_includes(model, &v->tie[k]) &&
             !(s->problem.edge_fit->discs && model->parts < v->tie[k].parts);
    if (more) continue;
    FG_TRY(deserves_names(ctx, s, model, v->middle_mm[v->ties], &deserves));
    if (deserves) v->tie[v->ties++] = *model;
  }
  /* a smaller one may have come later */
  size_t kept = 0;
  for (size_t k = 0; k < v->ties; k++) {
    bool more = false;
    for (size_t i = 0; i < v->ties && !more; i++)
      more = i != k && is_more(s, &v->tie[k], &v->tie[i]);
    if (more) continue;
    for (size_t i = 0; i < FG_EVIDENCE_PARTS; i++)
      v->middle_mm[kept][i] = v->middle_mm[k][i];
    v->tie[kept++] = v->tie[k];
  }
  v->ties = kept;
  return FG_OK;
}

/* Returns true for the set about which the columns were taken: beside it they do not err. */
static bool is_about(const fg_evidence_search *s, const fg_evidence_model *model) {
  const fg_effect_set *about = s->request.seeds ? &s->request.seed[0] : NULL;
  if (!about || about->count != model->parts) return false;
  for (size_t k = 0; k < about->count; k++)
    if (!fg_evidence_holds(model, about->effects[k].kind)) return false;
  return true;
}

/* Moves from a set of named effects to the likeliest one that has more of them, where what that
 * gains is no error of the columns. */
static fg_status take_more(fg_context *ctx, fg_evidence_search *s, const fg_evidence_model **best) {
  const fg_evidence_model *from = *best;
  double middle_mm[FG_EVIDENCE_PARTS];
  for (size_t m = 0; from && s->models[m].score > from->score + FG_EVIDENCE_LEAD; m++) {
    const fg_evidence_model *model = &s->models[m];
    bool deserves = fg_evidence_is_named(model) && fg_evidence_includes(model, from) &&
                    (is_about(s, from) || is_about(s, model));
    if (deserves) FG_TRY(deserves_names(ctx, s, model, middle_mm, &deserves));
    if (!deserves) continue;
    *best = model;
    return FG_OK;
  }
  return FG_OK;
}

/* The score of the set of named effects alone whose numbers bear their names, of the fewest effects
 * within the margin of the best model: what more would gain is too little to be told from errors of
 * the columns; `far`: of the likeliest. -INFINITY: there is none. */
static fg_status find_best_named(fg_context *ctx, fg_evidence_search *s, bool far, double margin,
                                 double *score) {
  double middle_mm[FG_EVIDENCE_PARTS], top = s->models[0].score;
  const fg_evidence_model *best = NULL;
  for (size_t m = 0; m < s->count && s->models[m].score >= top - margin; m++) {
    const fg_evidence_model *model = &s->models[m];
    bool deserves = fg_evidence_is_named(model) && (!best || (!far && model->parts < best->parts));
    if (deserves) FG_TRY(deserves_names(ctx, s, model, middle_mm, &deserves));
    if (deserves) best = model;
  }
  if (!far) FG_TRY(take_more(ctx, s, &best));
  *score = best ? best->score : -INFINITY;
  return FG_OK;
}

/* Of models that the edges do not tell apart one of named effects alone comes first, and is fitted,
 * unless it needs more causes than the likeliest. */
static void put_named_first(fg_evidence_verdict *v) {
  size_t first = 0;
  while (first < v->ties &&
         (!fg_evidence_is_named(&v->tie[first]) || v->tie[first].parts > v->tie[0].parts))
    first++;
  if (first == v->ties) return;
  const fg_evidence_model model = v->tie[first];
  double middle_mm[FG_EVIDENCE_PARTS];
  memcpy(middle_mm, v->middle_mm[first], sizeof middle_mm);
  memmove(v->tie + 1, v->tie, first * sizeof *v->tie);
  memmove(v->middle_mm + 1, v->middle_mm, first * sizeof *v->middle_mm);
  v->tie[0] = model;
  memcpy(v->middle_mm[0], middle_mm, sizeof middle_mm);
}

static void add_tie(const fg_evidence_model *model, fg_evidence_verdict *v) {
  for (size_t k = 0; k < FG_EVIDENCE_PARTS; k++)
    v->middle_mm[v->ties][k] = NAN;
  v->tie[v->ties++] = *model;
}

/* The likeliest model with a rival stands for all where none bears its names: its rivals are shown.
 */
static void take_likeliest_rivals(const fg_evidence_search *s, fg_evidence_verdict *v) {
  size_t m = 0;
  while (m + 1 < s->count && fg_evidence_is_named(&s->models[m]))
    m++;
  add_tie(&s->models[m], v);
}

/* Steps count once: rows are lost one by one, for one reason. Scales and shears count not: every
 * scanner has them. */
static size_t count_pieces(const fg_evidence_model *model) {
  size_t count = 0, steps = 0;
  for (size_t k = 0; k < model->parts; k++) {
    const fg_effect *effect = model->part[k]->effect;
    if (effect->numbers == FG_EFFECT_RATIO) continue;
    *(effect->jumps ? &steps : &count) += 1;
  }
  return count + (steps > 0);
}

/* Returns the likeliest model without a named effect that is no clean scan; NULL: there is none. */
static const fg_evidence_model *find_unnamed(const fg_evidence_search *s) {
  for (size_t m = 0; m < s->count; m++)
    if (s->models[m].parts && !s->models[m].named) return &s->models[m];
  return NULL;
}

/* Returns the model of the fewest causes, none of them named, within the margin of the best one;
 * NULL: there is none. */
static const fg_evidence_model *find_fewest_unnamed(const fg_evidence_search *s, double margin) {
  const fg_evidence_model *best = NULL;
  for (size_t m = 0; m < s->count && s->models[m].score >= s->models[0].score - margin; m++) {
    const fg_evidence_model *model = &s->models[m];
    if (model->parts && !model->named && (!best || model->parts < best->parts)) best = model;
  }
  return best;
}

/* Returns the fewest pieces of the sets in a tie; 0: one of them has no name. */
static size_t fewest_pieces(const fg_evidence_verdict *v) {
  size_t fewest = FG_EVIDENCE_PARTS;
  for (size_t k = 0; k < v->ties; k++) {
    size_t pieces = fg_evidence_is_named(&v->tie[k]) ? count_pieces(&v->tie[k]) : 0;
    fewest = pieces < fewest ? pieces : fewest;
  }
  return fewest;
}

/* Returns the model without a name of which so many named causes may be the pieces; NULL: there is
 * none. Of two it is one of fewer causes that explains as well, up to errors of the columns. */
static const fg_evidence_model *find_rival_of_pieces(const fg_evidence_search *s, size_t pieces,
                                                     double margin) {
  if (pieces >= PIECES) return find_unnamed(s);
  const fg_evidence_model *unnamed = find_fewest_unnamed(s, margin);
  return unnamed && unnamed->parts < pieces ? unnamed : NULL;
}

/* Names beside what has none are no evidence where that explains as well alone, up to errors of the
 * columns: they are pieces of it. */
static tie_range choose_range(const fg_evidence_search *s, double named, double margin) {
  if (isfinite(named)) return (tie_range){.floor = named - FG_EVIDENCE_LEAD};
  const fg_evidence_model *unnamed = find_fewest_unnamed(s, margin);
  double score = unnamed ? unnamed->score : s->models[0].score;
  return (tie_range){score - FG_EVIDENCE_LEAD, unnamed};
}

/* Returns the score of the likeliest model without any of `count` effects. */
static double find_score_without(const fg_evidence_search *s, const fg_effect *const *effects,
                                 size_t count) {
  for (size_t m = 0; m < s->count; m++) { /* sorted */
    size_t e = 0;
    while (e < count && !fg_evidence_holds(&s->models[m], effects[e]))
      e++;
    if (e == count) return s->models[m].score;
  }
  return -INFINITY;
}

static bool holds_rival_over(const fg_evidence_model *model, int axis) {
  for (size_t k = 0; k < model->parts; k++) {
    const fg_evidence_part *part = model->part[k];
    bool unnamed = !fg_effect_bears_name(part->effect);
    fg_effect_coordinate over = part->rival ? part->rival->coordinate : part->effect->coordinate;
    if (unnamed && over == (axis ? FG_EFFECT_Y : FG_EFFECT_X)) return true;
  }
  return false;
}

/* A jump of the picture is no piece of what changes smoothly over something else, nor of the forms
 * of discs: it is found beside them where every explanation without it is refuted. On a foil, whose
 * bumps end in jumps of their own, it is not. */
static void find_certain(const fg_evidence_search *s, double margin, fg_evidence_verdict *v) {
  const fg_evidence_model *model = &v->tie[0];
  double gain_min = fmax(margin, CERTAIN_SHARE * model->score);
  for (size_t k = 0; s->problem.edge_fit->discs && v->ties == 1 && k < model->parts; k++) {
    const fg_effect *effect = model->part[k]->effect;
    v->certain[k] = fg_effect_bears_name(effect) && effect->jumps &&
                    !holds_rival_over(model, effect->axis) &&
                    find_score_without(s, &effect, 1) < model->score - gain_min;
  }
}

/* Returns the score of the likeliest model without the named effects of tie[0] but for the certain
 * ones. */
static double score_without_names(const fg_evidence_search *s, const fg_evidence_verdict *v) {
  const fg_effect *effects[FG_EVIDENCE_PARTS];
  size_t count = 0;
  for (size_t k = 0; k < v->tie[0].parts; k++) {
    const fg_effect *effect = v->tie[0].part[k]->effect;
    if (!v->certain[k] && fg_effect_bears_name(effect)) effects[count++] = effect;
  }
  return find_score_without(s, effects, count);
}

/* Sharp edges show errors of the columns themselves: a set of named effects is adequate up to a
 * share of the evidence. What leads it by less is no rival; what follows it closely is. */
fg_status fg_evidence_decide(fg_context *ctx, fg_evidence_search *s, bool far,
                             fg_evidence_verdict *v) {
  double margin = margin_of(s, far ? LEAD_SHARE_FAR : LEAD_SHARE), named;
  *v = (fg_evidence_verdict){
      .outcome = FG_EVIDENCE_CLEAN, .p_null = probability_of_none(s), .margin = margin};
  if (v->p_null > CLEAN_P || !s->models[0].parts) return FG_OK;
  FG_TRY(find_best_named(ctx, s, far, margin, &named));
  const tie_range range = choose_range(s, named, margin);
  FG_TRY(list_ties(ctx, s, &range, v));
  if (!v->ties) take_likeliest_rivals(s, v);
  if (isfinite(named)) put_named_first(v);
  const fg_evidence_model *unnamed = find_rival_of_pieces(s, fewest_pieces(v), margin);
  if (isfinite(named) && unnamed && v->ties < FG_EVIDENCE_TIES) add_tie(unnamed, v);
  v->outcome = !isfinite(named) ? FG_EVIDENCE_UNATTRIBUTED
               : v->ties > 1    ? FG_EVIDENCE_TIED
                                : FG_EVIDENCE_FOUND;
  if (v->outcome == FG_EVIDENCE_UNATTRIBUTED) find_certain(s, margin, v);
  v->score_without = score_without_names(s, v);
  return FG_OK;
}

bool fg_evidence_choose_unnamed(const fg_evidence_search *s, fg_evidence_verdict *v) {
  const fg_evidence_model *unnamed = find_unnamed(s);
  if (!unnamed) return false;
  v->ties = 0;
  v->outcome = FG_EVIDENCE_UNATTRIBUTED;
  memset(v->certain, 0, sizeof v->certain);
  add_tie(unnamed, v);
  return true;
}

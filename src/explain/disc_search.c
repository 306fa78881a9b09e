/* Which effects explain the points of discs.
 *
 * A plate tells the smooth effects apart, so sets of up to five are tried, and a set must not leave
 * one out that takes more than chance: the discs' own forms are in the noise and in the free curves
 * alike. Ripples and steps are looked for one at a time, in units of the noise that they leave.
 */
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "explain/search.h"

/* A set is right when what it leaves beyond all effects is likelier than this. */
#define ACCEPT_P 0.001
/* Gain in chi² of one effect that is no chance. */
#define ONE_MORE_CHI2 12.0
/* Error of the edge model, um: effects below it are not told apart. */
#define EDGE_ERROR_UM 0.01

/* Residual sum with the effects of a mask fitted, the geometry being out, `last` (or NULL) behind
 * the others: `last_u` gets its standard deviation for noise of 1 um. */
static double residual_sum(const fg_explain_search *s, unsigned mask, const fg_candidate *last,
                           double *freedom, double *last_u) {
  fg_explain_term term[FG_EXPLAIN_TERMS];
  size_t n = 0, rank;
  for (int behind = 0; behind < 2; behind++)
    for (size_t e = 0; e < s->out->candidate_count; e++) {
      const fg_candidate *effect = &s->out->candidates[e];
      if (!(mask >> e & 1) || (effect == last) != behind) continue;
      for (size_t c = 0; c < effect->terms && n < FG_EXPLAIN_TERMS; c++)
        term[n++] = (fg_explain_term){1, {effect->column[c]}, {1}};
    }
  double sum = fg_explain_solve(&s->columns, term, n, NULL, last_u, &rank);
  *freedom = (double)rank;
  return sum;
}

/* The gain in units of the noise that the effect leaves: where it is most of the residual, the
 * noise that it stands against must not hold it. */
static double gain_over_rest(fg_explain_search *s, size_t rank, const fg_candidate *effect) {
  double before = fg_explain_dot(s->columns.rows, s->columns.left, s->columns.left), share;
  size_t first, kept = s->columns.count;
  size_t count = fg_explain_columns_add(&s->columns, effect->kind, effect->shape, &first, &share);
  rank = fg_explain_columns_span_more(&s->columns, rank, first, first + count);
  double after = fg_explain_dot(s->columns.rows, s->columns.left, s->columns.left);
  double noise = after / fmax((double)s->columns.rows - (double)rank, 1);
  double gain = noise > 0 ? (before - after) / (noise * fg_explain_integral(&s->columns)) : 0;
  s->columns.count = kept; /* it was on trial */
  return gain;
}

/* Ripples and steps stand alone even in one scan: they are sought beside all smooth effects. One at
 * a time: what a step leaves across itself would be read as a second one; and each can be read as
 * several of the other: the better one. */
static fg_status find_shaped_effects(fg_context *ctx, fg_explain_search *s) {
  fg_candidate best = {0};
  double *work = NULL, most = 0;
  if (s->out->candidate_count >= FG_CANDIDATES_MAX) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, s->columns.rows, 2 * sizeof *work, (void **)&work));
  for (const fg_effect *kind = fg_effect_first(); kind; kind = fg_effect_next(kind)) {
    if (kind->sought != FG_EFFECT_PLACED || !fg_effect_shows(s->columns.points, kind)) continue;
    size_t rank = fg_explain_noise(s, false);
    fg_explain_hit hit = fg_explain_find_place(s, rank, kind, work);
    fg_candidate found = {.kind = kind, .shape = {hit.at}};
    if (!(hit.gain > 0) || hit.amplitude <= FG_EXPLAIN_SHAPED_LEAST_UM) continue;
    double gain = gain_over_rest(s, rank, &found);
    if (gain <= fmax(most, FG_EXPLAIN_SHAPED_CHI2)) continue;
    most = gain;
    best = found;
  }
  free(work);
  if (most > 0) {
    fg_explain_add(s, &best);
    s->new_shapes++;
  }
  return FG_OK;
}

/* What the search compares with: everything at once. */
typedef struct yardstick {
  double full, freedom, unit, allowance;
} yardstick;

static fg_explanation try_set(const fg_explain_search *s, const yardstick *y, unsigned mask) {
  double used, left = residual_sum(s, mask, NULL, &used, NULL);
  return (fg_explanation){
      .mask = mask, .excess = fmax(0, left - y->full) / y->unit, .freedom = y->freedom - used};
}

static bool is_right(const yardstick *y, const fg_explanation *m) {
  return m->excess <=
         (m->freedom > 0 ? gsl_cdf_chisq_Qinv(ACCEPT_P, m->freedom) : 0) + y->allowance;
}

/* Whether one more listed effect takes more than chance. The forms of the discs are in the noise
 * and in the free curves alike, so that the sum of all of them says little of one. */
static bool one_more_helps(const fg_explain_search *s, const yardstick *y,
                           const fg_explanation *m) {
  for (size_t e = 0; e < s->out->candidate_count; e++) {
    if (fg_effect_is_free(s->out->candidates[e].kind) || (m->mask >> e & 1)) continue;
    if (m->excess - try_set(s, y, m->mask | 1u << e).excess > ONE_MORE_CHI2) return true;
  }
  return false;
}

/* Listed sets by size; the first size with one that is right ends the search. */
static fg_explanation try_listed(fg_explain_search *s, const yardstick *y, size_t most) {
  unsigned listed = fg_explain_mask_of(s->out, false);
  fg_explanation best = {.excess = INFINITY};
  for (size_t size = 0; size <= most && !s->out->count; size++)
    for (unsigned mask = 0; mask <= listed; mask++) {
      if ((mask & ~listed) || fg_explain_bits(mask) != size) continue;
      fg_explanation explanation = try_set(s, y, mask);
      if (is_right(y, &explanation) && !one_more_helps(s, y, &explanation))
        fg_explain_keep(s->out, &explanation);
      if (explanation.excess < best.excess - 12) best = explanation;
    }
  return best;
}

/* A free curve, alone or beside one listed effect: the one that leaves least for its columns
 * (Schwarz's criterion); the best listed set stands when none does better. */
static void try_free(fg_explain_search *s, const yardstick *y, fg_explanation best) {
  fg_explanations *out = s->out;
  double price = log((double)s->columns.rows / out->integral);
  double score = best.excess - price * best.freedom;
  for (size_t e = 0; e < out->candidate_count; e++)
    for (size_t with = 0;
         with <= out->candidate_count && fg_effect_is_free(out->candidates[e].kind); with++) {
      if (with < out->candidate_count && fg_effect_is_free(out->candidates[with].kind)) continue;
      unsigned mask = 1u << e | (with < out->candidate_count ? 1u << with : 0);
      fg_explanation explanation = try_set(s, y, mask);
      if (explanation.excess - price * explanation.freedom >= score - 10) continue;
      score = explanation.excess - price * explanation.freedom;
      best = explanation;
    }
  out->right = is_right(y, &best);
  fg_explain_keep(out, &best);
}

/* How many effects the points can tell apart. */
static size_t effects_most(const fg_points *points) {
  return points->coarse ? 1 : points->part_count > 2 ? 5 : 2;
}

static void try_sets(fg_explain_search *s) {
  fg_explanations *out = s->out;
  yardstick y = {.unit = out->noise_um * out->noise_um * out->integral};
  y.full = s->full;
  y.freedom = (double)s->freedom;
  y.allowance = (double)s->columns.rows * EDGE_ERROR_UM * EDGE_ERROR_UM / y.unit;
  fg_explanation best = try_listed(s, &y, effects_most(s->columns.points));
  out->right = out->count > 0;
  /* A ripple or step that was found just now has not been fitted with the geometry yet. */
  if (!out->count && s->new_shapes) fg_explain_keep(out, &best);
  if (!out->count) try_free(s, &y, best);
  double used, none = residual_sum(s, 0, NULL, &used, NULL);
  out->p_value =
      gsl_cdf_chisq_Q(fmax(0, none - y.full) / y.unit / (1 + y.allowance / y.freedom), y.freedom);
  for (size_t e = 0; e < out->candidate_count; e++) {
    double u = 0;
    unsigned lone = 1u << e;
    out->alone[e] = 1 - residual_sum(s, lone, NULL, &used, NULL) / none;
    if (fg_effect_is_free(out->candidates[e].kind)) continue;
    /* Three and a half standard deviations beside the winner: found in most cases. */
    unsigned beside = out->each[0].mask & fg_explain_mask_of(out, false);
    residual_sum(s, beside | lone, &out->candidates[e], &used, &u);
    out->smallest_um[e] = 3.5 * sqrt(y.unit) * u;
  }
}

static const fg_effect_found *find_known(const fg_effect_set *known, const fg_effect *kind) {
  for (size_t e = 0; known && e < known->count; e++)
    if (known->effects[e].kind == kind) return &known->effects[e];
  return NULL;
}

/* The smooth ones; the middle of a polynomial is the picture's until a fit has found it. */
static fg_status add_smooth(fg_context *ctx, fg_explain_search *s, const fg_effect_set *known) {
  for (const fg_effect *kind = fg_effect_first(); kind; kind = fg_effect_next(kind)) {
    fg_candidate effect = {.kind = kind};
    const fg_effect_found *from = find_known(known, kind);
    if (kind->sought == FG_EFFECT_PLACED || !fg_effect_shows(s->columns.points, kind)) continue;
    if (kind->start) {
      FG_TRY(fg_explain_add_shaped(ctx, s, kind, known));
      continue;
    }
    if (kind->shapes) effect.shape[0] = s->columns.points->frame.centre_mm[kind->axis];
    if (kind->shapes && from) effect.shape[0] = from->shape[0];
    fg_explain_add(s, &effect);
  }
  return FG_OK;
}

/* Ripples and steps that are in force. */
static void add_known(fg_explain_search *s, const fg_effect_set *known) {
  for (size_t e = 0; known && e < known->count; e++) {
    const fg_effect_found *from = &known->effects[e];
    fg_candidate effect = {.kind = from->kind};
    memcpy(effect.shape, from->shape, sizeof effect.shape);
    if (from->kind->sought == FG_EFFECT_PLACED && s->out->candidate_count < FG_CANDIDATES_MAX)
      fg_explain_add(s, &effect);
  }
}

fg_status fg_explain_discs_find(fg_context *ctx, const fg_points *points, const double *residual_um,
                                const double *jacobian, const fg_effect_set *known,
                                fg_explanations *explanations) {
  memset(explanations, 0, sizeof *explanations);
  fg_explain_search s = {.out = explanations};
  fg_status status = FG_OK;
  FG_TRY(fg_explain_columns_open(ctx, points, residual_um, jacobian, &s.columns));
  FG_TRY_EXIT(add_smooth(ctx, &s, known));
  add_known(&s, known);
  FG_TRY_EXIT(find_shaped_effects(ctx, &s));
  fg_explain_noise(&s, false);
  FG_TRY_EXIT(fg_explain_check_rows(ctx, &s));
  try_sets(&s);
exit:
  fg_explain_columns_close(&s.columns);
  return status;
}

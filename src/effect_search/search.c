/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One search: candidates beside the geometry, the noise that they leave, and sets of them. */
#include "effect_search/search.h"

#include <string.h>

#include "effect/columns.h"
#include "effect_search/policy.h"

/* Selects the curve's columns for the set of all effects: half as many, and one basis. */
static void choose_parts(fg_search_columns *c, const fg_candidate *effect) {
  const fg_effect *kind = effect->kind;
  for (size_t k = 0; k < effect->columns; k++) {
    bool splines = kind->coarse == FG_EFFECT_SPLINES;
    bool rough = kind->coarse == FG_EFFECT_LEFT_OUT || (splines && k % 2 > 0) ||
                 (kind->coarse == FG_EFFECT_SMOOTHER && k >= kind->rough[0] && k < kind->rough[1]);
    c->part[effect->column[k]] = rough     ? FG_SEARCH_LEFT_OUT
                                 : splines ? FG_SEARCH_WITH_NEXT
                                           : FG_SEARCH_ITSELF;
  }
}

/* Adds a polynomial of the scanner, made of the powers of its axis from column `first` on: the
 * highest is its own, the lower ones give its middle. */
static void add_of_powers(fg_search *s, const fg_effect *kind, size_t first) {
  size_t e = s->out->candidate_count++, degree = kind->polynomial - FG_EFFECT_LINEAR;
  fg_candidate *to = &s->out->candidates[e];
  *to = (fg_candidate){.kind = kind,
                       .polynomial = kind->polynomial,
                       .columns = kind->columns,
                       .shapes = kind->shapes,
                       .terms = kind->polynomial == FG_EFFECT_QUADRATIC ? 2 : 1};
  for (size_t k = 0; k <= degree; k++)
    to->column[k] = first + degree - k;
  size_t lead = to->column[0];
  s->out->share[e] = s->columns.gram[lead * FG_SEARCH_COLUMNS + lead] / (double)s->columns.rows;
}

/* Adds a polynomial whose middle is the picture's until a fit has found it. */
static void add_with_middle(fg_search *s, const fg_effect *kind, const fg_effect_set *known) {
  fg_candidate effect = {.kind = kind};
  const fg_effect_found *from = fg_search_find_known(known, kind);
  if (kind->shapes) effect.shape[0] = s->columns.edge_fit->frame.centre_mm[kind->axis];
  if (kind->shapes && from) effect.shape[0] = from->shape[0];
  fg_search_add(s, &effect);
}

static void add_curve(fg_search *s, const fg_effect *kind) {
  if (!s->free_column) s->free_column = s->columns.count;
  fg_search_add(s, &(fg_candidate){.kind = kind});
  if (s->policy->smoother_curves)
    choose_parts(&s->columns, &s->out->candidates[s->out->candidate_count - 1]);
}

/* All that are not placed. The powers are shared by the polynomials that are made of them. */
static fg_status add_smooth(fg_context *ctx, fg_search *s, const fg_effect_set *known) {
  size_t first[2] = {0, 0};
  double share[2] = {0, 0}, none[FG_FIELD_SHAPES] = {0};
  for (int axis = 0; axis < 2 && s->policy->middles_with_sets; axis++)
    fg_search_columns_add(&s->columns, &fg_effect_powers[axis], none, &first[axis], &share[axis]);
  for (const fg_effect *kind = fg_effect_first(); kind; kind = fg_effect_next(kind)) {
    if (kind->sought == FG_EFFECT_PLACED || !fg_search_seeks(s, kind)) continue;
    if (fg_effect_is_free(kind))
      add_curve(s, kind);
    else if (kind->polynomial && s->policy->middles_with_sets)
      add_of_powers(s, kind, first[kind->axis]);
    else if (kind->start)
      FG_TRY(fg_search_add_shaped(ctx, s, kind, known));
    else
      add_with_middle(s, kind, known);
  }
  s->free_end = s->columns.count;
  return FG_OK;
}

/* Ripples, steps and effects that evidence alone asks for, which are in force. */
static void add_known(fg_search *s, const fg_effect_set *known) {
  for (size_t e = 0; known && e < known->count; e++) {
    const fg_effect_found *from = &known->effects[e];
    fg_candidate effect = {.kind = from->kind};
    memcpy(effect.shape, from->shape, sizeof effect.shape);
    bool is_kept = from->kind->sought == FG_EFFECT_PLACED || from->kind->by_evidence;
    if (is_kept && s->out->candidate_count < FG_CANDIDATES_MAX) fg_search_add(s, &effect);
  }
}

fg_status fg_search_find(fg_context *ctx, const fg_edge_fit *edge_fit,
                         const fg_search_request *request, fg_explanations *explanations) {
  memset(explanations, 0, sizeof *explanations);
  const fg_search_policy *policy = request->policy;
  if (request->barred) explanations->barred = *request->barred;
  fg_search s = {.policy = policy,
                 .out = explanations,
                 .given_up = request->given_up,
                 .given_up_count = request->given_up_count,
                 .tried = request->tried,
                 .two_curves = request->two_curves,
                 .hopeless = request->hopeless};
  fg_status status = FG_OK;
  FG_TRY(
      fg_search_columns_open(ctx, edge_fit, request->residual_um, request->jacobian, &s.columns));
  FG_TRY_EXIT(add_smooth(ctx, &s, request->known));
  add_known(&s, request->known);
  if (policy->other_steps) FG_TRY_EXIT(fg_search_add_other_steps(ctx, &s, request->known));
  FG_TRY_EXIT(fg_search_width_uncertainty(ctx, &s.columns));
  if (request->look) FG_TRY_EXIT(policy->find_placed(ctx, &s));
  if (policy->has_rivals) FG_TRY_EXIT(fg_search_find_in_place(ctx, &s));
  fg_search_refine_noise(&s);
  FG_TRY_EXIT(fg_search_check_rows(ctx, &s));
  const fg_search_baseline y = fg_search_find_baseline(&s);
  fg_search_try_sets(&s, &y);
  fg_search_describe(&s, &y);
exit:
  fg_search_free_grids(&s);
  fg_search_columns_close(&s.columns);
  return status;
}

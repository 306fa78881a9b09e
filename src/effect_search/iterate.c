/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The search for effects and the fit of the geometry in turns. */
#include "effect_search/iterate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "effect/columns.h"
#include "effect_search/joint_fit.h"
#include "effect_search/outliers.h"
#include "effect_search/policy.h"
#include "effect_search/search.h"
#include "rows/scatter.h"

/* Largest plausible change of an overall radius, and largest plausible coefficient: far beyond the
 * 40 um of reports/loop_scans.md. */
#define SANE_SHARE 0.03
#define SANE_UM    2000.0
/* An amplitude that is more than its uncertainty (1 in 16 000 by chance). */
#define THERE_SIGMAS 4.0
/* Maximum number of rounds of search and fit. */
enum { ROUNDS = 8, PROPOSING_ROUNDS = 3, COARSE_ROUNDS = 2 };
/* Maximum number of sets given up; further ones may recur. */
enum { GIVEN_UP_MAX = 16 };

void fg_explanations_get_set(const fg_explanations *explanations, size_t explanation,
                             fg_effect_set *set) {
  memset(set, 0, sizeof *set);
  for (size_t e = 0; e < explanations->candidate_count; e++) {
    if (!(explanations->each[explanation].mask >> e & 1) || set->count == FG_EFFECT_SET_MAX)
      continue;
    const fg_candidate *from = &explanations->candidates[e];
    fg_effect_found *to = &set->effects[set->count++];
    *to = (fg_effect_found){.kind = from->kind, .columns = from->columns, .shapes = from->shapes};
    memcpy(to->shape, from->shape, sizeof to->shape);
    if (from->polynomial > FG_EFFECT_LINEAR)
      to->shape[0] = explanations->each[explanation].middle_mm[e];
  }
}

/* The shape is a polynomial's middle: every search determines it anew, but the fit's value is
 * better. */
static bool has_middle(const fg_effect_found *effect) {
  return effect->kind->polynomial > FG_EFFECT_LINEAR;
}

/* Copies the numbers of effects that both sets include. */
static void keep_numbers(const fg_effect_set *from, fg_effect_set *to) {
  for (size_t e = 0; e < to->count; e++)
    for (size_t k = 0; k < from->count; k++)
      if (to->effects[e].kind == from->effects[k].kind &&
          (to->effects[e].shape[0] == from->effects[k].shape[0] || has_middle(&to->effects[e])))
        to->effects[e] = from->effects[k];
}

static bool same_effects(const fg_effect_set *a, const fg_effect_set *b) {
  if (a->count != b->count) return false;
  for (size_t e = 0; e < a->count; e++)
    if (a->effects[e].kind != b->effects[e].kind) return false;
  return true;
}

fg_status fg_search_put_back(fg_context *ctx, fg_edge_fit *edge_fit, const fg_effect_set *set,
                             double *residual_um, double *jacobian) {
  size_t rows = edge_fit->row_count;
  fg_field_list fields;
  double *shift = NULL, *columns = NULL;
  fg_status status = FG_OK;
  fg_effect_set_fields(edge_fit, set, &fields);
  FG_TRY_EXIT(fg_effect_set_shift(ctx, edge_fit, set, &shift));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, rows, FG_EFFECT_COLUMNS_MAX * sizeof *columns, (void **)&columns));
  fg_edge_fit_correction correction = {&fields, shift};
  fg_edge_fit_residual(edge_fit, &correction, residual_um, jacobian);
  for (size_t i = 0; i < rows; i++)
    residual_um[i] *= 1000;
  for (size_t e = 0; e < set->count; e++) {
    const fg_effect_found *effect = &set->effects[e];
    size_t count = fg_effect_columns(edge_fit, effect->kind, effect->shape, columns);
    for (size_t c = 0; c < count; c++)
      for (size_t i = 0; i < rows; i++)
        residual_um[i] += effect->coefficient_um[c] * columns[c * rows + i];
  }
exit:
  free(shift);
  free(columns);
  return status;
}

/* Drops effects that the fit reduced to nothing: a second ripple in place of the curvature of a
 * first one, or a smooth effect beside one whose shape has been found since. */
static void drop_nothings(fg_effect_set *set) {
  size_t kept = 0, there = 0;
  for (size_t e = 0; e < set->count; e++)
    there += fg_effect_found_exceeds(&set->effects[e], THERE_SIGMAS);
  if (!there) return; /* each could go, but not all: they are collinear */
  for (size_t e = 0; e < set->count; e++)
    if (fg_effect_found_exceeds(&set->effects[e], THERE_SIGMAS))
      set->effects[kept++] = set->effects[e];
  set->count = kept;
}

/* A search under way. */
typedef struct settling {
  const fg_search_policy *policy;
  const fg_search_bars *barred;
  fg_effect_set set;
  fg_explanations explanations;
  fg_effect_set given_up[GIVEN_UP_MAX];
  size_t given_up_count;
  double *residual_um, *jacobian, *geometry; /* per row; parameters × rows; saved geometry */
} settling;

/* Returns the weighted sum of squares over the rows that are not held out. */
static double square_of(const fg_edge_fit *edge_fit, const double *residual_um) {
  double sum = 0;
  for (size_t i = 0; i < edge_fit->row_count; i++)
    if (!edge_fit->views[edge_fit->rows[i].view].held_out)
      sum += edge_fit->rows[i].weight * residual_um[i] * residual_um[i];
  return sum;
}

/* An effect that bends the geometry so far is none. */
static bool is_sane(const fg_edge_fit *edge_fit, const double *geometry, const fg_effect_set *set) {
  size_t at = 0;
  for (size_t p = 0; p < edge_fit->part_count; p++) {
    double was = geometry[at];
    if (!(fabs(edge_fit->parts[p].overall_radius_mm / was - 1) < SANE_SHARE)) return false;
    at += 1 + 3 * edge_fit->parts[p].bump_count;
  }
  for (size_t e = 0; e < set->count; e++)
    for (size_t c = 0; c < set->effects[e].columns; c++)
      if (!(fabs(set->effects[e].coefficient_um[c]) < SANE_UM)) return false;
  return true;
}

/* Fits a set from the present geometry. A fit that runs away, or leaves more than `none` (the
 * residual without effects), is given up: then the set is empty. */
static fg_status fit_set(fg_context *ctx, fg_edge_fit *edge_fit, double none, settling *at) {
  fg_edge_fit_geometry_save(edge_fit, at->geometry);
  fg_status status = fg_joint_fit(ctx, edge_fit, &at->set, at->residual_um);
  if (status != FG_OK && status != FG_ERR_NUMERIC) return status;
  if (status == FG_OK && is_sane(edge_fit, at->geometry, &at->set) &&
      square_of(edge_fit, at->residual_um) <= none)
    return FG_OK;
  fg_edge_fit_geometry_load(edge_fit, at->geometry);
  if (at->given_up_count < GIVEN_UP_MAX) at->given_up[at->given_up_count++] = at->set;
  memset(&at->set, 0, sizeof at->set);
  ctx->message[0] = 0;
  return fg_joint_fit(ctx, edge_fit, &at->set, at->residual_um);
}

/* Returns true when a round lowered the residual so little that a further one is useless. */
static bool has_converged(const fg_search_policy *policy, double before, double left) {
  return !(left <= (1 - policy->converged_share) * before);
}

/* Result of a round. */
typedef struct round_end {
  fg_effect_set set;
  double left; /* sum of squares */
  bool right;
} round_end;

/* Two explanations that lead to each other would alternate for ever. The one of fewer effects is
 * accepted, of equal numbers the one with the smaller residual. */
static bool comes_again(const round_end *end, int round) {
  if (round < 2 || !same_effects(&end[round].set, &end[round - 2].set)) return false;
  const round_end *now = &end[round], *other = &end[round - 1];
  if (now->set.count != other->set.count) return now->set.count < other->set.count;
  return now->left <= other->left;
}

/* Returns true for a set that was right, was left for a better one, and is reached again. */
static bool was_right_before(const round_end *end, int round) {
  for (int r = 0; r + 1 < round && end[round].right; r++)
    if (end[r].right && same_effects(&end[r].set, &end[round].set)) return true;
  return false;
}

/* Keeps, of a set, the one effect that alone explains most. */
static void keep_best_alone(const fg_explanations *explanations, const fg_effect_set *from,
                            fg_effect_set *to) {
  double max = -1;
  for (size_t e = 0; e < from->count; e++)
    for (size_t c = 0; c < explanations->candidate_count; c++) {
      if (explanations->candidates[c].kind != from->effects[e].kind ||
          !(explanations->alone[c] > max))
        continue;
      max = explanations->alone[c];
      *to = (fg_effect_set){.count = 1, .effects = {from->effects[e]}};
    }
}

/* Several smooth effects beside a ripple with a slightly wrong period stand for its residual, and
 * their joint fit fails. The ripple fitted alone finds its period, and the next round starts there.
 */
static fg_status fit_or_best_alone(fg_context *ctx, fg_edge_fit *edge_fit, double none,
                                   settling *at) {
  const fg_effect_set next = at->set;
  FG_TRY(fit_set(ctx, edge_fit, none, at));
  if (!at->policy->falls_back || next.count < 2 || at->set.count) return FG_OK;
  keep_best_alone(&at->explanations, &next, &at->set);
  return fit_set(ctx, edge_fit, none, at);
}

/* The first explanation, or one of the effects that are preferred (NULL: none are). */
static void take_likeliest(const fg_explanations *explanations, const fg_effect_set *prefer,
                           fg_effect_set *set) {
  for (size_t m = 0; prefer && m < explanations->count; m++) {
    fg_explanations_get_set(explanations, m, set);
    if (same_effects(set, prefer)) return;
  }
  fg_explanations_get_set(explanations, 0, set);
}

/* Runs one turn: the search at the present geometry, and the fit of the set found, `next`. The
 * request holds the members that differ from turn to turn. */
static fg_status run_turn(fg_context *ctx, fg_edge_fit *edge_fit, fg_search_request request,
                          const fg_effect_set *prefer, double none, settling *at,
                          fg_effect_set *next) {
  const fg_search_policy *policy = at->policy;
  request.policy = policy;
  request.residual_um = at->residual_um;
  request.jacobian = at->jacobian;
  request.known = &at->set;
  request.given_up = at->given_up;
  request.given_up_count = policy->drops_nothings ? at->given_up_count : 0;
  request.barred = at->barred;
  if (policy->scatters) FG_TRY(fg_edge_fit_find_scatter(ctx, edge_fit, at->residual_um));
  FG_TRY(fg_search_put_back(ctx, edge_fit, &at->set, at->residual_um, at->jacobian));
  FG_TRY(fg_search_find(ctx, edge_fit, &request, &at->explanations));
  take_likeliest(&at->explanations, prefer, next);
  keep_numbers(&at->set, next);
  at->set = *next;
  fg_search_drop_across_steps(edge_fit, &at->set, policy->step_half_mm);
  FG_TRY(fit_or_best_alone(ctx, edge_fit, none, at));
  /* the set was right to first order only */
  if (next->count && !at->set.count) at->explanations.right = false;
  return FG_OK;
}

static int max_rounds(const fg_edge_fit *edge_fit) {
  return edge_fit->coarse ? COARSE_ROUNDS : edge_fit->proposes ? PROPOSING_ROUNDS : ROUNDS;
}

/* Search and fit in turns from a start without effects. */
static fg_status iterate_from(fg_context *ctx, fg_edge_fit *edge_fit, fg_search_strategy how,
                              settling *at) {
  const fg_search_policy *policy = at->policy;
  fg_effect_set tried = {.count = 0}, last = {.count = 0};
  double left = INFINITY;
  memset(&at->set, 0, sizeof at->set);
  FG_TRY(fg_joint_fit(ctx, edge_fit, &at->set, at->residual_um));
  double none = square_of(edge_fit, at->residual_um);
  round_end end[ROUNDS];
  bool hopeless = false;
  for (int round = 0; round < max_rounds(edge_fit); round++) {
    const fg_effect_set in_force = at->set;
    fg_effect_set next;
    const fg_search_request request = {.tried = &tried,
                                       .look = how.seeds_placed_first || round > 0,
                                       .two_curves = how.two_curves,
                                       .hopeless = hopeless};
    FG_TRY(run_turn(ctx, edge_fit, request, NULL, none, at, &next));
    bool same = same_effects(policy->converges_in_force ? &in_force : &last, &next);
    last = next;
    if (!at->explanations.right) tried = next;
    FG_TRY(fg_search_drop_outliers(ctx, edge_fit, policy->own_noise, at->residual_um));
    double before = left;
    left = square_of(edge_fit, at->residual_um);
    if (same && round > 0 && (at->explanations.right || has_converged(policy, before, left))) break;
    end[round] = (round_end){at->set, left, at->explanations.right};
    if (at->explanations.right && comes_again(end, round)) break;
    hopeless = hopeless || was_right_before(end, round);
    if (policy->drops_nothings) drop_nothings(&at->set);
  }
  return FG_OK;
}

static size_t count_free(const fg_effect_set *set) {
  size_t count = 0;
  for (size_t e = 0; e < set->count; e++)
    count += fg_effect_is_free(set->effects[e].kind);
  return count;
}

/* From a set in force; no turn follows that could fit a shape in hope, so none is. */
static fg_status iterate_from_set(fg_context *ctx, fg_edge_fit *edge_fit, const fg_effect_set *set,
                                  settling *at) {
  memset(&at->set, 0, sizeof at->set);
  FG_TRY(fg_joint_fit(ctx, edge_fit, &at->set, at->residual_um));
  double none = square_of(edge_fit, at->residual_um);
  at->set = *set;
  FG_TRY(fit_set(ctx, edge_fit, none, at));
  fg_effect_set next;
  const fg_search_request request = {
      .look = true, .two_curves = count_free(set) > 1, .hopeless = true};
  return run_turn(ctx, edge_fit, request, set, none, at, &next);
}

/* Tries the strategies of the policy in order until one converges at a right explanation; the best
 * result is kept. */
static fg_status iterate_from_best(fg_context *ctx, fg_edge_fit *edge_fit, settling *at) {
  const fg_search_policy *policy = at->policy;
  size_t numbers = fg_edge_fit_geometry_size(edge_fit);
  double best = INFINITY, *geometry = NULL;
  settling kept = *at;
  FG_TRY(
      fg_memory_allocate(ctx, numbers + edge_fit->row_count, sizeof *geometry, (void **)&geometry));
  double *residual_um = geometry + numbers;
  fg_status status = FG_OK;
  for (size_t i = 0; i < policy->strategy_count; i++) {
    if (i > 0 && (edge_fit->coarse || edge_fit->proposes)) break;
    if (policy->strategies[i].two_curves && edge_fit->view_count < 2) continue;
    FG_TRY_EXIT(iterate_from(ctx, edge_fit, policy->strategies[i], at));
    double left = square_of(edge_fit, at->residual_um);
    if (at->explanations.right) goto exit;
    if (i && has_converged(policy, best, left)) continue;
    best = left;
    kept = *at;
    fg_edge_fit_geometry_save(edge_fit, geometry);
    memcpy(residual_um, at->residual_um, edge_fit->row_count * sizeof *residual_um);
  }
  at->set = kept.set;
  at->explanations = kept.explanations;
  fg_edge_fit_geometry_load(edge_fit, geometry);
  memcpy(at->residual_um, residual_um, edge_fit->row_count * sizeof *residual_um);
exit:
  free(geometry);
  return status;
}

static fg_status drop_ends(fg_context *ctx, fg_edge_fit *edge_fit, double *residual_um) {
  fg_effect_set none = {.count = 0};
  FG_TRY(fg_joint_fit(ctx, edge_fit, &none, residual_um));
  return fg_search_drop_ends(ctx, edge_fit, residual_um);
}

static fg_status open_settling(fg_context *ctx, const fg_iterate_request *request,
                               double *residual_um, settling *at) {
  const fg_edge_fit *edge_fit = request->edge_fit;
  *at =
      (settling){.policy = request->policy, .barred = request->barred, .residual_um = residual_um};
  FG_TRY(fg_memory_allocate(ctx, edge_fit->row_count, edge_fit->parameters * sizeof *at->jacobian,
                            (void **)&at->jacobian));
  return fg_memory_allocate(ctx, fg_edge_fit_geometry_size(edge_fit), sizeof *at->geometry,
                            (void **)&at->geometry);
}

static void close_settling(settling *at) {
  free(at->jacobian);
  free(at->geometry);
}

fg_status fg_search_iterate(fg_context *ctx, const fg_iterate_request *request, fg_effect_set *set,
                            fg_explanations *explanations, double *residual_um) {
  fg_edge_fit *edge_fit = request->edge_fit;
  settling at;
  fg_status status = FG_OK;
  memset(set, 0, sizeof *set);
  if (request->policy->drops_ends) FG_TRY(drop_ends(ctx, edge_fit, residual_um));
  FG_TRY_EXIT(open_settling(ctx, request, residual_um, &at));
  FG_TRY_EXIT(iterate_from_best(ctx, edge_fit, &at));
  *set = at.set;
  *explanations = at.explanations;
exit:
  close_settling(&at);
  return status;
}

fg_status fg_search_iterate_again(fg_context *ctx, const fg_iterate_request *request,
                                  fg_effect_set *set, double *residual_um) {
  settling at;
  fg_status status = FG_OK;
  FG_TRY_EXIT(open_settling(ctx, request, residual_um, &at));
  FG_TRY_EXIT(iterate_from_set(ctx, request->edge_fit, set, &at));
  *set = at.set;
exit:
  close_settling(&at);
  return status;
}

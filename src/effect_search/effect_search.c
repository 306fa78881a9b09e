/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The search from start to end, under the policy for its kind of parts. */
#include "effect_search/effect_search.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "effect_search/confirm.h"
#include "effect_search/iterate.h"
#include "effect_search/policy.h"

static void bar(fg_search_bars *barred, const fg_explanations *explanations,
                const fg_effect *kind) {
  for (size_t i = 0; i < barred->count; i++)
    if (barred->each[i].effect == kind) return;
  fg_search_barred *entry = &barred->each[barred->count++];
  *entry =
      (fg_search_barred){.effect = kind, .would_explain = NAN, .smallest_um = NAN, .share = NAN};
  for (size_t e = 0; e < explanations->candidate_count; e++) {
    if (explanations->candidates[e].kind != kind) continue;
    entry->would_explain = explanations->alone[e];
    entry->share = explanations->share[e];
    return;
  }
}

/* Bars effects that discs do not confirm: all of them when none is confirmed, else the least
 * confirmed one, which may have spoilt the others. When none is left to bar, `barred` stays. */
static fg_status bar_unconfirmed(fg_context *ctx, const fg_edge_fit *edge_fit, fg_effect_set *set,
                                 const fg_explanations *explanations, const double *residual_um,
                                 fg_search_bars *barred) {
  double confirmed[FG_EFFECT_SET_MAX], min = 0;
  size_t failing = 0;
  for (size_t e = 0; e < set->count; e++) {
    FG_TRY(fg_search_confirm(ctx, edge_fit, &set->effects[e], residual_um, &confirmed[e]));
    failing += !(confirmed[e] > 0);
    min = fmin(min, confirmed[e]);
  }
  size_t max = failing == set->count ? failing : 1;
  if (!failing || barred->count + max > FG_SEARCH_BARRED_MAX) return FG_OK;
  for (size_t e = 0, n = 0; e < set->count && n < max; e++) {
    if (confirmed[e] > min && max == 1) continue;
    bar(barred, explanations, set->effects[e].kind);
    n++;
  }
  return FG_OK;
}

/* Returns the mask of the scanner's or of the part's effects that are collinear on a ring. */
static unsigned ring_mask(const fg_explanations *explanations, fg_effect_ring ring) {
  unsigned mask = 0;
  for (size_t e = 0; e < explanations->candidate_count; e++)
    if (explanations->candidates[e].kind->ring == ring) mask |= 1u << e;
  return mask;
}

static void add_member(fg_explanations *explanations, unsigned mask, const fg_explanation *like) {
  for (size_t m = 0; m < explanations->count; m++)
    if (explanations->each[m].mask == mask) return;
  if (explanations->count == FG_EXPLANATIONS_MAX) return;
  explanations->each[explanations->count] = *like;
  explanations->each[explanations->count++].mask = mask;
  explanations->total++;
}

/* In one circle an oval and a scale with a shear are one and the same. */
static void add_ring_alias(fg_explanations *explanations) {
  size_t known = explanations->count;
  unsigned scanner = ring_mask(explanations, FG_EFFECT_RING_OF_SCANNER);
  unsigned oval = ring_mask(explanations, FG_EFFECT_RING_OF_PART);
  for (size_t m = 0; m < known; m++) {
    const fg_explanation explanation = explanations->each[m];
    if (explanation.mask & oval)
      add_member(explanations, (explanation.mask & ~oval) | scanner, &explanation);
    else if (explanation.mask & scanner)
      add_member(explanations, (explanation.mask & ~scanner) | oval, &explanation);
  }
}

/* Restores the start of every search: a set that is barred now may have dropped rows as outliers,
 * or bent the geometry out of reach. */
static void restore_start(fg_edge_fit *edge_fit, const double *weights) {
  for (size_t i = 0; i < edge_fit->row_count; i++)
    edge_fit->rows[i].weight = weights[i];
  for (size_t v = 0; v < edge_fit->view_count; v++) {
    const fg_disc *disc = edge_fit->views[v].disc;
    fg_edge_fit_part *part = &edge_fit->parts[edge_fit->views[v].part];
    edge_fit->poses[v].origin_mm = disc->centre_mm;
    if (!part->radius_known) part->overall_radius_mm = disc->radius_mm;
  }
}

/* Iterates, bars effects that are not confirmed, and repeats until none is barred. */
static fg_status iterate_until_confirmed(fg_context *ctx, fg_edge_fit *edge_fit,
                                         const fg_search_policy *policy, fg_effect_set *set,
                                         fg_explanations *explanations, double *residual_um) {
  fg_search_bars barred = {.count = 0};
  const fg_iterate_request request = {edge_fit, policy, &barred};
  double *weights = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, edge_fit->row_count, sizeof *weights, (void **)&weights));
  for (size_t i = 0; i < edge_fit->row_count; i++)
    weights[i] = edge_fit->rows[i].weight;
  bool more = true;
  while (more) {
    size_t before = barred.count;
    restore_start(edge_fit, weights);
    FG_TRY_EXIT(fg_search_iterate(ctx, &request, set, explanations, residual_um));
    FG_TRY_EXIT(bar_unconfirmed(ctx, edge_fit, set, explanations, residual_um, &barred));
    more = barred.count > before;
  }
  if (barred.count) explanations->right = false;
exit:
  free(weights);
  return status;
}

fg_status fg_search_run(fg_context *ctx, fg_edge_fit *edge_fit, fg_effect_set *set,
                        fg_explanations *explanations, double *residual_um) {
  const fg_search_policy *policy = fg_search_policy_of(edge_fit);
  if (policy->confirms && edge_fit->part_count > 1)
    return iterate_until_confirmed(ctx, edge_fit, policy, set, explanations, residual_um);
  const fg_iterate_request request = {.edge_fit = edge_fit, .policy = policy};
  FG_TRY(fg_search_iterate(ctx, &request, set, explanations, residual_um));
  if (policy->confirms) add_ring_alias(explanations);
  return FG_OK;
}

#include "scan_loop/verdict.h"

#include <string.h>

#include "scan_loop/state.h"

/* Below this share of an effect beside the geometry no data of this kind could show it. */
#define ABSORBED_SHARE 1e-4

static bool member_holds(const fg_explanations *explanations, size_t explanation,
                         const fg_effect *kind) {
  for (size_t e = 0; e < explanations->candidate_count; e++)
    if ((explanations->each[explanation].mask >> e & 1) &&
        fg_effect_same(explanations->candidates[e].kind, kind))
      return true;
  return false;
}

bool fg_scan_loop_is_sure(const fg_explanations *explanations, const fg_effect *kind) {
  for (size_t m = 0; m < explanations->count; m++)
    if (!member_holds(explanations, m, kind)) return false;
  return true;
}

static bool any_member_holds(const fg_explanations *explanations, const fg_effect *kind) {
  for (size_t m = 0; m < explanations->count; m++)
    if (member_holds(explanations, m, kind)) return true;
  return false;
}

/* Whether an explanation has all effects of another, in whatever form. */
static bool covers(const fg_explanations *explanations, size_t explanation, size_t other) {
  for (size_t e = 0; e < explanations->candidate_count; e++)
    if ((explanations->each[other].mask >> e & 1) &&
        !member_holds(explanations, explanation, explanations->candidates[e].kind))
      return false;
  return true;
}

/* Two forms of one effect are one explanation. */
static void find_class(const fg_explanations *explanations, fg_scan_loop_decisions *d) {
  for (size_t m = 0; m < explanations->count; m++) {
    bool known = false;
    for (size_t k = 0; k < d->shown_count && !known; k++)
      known = covers(explanations, m, d->shown[k]) && covers(explanations, d->shown[k], m);
    if (!known) d->shown[d->shown_count++] = m;
  }
  if (explanations->count == FG_EXPLANATIONS_MAX && explanations->total > FG_EXPLANATIONS_MAX)
    d->unlisted = explanations->total - FG_EXPLANATIONS_MAX;
}

static bool is_claimed(const fg_effect_set *set, const fg_effect *kind) {
  for (size_t i = 0; i < set->count; i++)
    if (fg_effect_same(set->effects[i].kind, kind)) return true;
  return false;
}

static bool is_candidate(const fg_scan_loop_decisions *d, const fg_effect *kind) {
  for (size_t i = 0; i < d->candidates; i++)
    if (fg_effect_same(d->candidate[i].kind, kind)) return true;
  return false;
}

static fg_loop_verdict judge(const fg_explanations *explanations, size_t e) {
  if (any_member_holds(explanations, explanations->candidates[e].kind)) return FG_LOOP_TIED;
  if (explanations->smallest_um[e] <= FG_SCAN_LOOP_MATTERS_UM) return FG_LOOP_ABSENT;
  return explanations->share[e] < ABSORBED_SHARE ? FG_LOOP_ABSORBED : FG_LOOP_INCONCLUSIVE;
}

/* Of two forms of one effect the first speaks for both. */
static void list_candidates(const fg_scan_loop *loop, fg_scan_loop_decisions *d) {
  const fg_explanations *explanations = &loop->explanations;
  for (size_t e = 0; e < explanations->candidate_count; e++) {
    const fg_effect *kind = explanations->candidates[e].kind;
    if (fg_effect_is_free(kind) || kind->second || is_claimed(&loop->set, kind)) continue;
    d->candidate[d->candidates++] = (fg_scan_loop_unclaimed){kind,
                                                             judge(explanations, e),
                                                             explanations->alone[e],
                                                             explanations->share[e],
                                                             explanations->smallest_um[e],
                                                             false};
  }
  for (size_t b = 0; b < loop->points.barred_count; b++) {
    const fg_points_barred *barred = &loop->points.barred[b];
    if (fg_effect_is_free(barred->effect) || is_claimed(&loop->set, barred->effect) ||
        is_candidate(d, barred->effect))
      continue;
    d->candidate[d->candidates++] =
        (fg_scan_loop_unclaimed){barred->effect, FG_LOOP_INCONCLUSIVE, barred->would_explain,
                                 barred->share,  barred->smallest_um,  true};
  }
}

static void find_advice(const fg_scan_loop *loop, fg_scan_loop_decisions *d) {
  if (d->shown_count > 1)
    d->advice[d->advices++] =
        loop->points.discs
            ? "scan a plate of several gauges on the same scanner: what all of them show is the "
              "scanner, and an oval is each one's own"
        : !loop->options.same_foil
            ? "scan the same foil again, turned by about 90 degrees, and run the loop on both "
              "scans with --same-foil: what stays with the glass is the scanner, what turns is "
              "the part"
            : "scan another foil on the same scanner: what repeats is the scanner";
  if (loop->scale_tied)
    d->advice[d->advices++] =
        "scan a gauge of known diameter on the same scanner (--form discs): it tells the scale, "
        "which no foil of unknown size can";
}

void fg_scan_loop_decide(const fg_scan_loop *loop, fg_scan_loop_decisions *d) {
  memset(d, 0, sizeof *d);
  for (size_t i = 0; i < loop->set.count; i++)
    d->sure[i] = fg_scan_loop_is_sure(&loop->explanations, loop->set.effects[i].kind);
  find_class(&loop->explanations, d);
  list_candidates(loop, d);
  find_advice(loop, d);
}

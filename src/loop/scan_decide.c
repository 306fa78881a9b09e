#include "loop/scan_decide.h"

#include <string.h>

#include "loop/scan_loop.h"

/* Below this share of an effect beside the geometry no data of this kind could show it. */
#define ABSORBED_SHARE 1e-4

static bool member_holds(const fg_subset *subset, size_t member, const fg_effect *kind) {
  for (size_t e = 0; e < subset->effect_count; e++)
    if ((subset->members[member].mask >> e & 1) && fg_effect_same(subset->effects[e].kind, kind))
      return true;
  return false;
}

bool fg_scan_effect_is_sure(const fg_subset *subset, const fg_effect *kind) {
  for (size_t m = 0; m < subset->member_count; m++)
    if (!member_holds(subset, m, kind)) return false;
  return true;
}

static bool any_member_holds(const fg_subset *subset, const fg_effect *kind) {
  for (size_t m = 0; m < subset->member_count; m++)
    if (member_holds(subset, m, kind)) return true;
  return false;
}

/* Whether a member has all effects of another, in whatever form. */
static bool covers(const fg_subset *subset, size_t member, size_t other) {
  for (size_t e = 0; e < subset->effect_count; e++)
    if ((subset->members[other].mask >> e & 1) &&
        !member_holds(subset, member, subset->effects[e].kind))
      return false;
  return true;
}

/* Two forms of one effect are one explanation. */
static void find_class(const fg_subset *subset, fg_scan_decisions *d) {
  for (size_t m = 0; m < subset->member_count; m++) {
    bool known = false;
    for (size_t k = 0; k < d->member_count && !known; k++)
      known = covers(subset, m, d->members[k]) && covers(subset, d->members[k], m);
    if (!known) d->members[d->member_count++] = m;
  }
  if (subset->member_count == FG_SUBSET_CLASS && subset->member_total > FG_SUBSET_CLASS)
    d->unlisted = subset->member_total - FG_SUBSET_CLASS;
}

static bool is_claimed(const fg_scan_set *set, const fg_effect *kind) {
  for (size_t i = 0; i < set->count; i++)
    if (fg_effect_same(set->effects[i].kind, kind)) return true;
  return false;
}

static bool is_candidate(const fg_scan_decisions *d, const fg_effect *kind) {
  for (size_t i = 0; i < d->candidates; i++)
    if (fg_effect_same(d->candidate[i].kind, kind)) return true;
  return false;
}

static fg_loop_verdict judge(const fg_subset *subset, size_t e) {
  if (any_member_holds(subset, subset->effects[e].kind)) return FG_LOOP_TIED;
  if (subset->smallest_um[e] <= FG_SCAN_MATTERS_UM) return FG_LOOP_ABSENT;
  return subset->share[e] < ABSORBED_SHARE ? FG_LOOP_ABSORBED : FG_LOOP_INCONCLUSIVE;
}

/* Of two forms of one effect the first speaks for both. */
static void list_candidates(const fg_scan_loop *loop, fg_scan_decisions *d) {
  const fg_subset *subset = &loop->subset;
  for (size_t e = 0; e < subset->effect_count; e++) {
    const fg_effect *kind = subset->effects[e].kind;
    if (fg_effect_is_free(kind) || kind->second || is_claimed(&loop->set, kind)) continue;
    d->candidate[d->candidates++] = (fg_scan_candidate){
        kind, judge(subset, e), subset->alone[e], subset->share[e], subset->smallest_um[e], false};
  }
  for (size_t b = 0; b < loop->points.barred_count; b++) {
    const fg_points_barred *barred = &loop->points.barred[b];
    if (fg_effect_is_free(barred->effect) || is_claimed(&loop->set, barred->effect) ||
        is_candidate(d, barred->effect))
      continue;
    d->candidate[d->candidates++] =
        (fg_scan_candidate){barred->effect, FG_LOOP_INCONCLUSIVE, barred->would_explain,
                            barred->share,  barred->smallest_um,  true};
  }
}

static void find_advice(const fg_scan_loop *loop, fg_scan_decisions *d) {
  if (d->member_count > 1)
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

void fg_scan_decide(const fg_scan_loop *loop, fg_scan_decisions *d) {
  memset(d, 0, sizeof *d);
  for (size_t i = 0; i < loop->set.count; i++)
    d->sure[i] = fg_scan_effect_is_sure(&loop->subset, loop->set.effects[i].kind);
  find_class(&loop->subset, d);
  list_candidates(loop, d);
  find_advice(loop, d);
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects over the bumps that are not claimed. */
#include <math.h>
#include <string.h>

#include "scan_loop/bumps.h"

/* Returns true for the effects sought; the engine's effects of single rows are notes. */
static bool is_effect(const fg_scan_loop_bumps *bumps, const fg_loop_effect *effect) {
  return effect >= bumps->effect && effect < bumps->effect + FG_SCAN_LOOP_BUMP_EFFECTS;
}

static bool is_mentioned(const fg_scan_loop_bump_level *level, const fg_loop_effect *effect) {
  for (size_t m = 0; m < level->result.claims; m++)
    if (level->result.claim[m].candidate.effect == effect) return true;
  for (size_t k = 0; k < level->result.rejects; k++)
    if (level->result.rejected[k].candidate.effect == effect) return true;
  for (size_t m = 0; m < level->drops; m++)
    if (level->dropped[m].candidate.effect == effect) return true;
  return false;
}

/* Reports every effect as unknown, not as `absent`: too few bumps, or no lip. */
static void visit_unknown(const fg_scan_loop_bumps *bumps, size_t response,
                          fg_scan_loop_bumps_visitor *visit, void *user) {
  const fg_scan_loop_bump_level *level = &bumps->level[response];
  for (const fg_loop_effect *e = bumps->effect; e->id; e++) {
    bool of_angles = e->over_bumps == FG_LOOP_BUMP_STRETCH;
    const fg_loop_rejected one = {.candidate = {.effect = e},
                                  .verdict = FG_LOOP_INCONCLUSIVE,
                                  .would_explain = NAN,
                                  .p_value = 1,
                                  .retained_share = NAN,
                                  .smallest_detectable = NAN};
    if (!is_mentioned(level, e) && (response || !of_angles)) visit(response, &one, user);
  }
}

/* An effect found on one coordinate is not listed as rejected of the same response on its other
 * coordinate. */
void fg_scan_loop_bumps_rejected(const fg_scan_loop_bumps *bumps, fg_scan_loop_bumps_visitor *visit,
                                 void *user) {
  for (size_t r = 0; r < FG_SCAN_LOOP_BUMP_RESPONSES && bumps->count; r++) {
    const fg_scan_loop_bump_level *level = &bumps->level[r];
    for (size_t k = 0; k < level->result.rejects; k++)
      if (is_effect(bumps, level->result.rejected[k].candidate.effect))
        visit(r, &level->result.rejected[k], user);
    for (size_t m = 0; m < level->drops; m++) {
      const fg_loop_claim *claim = &level->dropped[m];
      const fg_loop_rejected one = {.candidate = claim->candidate,
                                    .verdict = FG_LOOP_INCONCLUSIVE,
                                    .would_explain = NAN,
                                    .p_value = claim->p_value,
                                    .retained_share = claim->retained_share,
                                    .smallest_detectable = level->min};
      if (is_effect(bumps, claim->candidate.effect)) visit(r, &one, user);
    }
    visit_unknown(bumps, r, visit, user);
  }
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The one word that the loop on scans comes to. */
#include "scan_loop/state.h"
#include "scan_loop/verdict.h"

/* Residual over the noise that says that something is there. */
#define MUCH 1.5

static bool has_free(const fg_effect_set *set, bool wanted) {
  for (size_t e = 0; e < set->count; e++)
    if (fg_effect_is_free(set->effects[e].kind) == wanted) return true;
  return false;
}

/* A residual that all effects and curves together would take is not clean, even when no set of
 * them was found that holds: beside the scatter of rough edges it need not be large. */
static bool leaves_much(const fg_scan_loop *loop) {
  return !loop->edge_fit.discs && !loop->explanations.right &&
         (loop->error_after.rms > MUCH * loop->noise_floor_um ||
          loop->explanations.p_value < FG_LOOP_ACCEPT_P);
}

fg_loop_outcome fg_scan_loop_points_outcome(const fg_scan_loop *loop) {
  bool listed = has_free(&loop->set, false), rest = has_free(&loop->set, true);
  if (listed) return rest || !loop->explanations.right ? FG_LOOP_PARTLY : FG_LOOP_EXPLAINED;
  return rest || leaves_much(loop) ? FG_LOOP_UNATTRIBUTED : FG_LOOP_CLEAN;
}

static fg_loop_outcome bumps_outcome(const fg_scan_loop_bumps *bumps) {
  size_t response;
  bool rest = fg_scan_loop_bumps_curve(bumps, &response) != NULL;
  if (fg_scan_loop_bumps_claimed(bumps)) return rest ? FG_LOOP_PARTLY : FG_LOOP_EXPLAINED;
  return rest ? FG_LOOP_UNATTRIBUTED : FG_LOOP_CLEAN;
}

/* Points come first; only where they are clean the bumps decide. What moves the edges apart shows
 * in neither: the midline says nothing of its strip's thickness. */
fg_loop_outcome fg_scan_loop_outcome(const fg_scan_loop *loop) {
  fg_loop_outcome outcome = fg_scan_loop_points_outcome(loop);
  if (outcome == FG_LOOP_CLEAN) outcome = bumps_outcome(&loop->bumps);
  if (!loop->width.found) return outcome;
  return outcome == FG_LOOP_CLEAN          ? FG_LOOP_EXPLAINED
         : outcome == FG_LOOP_UNATTRIBUTED ? FG_LOOP_PARTLY
                                           : outcome;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outcome of the loop on scans, as one word. */
#include "scan_loop/state.h"
#include "scan_loop/verdict.h"

/* Ratio of residual to noise from which an unexplained deviation is reported. */
#define MUCH 1.5

static bool has_free(const fg_effect_set *set, bool wanted) {
  for (size_t e = 0; e < set->count; e++)
    if (fg_effect_is_free(set->effects[e].kind) == wanted) return true;
  return false;
}

/* A residual that all effects and curves together would explain is not clean, even when no set of
 * them is right: beside the scatter of rough edges it may be small. */
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

/* The rows decide first, the bumps only when the rows are clean. Effects of the width show in
 * neither, because the midline is independent of the thickness. */
fg_loop_outcome fg_scan_loop_outcome(const fg_scan_loop *loop) {
  fg_loop_outcome outcome = fg_scan_loop_points_outcome(loop);
  if (outcome == FG_LOOP_CLEAN) outcome = bumps_outcome(&loop->bumps);
  if (!loop->width.found) return outcome;
  return outcome == FG_LOOP_CLEAN          ? FG_LOOP_EXPLAINED
         : outcome == FG_LOOP_UNATTRIBUTED ? FG_LOOP_PARTLY
                                           : outcome;
}

/* Probability of chance. */
#define FORMING_P 1e-4

bool fg_scan_loop_has_uneven_discs(const fg_scan_loop *loop) {
  return loop->edge_fit.discs && !loop->set.count && loop->explanations.p_value < FORMING_P;
}

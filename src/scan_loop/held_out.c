/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors on held-out rows: of held-out scans, or without them cross-fitted. */
#include <math.h>

#include "scan_loop/state.h"

fg_status fg_scan_loop_find_held_out(fg_context *ctx, fg_scan_loop *loop) {
  fg_scan_loop_error *before = &loop->error_before, *after = &loop->error_after;
  if (isfinite(before->held_out_rms)) return FG_OK; /* of held-out scans */
  if (!loop->set.count) {                           /* no effect that could be tested */
    before->held_out_rms = after->held_out_rms = before->rms;
    return FG_OK;
  }
  const fg_search_bars *barred = loop->by_evidence ? NULL : &loop->explanations.barred;
  FG_TRY(fg_search_cross_fit(ctx, &loop->edge_fit, &loop->set, barred, loop->options.threads,
                             &loop->cross_fit));
  before->held_out_rms = loop->cross_fit.before_um;
  after->held_out_rms = loop->cross_fit.after_um;
  return FG_OK;
}

const char *fg_scan_loop_fold_of(const fg_scan_loop *loop) {
  static const char *const words[] = {[FG_CROSS_FIT_BUMPS] = "bumps",
                                      [FG_CROSS_FIT_DISCS] = "discs",
                                      [FG_CROSS_FIT_STRETCHES] = "stretches of the edge"};
  return loop->cross_fit.folds ? words[loop->cross_fit.unit] : NULL;
}

fg_status fg_scan_loop_note_held_out(fg_context *ctx, fg_scan_loop *loop) {
  const fg_cross_fit *c = &loop->cross_fit;
  if (!c->folds || c->gain > c->u_gain) return FG_OK;
  return fg_scan_loop_bumps_note(
      ctx, &loop->bumps,
      "points: on %s that took no part in the fit the error %s (%.3g um before, %.3g um after): "
      "nothing confirms yet what was found; scan more, and keep a scan aside (--hold-out)",
      fg_scan_loop_fold_of(loop),
      c->gain > 0 ? "falls by less than its standard error" : "does not fall", c->before_um,
      c->after_um);
}

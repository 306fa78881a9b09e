/* Errors on rows that took no part in the search: of scans kept aside or, without, cross-fitted. */
#include <math.h>

#include "scan_loop/state.h"

fg_status fg_scan_loop_find_held_out(fg_context *ctx, fg_scan_loop *loop) {
  fg_scan_loop_error *before = &loop->error_before, *after = &loop->error_after;
  if (isfinite(before->held_out_rms)) return FG_OK; /* of scans kept aside */
  if (!loop->set.count) {                           /* nothing was found that could be judged */
    before->held_out_rms = after->held_out_rms = before->rms;
    return FG_OK;
  }
  FG_TRY(fg_explain_cross_fit(ctx, &loop->points, &loop->set, &loop->explanations.barred,
                              loop->options.threads, &loop->cross_fit));
  before->held_out_rms = loop->cross_fit.before_um;
  after->held_out_rms = loop->cross_fit.after_um;
  return FG_OK;
}

/* What single bumps do by themselves no other bump can foretell. */
static bool of_single_bumps(const fg_effect_set *set) {
  for (size_t e = 0; e < set->count; e++)
    if (set->effects[e].kind->coordinate != FG_EFFECT_INDEX) return false;
  return true;
}

fg_status fg_scan_loop_say_held_out(fg_context *ctx, fg_scan_loop *loop) {
  const fg_cross_fit *c = &loop->cross_fit;
  if (!c->folds || c->gain > c->u_gain) return FG_OK;
  const char *what = loop->points.discs ? "discs" : "bumps";
  if (of_single_bumps(&loop->set))
    return fg_scan_loop_bumps_note(
        ctx, &loop->bumps,
        "points: the error of bumps that took no part in the search does not fall (%.3g um before, "
        "%.3g um after): what single bumps do, others cannot foretell",
        c->before_um, c->after_um);
  return fg_scan_loop_bumps_note(
      ctx, &loop->bumps,
      "points: the error of %s that took no part in the search %s (%.3g um before, %.3g um after): "
      "what was found does not show that it foretells other %s; scan more of them",
      what, c->gain > 0 ? "falls by less than its standard error" : "does not fall", c->before_um,
      c->after_um, what);
}

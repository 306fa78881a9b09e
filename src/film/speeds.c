/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stability map: a bearing over the speed, and the speed from which on its rotor whirls. */
#include <math.h>

#include "film/bearing.h"
#include "foilgauge/memory.h"

enum { REFINEMENTS = 12 };
static const double speed_close = 1e-4; /* of a threshold, relative */

/* Logarithm of the critical mass over the rotor's; a film that is stable at every mass counts as
 * one of a very large one, so that a root beside it can be found. */
static double margin_of(const fg_film_report *r, const fg_film_result *at) {
  static const double large = 5;
  return fmin(large, log(at->critical_mass_kg / r->options.rotor_mass_kg));
}

/* Finds the root of the margin between two speeds by false position on the logarithm of the speed
 * (Illinois). */
static fg_status refine_threshold(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace,
                                  const fg_film_result *below, const fg_film_result *above) {
  double x[2] = {log(below->speed_rpm), log(above->speed_rpm)};
  double f[2] = {margin_of(r, below), margin_of(r, above)}, root = x[1];
  int side = -1;
  for (int i = 0; i < REFINEMENTS; i++) {
    double next = (x[0] * f[1] - x[1] * f[0]) / (f[1] - f[0]);
    bool close = fabs(next - root) < speed_close;
    fg_film_result at;
    root = next;
    if (close) break;
    FG_TRY(fg_film_solve_bearing(ctx, r, workspace, &r->bearing, exp(root), FG_FILM_AFRESH, &at));
    if (at.outcome == FG_FILM_UNSOLVED) return FG_OK;
    int end = margin_of(r, &at) > 0 ? 0 : 1;
    x[end] = root;
    f[end] = margin_of(r, &at);
    if (side == end) f[1 - end] /= 2;
    side = end;
  }
  r->threshold_rpm = exp(root);
  return FG_OK;
}

static fg_status allocate_speeds(fg_context *ctx, fg_film_report *r) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, r->options.speeds, sizeof *r->speed, &block));
  r->speed = block;
  r->speeds = r->options.speeds;
  return FG_OK;
}

/* From the highest speed, where the film is thickest, downwards: each solution leads to the next.
 */
fg_status fg_film_map_speeds(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace) {
  const fg_film_options *o = &r->options;
  FG_TRY(allocate_speeds(ctx, r));
  fg_film_start start = FG_FILM_AFRESH;
  for (size_t i = r->speeds; i-- > 0;) {
    double share = r->speeds > 1 ? (double)i / (double)(r->speeds - 1) : 0;
    double speed = o->speed_low_rpm * pow(o->speed_high_rpm / o->speed_low_rpm, share);
    FG_TRY(fg_film_solve_bearing(ctx, r, workspace, &r->bearing, speed, start, &r->speed[i]));
    start = r->speed[i].outcome == FG_FILM_UNSOLVED ? FG_FILM_AFRESH : FG_FILM_ONWARD;
  }
  for (size_t i = 1; i < r->speeds; i++) {
    const fg_film_result *below = &r->speed[i - 1], *above = &r->speed[i];
    if (!(margin_of(r, below) > 0) || !(margin_of(r, above) <= 0)) continue;
    return refine_threshold(ctx, r, workspace, below, above);
  }
  return FG_OK;
}

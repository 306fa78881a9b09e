/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits of a bearing's film: the largest load at its speed, and the lowest speed at its load
 * (where the rotor lifts off, and touches down when it coasts). */
#include <math.h>

#include "film/bearing.h"

/* A rotor that coasts stays on its film: steps are short, so that one film is followed. */
static const double stride = 1.06, farthest = 1e4;
enum { HALVINGS = 10 };

/* The bearing with its load, or its speed, times a factor. */
static fg_status carries(fg_context *ctx, const fg_film_report *r, fg_film_workspace *workspace,
                         double load_factor, double speed_factor, bool *does) {
  fg_film_report changed = *r;
  fg_film_result result;
  changed.options.load_n *= load_factor;
  FG_TRY(fg_film_keep_film(ctx, &changed, workspace, &r->bearing,
                           r->options.speed_rpm * speed_factor, &result));
  *does = result.outcome == FG_FILM_SOLVED;
  return FG_OK;
}

/* Largest factor, of the load or of the inverse speed, with which the film is whole; NaN where none
 * up to `farthest` ends it. */
static fg_status find_film_limit(fg_context *ctx, const fg_film_report *r,
                                 fg_film_workspace *workspace, bool of_load, double *limit) {
  double good = 1, bad = stride;
  bool does = true;
  *limit = NAN;
  for (; does; bad *= does ? stride : 1) {
    if (bad > farthest) return FG_OK;
    FG_TRY(carries(ctx, r, workspace, of_load ? bad : 1, of_load ? 1 : 1 / bad, &does));
    if (does) good = bad;
  }
  for (int i = 0; i < HALVINGS; i++) {
    double middle = sqrt(good * bad);
    FG_TRY(carries(ctx, r, workspace, of_load ? middle : 1, of_load ? 1 : 1 / middle, &does));
    *(does ? &good : &bad) = middle;
  }
  *limit = good;
  return FG_OK;
}

/* Finds both limits, each on from the solved bearing. */
static fg_status find_limits(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace,
                             const fg_film_mark *solved) {
  double factor;
  FG_TRY(find_film_limit(ctx, r, workspace, true, &factor));
  r->load_capacity_n = r->options.load_n * factor;
  fg_film_mark_return(solved, workspace);
  FG_TRY(find_film_limit(ctx, r, workspace, false, &factor));
  r->lift_off_rpm = r->options.speed_rpm / factor;
  return FG_OK;
}

fg_status fg_film_find_capacity(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace) {
  fg_film_mark solved;
  if (r->at.outcome != FG_FILM_SOLVED) return FG_OK;
  FG_TRY(fg_film_mark_open(ctx, workspace, &solved));
  fg_status status = find_limits(ctx, r, workspace, &solved);
  fg_film_mark_close(&solved);
  return status;
}

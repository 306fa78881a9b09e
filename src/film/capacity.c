/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits of a bearing's film: the largest load at its speed, and the lowest speed at its load
 * (where the rotor lifts off, and touches down when it coasts). */
#include <math.h>

#include "film/bearing.h"

/* Steps are short, so that one film is followed; where it ends, other films are sought this much
 * further on as well. */
static const double stride = 1.06, farthest = 1e4;
static const double leaps[] = {1, 1.25, 2};
enum { HALVINGS = 10 };

/* A search for the largest factor, of the load or of the inverse speed. */
typedef struct limit_search {
  const fg_film_report *report;
  fg_film_workspace *workspace;
  bool of_load;
} limit_search;

/* Goes on from the workspace's film, or to any other one. */
typedef fg_status film_step(fg_context *, const fg_film_report *, fg_film_workspace *,
                            const fg_film_bearing *, double, fg_film_result *);

static fg_status solve_step(fg_context *ctx, const limit_search *search, film_step *step,
                            double factor, bool *does) {
  const fg_film_report *r = search->report;
  fg_film_report changed = *r;
  fg_film_result result;
  if (search->of_load) changed.options.load_n *= factor;
  FG_TRY(step(ctx, &changed, search->workspace, &r->bearing,
              r->options.speed_rpm / (search->of_load ? 1 : factor), &result));
  *does = fg_film_rests(&result);
  return FG_OK;
}

/* Follows one film from `good` on to its end, which `good` becomes. */
static fg_status follow_to_end(fg_context *ctx, const limit_search *search, double *good) {
  double bad = *good;
  bool does = true;
  while (does) {
    bad *= stride;
    if (bad > farthest) return FG_OK;
    FG_TRY(solve_step(ctx, search, fg_film_keep_film, bad, &does));
    if (does) *good = bad;
  }
  for (int i = 0; i < HALVINGS; i++) {
    double middle = sqrt(*good * bad);
    FG_TRY(solve_step(ctx, search, fg_film_keep_film, middle, &does));
    *(does ? good : &bad) = middle;
  }
  return FG_OK;
}

/* A rotor that moves this far, over C, is on another film. */
static const double moved = 0.1;

/* Seeks a film beyond the end of one; without one the workspace's film stays. `jumps` where the
 * rotor is at another place on it: else it is the same one, past a state that was not found. */
static fg_status pass_over(fg_context *ctx, const limit_search *search, double *good, bool *passes,
                           bool *jumps) {
  fg_film_mark end;
  const double *place = search->workspace->state.place;
  FG_TRY(fg_film_mark_open(ctx, search->workspace, &end));
  fg_status status = FG_OK;
  *passes = false;
  for (size_t i = 0; i < sizeof leaps / sizeof *leaps && status == FG_OK && !*passes; i++) {
    double beyond = *good * stride * leaps[i];
    fg_film_mark_return(&end, search->workspace);
    if (i == 0) status = solve_step(ctx, search, fg_film_change_film, beyond, passes);
    if (status == FG_OK && !*passes)
      status = solve_step(ctx, search, fg_film_solve_from_places, beyond, passes);
    if (*passes) *good = beyond;
  }
  const double *from = end.state.place;
  *jumps = *passes && hypot(place[0] - from[0], place[1] - from[1]) > moved;
  if (!*passes) fg_film_mark_return(&end, search->workspace);
  fg_film_mark_close(&end);
  return status;
}

/* The largest factor with a whole film, followed over the ends of films; NaN where none up to
 * `farthest` is the last. `first` is where the first film ends, NaN where it is the only one. */
static fg_status find_film_limit(fg_context *ctx, const limit_search *search, double *limit,
                                 double *first) {
  double good = 1;
  bool passes = true, jumps;
  *first = NAN;
  while (passes) {
    FG_TRY(follow_to_end(ctx, search, &good));
    *limit = good * stride > farthest ? NAN : good;
    if (isnan(*limit)) return FG_OK;
    FG_TRY(pass_over(ctx, search, &good, &passes, &jumps));
    if (jumps && isnan(*first)) *first = *limit;
  }
  return FG_OK;
}

/* Finds both limits, each on from the solved bearing. */
static fg_status find_limits(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace,
                             const fg_film_mark *solved) {
  double factor, first;
  limit_search search = {r, workspace, true};
  FG_TRY(find_film_limit(ctx, &search, &factor, &first));
  r->load_capacity_n = r->options.load_n * factor;
  r->film_ends_n = r->options.load_n * first;
  fg_film_mark_return(solved, workspace);
  search.of_load = false;
  FG_TRY(find_film_limit(ctx, &search, &factor, &first));
  r->lift_off_rpm = r->options.speed_rpm / factor;
  r->film_ends_rpm = r->options.speed_rpm / first;
  return FG_OK;
}

fg_status fg_film_find_capacity(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace) {
  fg_film_mark solved;
  if (r->actual.outcome != FG_FILM_SOLVED) return FG_OK;
  FG_TRY(fg_film_mark_open(ctx, workspace, &solved));
  fg_status status = find_limits(ctx, r, workspace, &solved);
  fg_film_mark_close(&solved);
  return status;
}

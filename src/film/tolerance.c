/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tolerances on the clearance that keep the threshold speed: of every bump by itself, by drawn
 * bearings, and of all bumps alike.
 *
 * A bearing's threshold speed is not solved for. Below it the critical mass is above the rotor's:
 * the highest of some speeds at which that is so decides. */
#include <math.h>
#include <stdlib.h>

#include "film/bearing.h"

/* Bearings of a trial, the share of them that must keep it, and steps to a tolerance. */
enum { TRIAL_DRAWS = 40, DOUBLINGS = 8, REFINEMENTS = 2 };
/* Steps of the speed over the interval. */
enum { INTERVAL_STEPS = 4 };
static const double share_kept = 0.95;

/* Order of the steps: the upper end of the interval decides ABOVE, and the lower one nearly always
 * the others. */
static const int step_order[] = {0, INTERVAL_STEPS, 1, 2, 3};

/* Each speed is gone to from the film that the bearing has: from one speed to another it might be
 * on another film. */
static fg_status compare_threshold_from(fg_context *ctx, const fg_film_report *r,
                                        fg_film_workspace *workspace,
                                        const fg_film_bearing *bearing, const fg_film_mark *own,
                                        fg_film_threshold_verdict *threshold) {
  for (int i = 0; i <= INTERVAL_STEPS; i++) {
    fg_film_result at;
    double share = r->options.within_pct / 100 * (1 - 2. * step_order[i] / INTERVAL_STEPS);
    double rpm = r->tolerance.threshold_rpm * (1 + share);
    fg_film_mark_return(own, workspace);
    FG_TRY(fg_film_solve_bearing(ctx, r, workspace, bearing, rpm, FG_FILM_ONWARD, &at));
    if (at.outcome == FG_FILM_UNSOLVED) /* beyond its end */
      FG_TRY(fg_film_seek_film(ctx, r, workspace, bearing, rpm, &at));
    if (at.outcome != FG_FILM_SOLVED) return FG_OK;
    if (!fg_film_is_stable(&at, r->options.rotor_mass_kg)) continue;
    *threshold = i ? FG_FILM_THRESHOLD_WITHIN : FG_FILM_THRESHOLD_ABOVE;
    return FG_OK;
  }
  *threshold = FG_FILM_THRESHOLD_BELOW;
  return FG_OK;
}

fg_status fg_film_compare_threshold(fg_context *ctx, const fg_film_report *r,
                                    fg_film_workspace *workspace, const fg_film_bearing *bearing,
                                    fg_film_threshold_verdict *threshold) {
  fg_film_mark own;
  *threshold = FG_FILM_THRESHOLD_NO_FILM;
  FG_TRY(fg_film_mark_open(ctx, workspace, &own));
  fg_status status = compare_threshold_from(ctx, r, workspace, bearing, &own, threshold);
  fg_film_mark_return(&own, workspace);
  fg_film_mark_close(&own);
  return status;
}

/* Trials of every bump by itself, which two tolerances ask for. */
enum { TRIALS_MAX = 2 * (DOUBLINGS + REFINEMENTS + 1) };
typedef struct tolerance_trials {
  double um[TRIALS_MAX], within[TRIALS_MAX], not_lower[TRIALS_MAX];
  size_t count;
} tolerance_trials;

/* A kind of tolerance that is tried. */
typedef struct tolerance_trial {
  fg_film_report *report;
  const fg_film_bearing *perfect;
  fg_film_workspace *workspace;
  double sign;    /* of all bumps alike; 0: of every bump by itself */
  bool not_lower; /* of that: a higher threshold is kept, too */
  tolerance_trials *known;
} tolerance_trial;

static fg_status try_alike(fg_context *ctx, const tolerance_trial *t, double um, bool *kept) {
  fg_film_bearing moved = *t->perfect;
  fg_film_threshold_verdict threshold;
  for (size_t i = 0; i < moved.count; i++)
    moved.clearance_mm[i] += t->sign * um * 1e-3;
  FG_TRY(fg_film_compare_threshold(ctx, t->report, t->workspace, &moved, &threshold));
  *kept = threshold == FG_FILM_THRESHOLD_WITHIN;
  return FG_OK;
}

static fg_status add_trial(fg_context *ctx, const tolerance_trial *t, double um) {
  fg_film_draws draws;
  tolerance_trials *known = t->known;
  fg_status status =
      fg_film_draw_spread(ctx, t->report, t->perfect, t->workspace, um * 1e-3, TRIAL_DRAWS, &draws);
  known->um[known->count] = um;
  known->within[known->count] = draws.within.share;
  known->not_lower[known->count++] = draws.not_lower.share;
  free(draws.result);
  return status;
}

static fg_status try_tolerance(fg_context *ctx, const tolerance_trial *t, double um, bool *kept) {
  tolerance_trials *known = t->known;
  size_t at = 0;
  if (t->sign != 0) return try_alike(ctx, t, um, kept);
  while (at < known->count && known->um[at] != um)
    at++;
  if (at == known->count) FG_TRY(add_trial(ctx, t, um));
  *kept = (t->not_lower ? known->not_lower : known->within)[at] >= share_kept;
  return FG_OK;
}

/* The widest tolerance up to which all keep it: from a narrow one doubled until one does not (large
 * scatter may raise a threshold that small scatter lowers), then between the last two. The draws of
 * all trials are the same. 0: the narrowest does not. */
static fg_status find_widest(fg_context *ctx, const tolerance_trial *t, double *um) {
  double widest = FG_FILM_WIDEST_SHARE * t->report->clearance_um;
  double low = 0, high = ldexp(widest, -DOUBLINGS);
  bool kept = true;
  while (high <= widest && kept) {
    FG_TRY(try_tolerance(ctx, t, high, &kept));
    if (kept) low = high;
    if (kept) high *= 2;
  }
  for (int i = 0; i < REFINEMENTS && !kept && low > 0; i++) {
    double middle = 0.5 * (low + high);
    FG_TRY(try_tolerance(ctx, t, middle, &kept));
    *(kept ? &low : &high) = middle;
    kept = false;
  }
  *um = kept ? INFINITY : low;
  return FG_OK;
}

static fg_status find_tolerances(fg_context *ctx, fg_film_report *r, const fg_film_bearing *perfect,
                                 fg_film_workspace *workspace) {
  fg_film_tolerance *tolerance = &r->tolerance;
  tolerance_trials known = {.count = 0};
  for (int each = 0; each < 2; each++)
    FG_TRY(find_widest(ctx, &(tolerance_trial){r, perfect, workspace, 0, each == 1, &known},
                       each ? &tolerance->each_not_lower_um : &tolerance->each_um));
  for (int side = 0; side < 2; side++)
    FG_TRY(find_widest(ctx, &(tolerance_trial){r, perfect, workspace, side ? 1 : -1, false, NULL},
                       &tolerance->alike_um[side]));
  return FG_OK;
}

/* The threshold speed as designed, and tolerances on from the film below it. */
static fg_status find_threshold_and_tolerances(fg_context *ctx, fg_film_report *r,
                                               const fg_film_bearing *perfect,
                                               fg_film_workspace *workspace,
                                               const fg_film_mark *solved) {
  FG_TRY(fg_film_find_threshold_speed(ctx, r, workspace, perfect, &r->tolerance.threshold_rpm));
  if (isfinite(r->tolerance.threshold_rpm)) FG_TRY(find_tolerances(ctx, r, perfect, workspace));
  fg_film_mark_return(solved, workspace);
  return FG_OK;
}

fg_status fg_film_find_tolerance(fg_context *ctx, fg_film_report *r, const fg_film_bearing *perfect,
                                 fg_film_workspace *workspace) {
  fg_film_mark solved;
  r->tolerance = (fg_film_tolerance){false, NAN, NAN, NAN, {NAN, NAN}};
  if (isnan(r->options.within_pct)) return FG_OK;
  r->tolerance.asked = true;
  FG_TRY(fg_film_mark_open(ctx, workspace, &solved));
  fg_status status = find_threshold_and_tolerances(ctx, r, perfect, workspace, &solved);
  fg_film_mark_close(&solved);
  return status;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stability map: a bearing over the speed, and the speed from which on its rotor whirls. */
#include <math.h>
#include <stdlib.h>

#include "film/bearing.h"
#include "foilgauge/memory.h"

enum { REFINEMENTS = 12 };
static const double speed_close = 1e-4; /* of a threshold, relative */

/* Above 0 where the rotor is stable at a speed. */
typedef double stability_margin(const fg_film_report *, const fg_film_result *);

/* Logarithm of the critical mass over the rotor's, within limits, so that a root can be found
 * beside a film on which no rotor whirls, or every one. */
static double mass_margin(const fg_film_report *r, const fg_film_result *at) {
  static const double large = 5;
  double mass_kg = r->options.rotor_mass_kg, critical_kg = at->critical_mass_kg;
  if (isnan(critical_kg)) return NAN;
  double margin = fmax(log(critical_kg / mass_kg), log(mass_kg / at->stable_again_kg));
  return fmax(-large, fmin(large, margin));
}

static double damping_margin(const fg_film_report *r, const fg_film_result *at) {
  (void)r;
  return at->log_decrement;
}

/* A bearing over the speed; `speed` is one result per speed of the options. */
typedef struct speed_map {
  const fg_film_report *report;
  const fg_film_bearing *bearing;
  bool with_modes;
  fg_film_result *speed;
  size_t speeds;
} speed_map;

/* A speed of the map: on from the one before, or by every path. */
static fg_status solve_speed(fg_context *ctx, const speed_map *map, fg_film_workspace *workspace,
                             double speed_rpm, bool onward, fg_film_result *at) {
  fg_film_modes unused;
  const fg_film_report *r = map->report;
  at->outcome = FG_FILM_UNSOLVED;
  if (onward)
    FG_TRY(fg_film_solve_bearing(ctx, r, workspace, map->bearing, speed_rpm, FG_FILM_ONWARD, at));
  if (at->outcome == FG_FILM_UNSOLVED)
    FG_TRY(fg_film_seek_film(ctx, r, workspace, map->bearing, speed_rpm, at));
  if (!map->with_modes) return FG_OK;
  return fg_film_find_modes(ctx, r, workspace, at, &unused);
}

/* Two speeds between which the rotor gets unstable. */
typedef struct speed_interval {
  const fg_film_result *below, *above;
  stability_margin *margin;
} speed_interval;

/* Finds the root of the margin between two speeds by false position on the logarithm of the speed
 * (Illinois). */
static fg_status refine_threshold(fg_context *ctx, const speed_map *map,
                                  fg_film_workspace *workspace, const speed_interval *between,
                                  double *rpm) {
  const fg_film_report *r = map->report;
  double x[2] = {log(between->below->speed_rpm), log(between->above->speed_rpm)};
  double f[2] = {between->margin(r, between->below), between->margin(r, between->above)};
  double root = x[1];
  int side = -1;
  for (int i = 0; i < REFINEMENTS; i++) {
    double next = (x[0] * f[1] - x[1] * f[0]) / (f[1] - f[0]);
    bool close = fabs(next - root) < speed_close;
    fg_film_result at;
    root = next;
    if (close) break;
    FG_TRY(solve_speed(ctx, map, workspace, exp(root), false, &at));
    double margin = between->margin(r, &at);
    if (isnan(margin)) return FG_OK;
    int end = margin > 0 ? 0 : 1;
    x[end] = root;
    f[end] = margin;
    if (side == end) f[1 - end] /= 2;
    side = end;
  }
  *rpm = exp(root);
  return FG_OK;
}

/* The lowest speed of the map at which a margin vanishes; NaN where none does. */
static fg_status find_threshold(fg_context *ctx, const speed_map *map, fg_film_workspace *workspace,
                                stability_margin *margin, double *rpm) {
  *rpm = NAN;
  for (size_t i = 1; i < map->speeds; i++) {
    const speed_interval between = {&map->speed[i - 1], &map->speed[i], margin};
    if (!(margin(map->report, between.below) > 0) || !(margin(map->report, between.above) <= 0))
      continue;
    return refine_threshold(ctx, map, workspace, &between, rpm);
  }
  return FG_OK;
}

/* Speeds without a film above one that has one are solved on from that. */
static fg_status close_gaps(fg_context *ctx, speed_map *map, fg_film_workspace *workspace) {
  for (size_t i = 1; i < map->speeds; i++) {
    fg_film_result *at = &map->speed[i], *below = &map->speed[i - 1];
    if (at->outcome != FG_FILM_UNSOLVED || below->outcome == FG_FILM_UNSOLVED) continue;
    FG_TRY(solve_speed(ctx, map, workspace, below->speed_rpm, false, below));
    FG_TRY(solve_speed(ctx, map, workspace, at->speed_rpm, below->outcome != FG_FILM_UNSOLVED, at));
  }
  return FG_OK;
}

/* From the highest speed, where the film is thickest, downwards: each solution leads to the next.
 */
static fg_status solve_speed_map(fg_context *ctx, speed_map *map, fg_film_workspace *workspace) {
  const fg_film_options *o = &map->report->options;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, o->speeds, sizeof *map->speed, &block));
  map->speed = block;
  map->speeds = o->speeds;
  bool onward = false;
  for (size_t i = map->speeds; i-- > 0;) {
    double share = map->speeds > 1 ? (double)i / (double)(map->speeds - 1) : 0;
    double speed = o->speed_low_rpm * pow(o->speed_high_rpm / o->speed_low_rpm, share);
    FG_TRY(solve_speed(ctx, map, workspace, speed, onward, &map->speed[i]));
    onward = map->speed[i].outcome != FG_FILM_UNSOLVED;
  }
  return close_gaps(ctx, map, workspace);
}

fg_status fg_film_map_speeds(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace) {
  speed_map map = {.report = r, .bearing = &r->bearing, .with_modes = true};
  fg_status status = solve_speed_map(ctx, &map, workspace);
  r->speed = map.speed;
  r->speeds = map.speeds;
  FG_TRY(status);
  FG_TRY(find_threshold(ctx, &map, workspace, damping_margin, &r->threshold_eigen_rpm));
  map.with_modes = false;
  return find_threshold(ctx, &map, workspace, mass_margin, &r->threshold_rpm);
}

fg_status fg_film_find_threshold_speed(fg_context *ctx, const fg_film_report *r,
                                       fg_film_workspace *workspace, const fg_film_bearing *bearing,
                                       double *rpm) {
  speed_map map = {.report = r, .bearing = bearing};
  fg_status status = solve_speed_map(ctx, &map, workspace);
  if (status == FG_OK) status = find_threshold(ctx, &map, workspace, mass_margin, rpm);
  free(map.speed);
  return status;
}

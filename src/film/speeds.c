/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stability map: a bearing over the speed, and the speed from which on its rotor whirls. */
#include <math.h>
#include <stdlib.h>

#include "film/bearing.h"
#include "foilgauge/memory.h"

/* Steps by false position, and by halves behind them: where the rotor passes to another film, its
 * margin jumps. */
enum { FALSE_POSITIONS = 10, HALVINGS = 16 };
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
  static const double large = 20;
  (void)r;
  return isnan(at->log_decrement) ? NAN : fmax(-large, fmin(large, at->log_decrement));
}

/* A bearing over the speed: a result and a film per speed of the options. */
typedef struct speed_map {
  const fg_film_report *report;
  const fg_film_bearing *bearing;
  bool with_modes;
  fg_film_result *speed;
  fg_film_mark *film;
  size_t speeds;
} speed_map;

/* A speed of the map: on from the workspace's film, or by every path where none is whole on it. */
static fg_status solve_speed(fg_context *ctx, const speed_map *map, fg_film_workspace *workspace,
                             double speed_rpm, bool onward, fg_film_result *at) {
  fg_film_modes unused;
  const fg_film_report *r = map->report;
  at->outcome = FG_FILM_UNSOLVED;
  if (onward)
    FG_TRY(fg_film_solve_bearing(ctx, r, workspace, map->bearing, speed_rpm, FG_FILM_ONWARD, at));
  if (!fg_film_rests(at)) {
    fg_film_mark first;
    fg_film_result found;
    FG_TRY(fg_film_mark_open(ctx, workspace, &first));
    fg_status status = fg_film_seek_film(ctx, r, workspace, map->bearing, speed_rpm, &found);
    if (fg_film_rests(&found) || at->outcome == FG_FILM_UNSOLVED)
      *at = found;
    else
      fg_film_mark_return(&first, workspace);
    fg_film_mark_close(&first);
    FG_TRY(status);
  }
  if (!map->with_modes) return FG_OK;
  return fg_film_find_modes(ctx, r, workspace, at, &unused);
}

/* Finds the root of the margin between two neighbouring speeds of the map by false position on the
 * logarithm of the speed (Illinois), on from the film below: where that one ends, it is the jump.
 */
static fg_status refine_threshold(fg_context *ctx, const speed_map *map,
                                  fg_film_workspace *workspace, size_t below,
                                  stability_margin *margin_of, double *rpm) {
  const fg_film_report *r = map->report;
  const fg_film_result *ends = &map->speed[below];
  double x[2] = {log(ends[0].speed_rpm), log(ends[1].speed_rpm)};
  double f[2] = {margin_of(r, &ends[0]), margin_of(r, &ends[1])};
  double root = x[1];
  int side = -1;
  for (int i = 0; i < FALSE_POSITIONS + HALVINGS; i++) {
    bool halves = i >= FALSE_POSITIONS;
    double next = halves ? (x[0] + x[1]) / 2 : (x[0] * f[1] - x[1] * f[0]) / (f[1] - f[0]);
    bool close = fabs(next - root) < speed_close;
    fg_film_result at;
    root = next;
    if (close) break;
    fg_film_mark_return(&map->film[below], workspace);
    FG_TRY(solve_speed(ctx, map, workspace, exp(root), true, &at));
    double margin = margin_of(r, &at);
    if (isnan(margin)) return FG_OK;
    int end = margin > 0 ? 0 : 1;
    x[end] = root;
    f[end] = margin;
    if (side == end) f[1 - end] /= 2;
    side = end;
  }
  *rpm = exp(root);
  fg_film_mark_return(&map->film[below], workspace);
  return FG_OK;
}

/* The lowest speed of the map at which a margin vanishes; NaN where none does. */
static fg_status find_threshold(fg_context *ctx, const speed_map *map, fg_film_workspace *workspace,
                                stability_margin *margin, double *rpm) {
  *rpm = NAN;
  for (size_t i = 1; i < map->speeds; i++) {
    bool stable_below = margin(map->report, &map->speed[i - 1]) > 0;
    if (!stable_below || !(margin(map->report, &map->speed[i]) <= 0)) continue;
    return refine_threshold(ctx, map, workspace, i - 1, margin, rpm);
  }
  return FG_OK;
}

/* Solves a speed of the map on from another one's film, or from the workspace's. */
static fg_status solve_row(fg_context *ctx, speed_map *map, fg_film_workspace *workspace, size_t i,
                           bool onward) {
  const fg_film_options *o = &map->report->options;
  double share = map->speeds > 1 ? (double)i / (double)(map->speeds - 1) : 0;
  double speed_rpm = o->map.low_rpm * pow(o->map.high_rpm / o->map.low_rpm, share);
  FG_TRY(solve_speed(ctx, map, workspace, speed_rpm, onward, &map->speed[i]));
  fg_film_mark_close(&map->film[i]);
  return fg_film_mark_open(ctx, workspace, &map->film[i]);
}

/* Speeds without a film above one that has one are solved on from that. */
static fg_status close_gaps(fg_context *ctx, speed_map *map, fg_film_workspace *workspace) {
  for (size_t i = 1; i < map->speeds; i++) {
    if (map->speed[i].outcome != FG_FILM_UNSOLVED) continue;
    if (map->speed[i - 1].outcome == FG_FILM_UNSOLVED) continue;
    fg_film_mark_return(&map->film[i - 1], workspace);
    FG_TRY(solve_row(ctx, map, workspace, i, true));
  }
  return FG_OK;
}

/* Rows on from the bearing's own film at the options' speed, upwards and downwards: each leads to
 * the next, so that the map shows the film that the bearing has. */
static fg_status solve_rows(fg_context *ctx, speed_map *map, fg_film_workspace *workspace,
                            const fg_film_mark *own) {
  const fg_film_options *o = &map->report->options;
  double range = log(o->map.high_rpm / o->map.low_rpm);
  double place = log(o->speed_rpm / o->map.low_rpm) / range * (double)(map->speeds - 1);
  size_t first = (size_t)fmax(0, fmin((double)map->speeds, ceil(place - 1e-9)));
  bool onward = true;
  for (size_t i = first; i < map->speeds; i++) {
    FG_TRY(solve_row(ctx, map, workspace, i, onward));
    onward = map->speed[i].outcome != FG_FILM_UNSOLVED;
  }
  fg_film_mark_return(own, workspace);
  onward = true;
  for (size_t i = first; i-- > 0;) {
    FG_TRY(solve_row(ctx, map, workspace, i, onward));
    onward = map->speed[i].outcome != FG_FILM_UNSOLVED;
  }
  return close_gaps(ctx, map, workspace);
}

static fg_status solve_speed_map(fg_context *ctx, speed_map *map, fg_film_workspace *workspace) {
  size_t speeds = map->report->options.map.speeds;
  fg_film_mark own;
  void *block;
  FG_TRY(fg_memory_allocate(ctx, speeds, sizeof *map->speed, &block));
  map->speed = block;
  FG_TRY(fg_memory_allocate(ctx, speeds, sizeof *map->film, &block));
  map->film = block;
  map->speeds = speeds;
  for (size_t i = 0; i < speeds; i++)
    map->speed[i].outcome = FG_FILM_UNSOLVED;
  FG_TRY(fg_film_mark_open(ctx, workspace, &own));
  fg_status status = solve_rows(ctx, map, workspace, &own);
  fg_film_mark_close(&own);
  return status;
}

static void close_films(speed_map *map) {
  for (size_t i = 0; map->film && i < map->speeds; i++)
    fg_film_mark_close(&map->film[i]);
  free(map->film);
}

static fg_status find_both_thresholds(fg_context *ctx, fg_film_report *r, speed_map *map,
                                      fg_film_workspace *workspace) {
  FG_TRY(find_threshold(ctx, map, workspace, damping_margin, &r->threshold_eigen_rpm));
  map->with_modes = false;
  return find_threshold(ctx, map, workspace, mass_margin, &r->threshold_rpm);
}

fg_status fg_film_map_speeds(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace) {
  speed_map map = {.report = r, .bearing = &r->bearing, .with_modes = true};
  fg_status status = solve_speed_map(ctx, &map, workspace);
  r->by_speed = map.speed;
  r->speed_count = map.speeds;
  if (status == FG_OK) status = find_both_thresholds(ctx, r, &map, workspace);
  close_films(&map);
  return status;
}

fg_status fg_film_find_threshold_speed(fg_context *ctx, const fg_film_report *r,
                                       fg_film_workspace *workspace, const fg_film_bearing *bearing,
                                       double *rpm) {
  speed_map map = {.report = r, .bearing = bearing};
  fg_status status = solve_speed_map(ctx, &map, workspace);
  if (status == FG_OK) status = find_threshold(ctx, &map, workspace, mass_margin, rpm);
  close_films(&map);
  free(map.speed);
  return status;
}

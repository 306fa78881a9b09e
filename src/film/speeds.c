/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stability map: a bearing over the speed, and the speed from which on its rotor whirls. */
#include <math.h>
#include <stdlib.h>

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

/* A bearing over the speed; `speed` is one result per speed of the options. */
typedef struct speed_map {
  const fg_film_report *report;
  const fg_film_bearing *bearing;
  fg_film_result *speed;
  size_t speeds;
  double threshold_rpm;
} speed_map;

/* Finds the root of the margin between two speeds by false position on the logarithm of the speed
 * (Illinois). */
static fg_status refine_threshold(fg_context *ctx, speed_map *map, fg_film_workspace *workspace,
                                  const fg_film_result *below, const fg_film_result *above) {
  const fg_film_report *r = map->report;
  double x[2] = {log(below->speed_rpm), log(above->speed_rpm)};
  double f[2] = {margin_of(r, below), margin_of(r, above)}, root = x[1];
  int side = -1;
  for (int i = 0; i < REFINEMENTS; i++) {
    double next = (x[0] * f[1] - x[1] * f[0]) / (f[1] - f[0]);
    bool close = fabs(next - root) < speed_close;
    fg_film_result at;
    root = next;
    if (close) break;
    FG_TRY(fg_film_solve_bearing(ctx, r, workspace, map->bearing, exp(root), FG_FILM_AFRESH, &at));
    if (at.outcome == FG_FILM_UNSOLVED) return FG_OK;
    int end = margin_of(r, &at) > 0 ? 0 : 1;
    x[end] = root;
    f[end] = margin_of(r, &at);
    if (side == end) f[1 - end] /= 2;
    side = end;
  }
  map->threshold_rpm = exp(root);
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
  fg_film_start start = FG_FILM_AFRESH;
  for (size_t i = map->speeds; i-- > 0;) {
    double share = map->speeds > 1 ? (double)i / (double)(map->speeds - 1) : 0;
    double speed = o->speed_low_rpm * pow(o->speed_high_rpm / o->speed_low_rpm, share);
    FG_TRY(fg_film_solve_bearing(ctx, map->report, workspace, map->bearing, speed, start,
                                 &map->speed[i]));
    start = map->speed[i].outcome == FG_FILM_UNSOLVED ? FG_FILM_AFRESH : FG_FILM_ONWARD;
  }
  for (size_t i = 1; i < map->speeds; i++) {
    const fg_film_result *below = &map->speed[i - 1], *above = &map->speed[i];
    if (!(margin_of(map->report, below) > 0) || !(margin_of(map->report, above) <= 0)) continue;
    return refine_threshold(ctx, map, workspace, below, above);
  }
  return FG_OK;
}

fg_status fg_film_map_speeds(fg_context *ctx, fg_film_report *r, fg_film_workspace *workspace) {
  speed_map map = {.report = r, .bearing = &r->bearing, .threshold_rpm = NAN};
  fg_status status = solve_speed_map(ctx, &map, workspace);
  r->speed = map.speed;
  r->speeds = map.speeds;
  r->threshold_rpm = map.threshold_rpm;
  return status;
}

fg_status fg_film_find_threshold_speed(fg_context *ctx, const fg_film_report *r,
                                       fg_film_workspace *workspace, const fg_film_bearing *bearing,
                                       double *rpm) {
  speed_map map = {.report = r, .bearing = bearing, .threshold_rpm = NAN};
  fg_status status = solve_speed_map(ctx, &map, workspace);
  *rpm = map.threshold_rpm;
  free(map.speed);
  return status;
}

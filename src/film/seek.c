/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A film where none is known yet: from a centred rotor, from a faster one, and from rotors held at
 * places towards the load, whose film is solved before the load is balanced. */
#include <math.h>

#include "film/bearing.h"

/* Speeds of a faster rotor, whose film is thicker, over that which is sought. */
static const double faster[] = {1.1, 4};

static fg_status solve_from_faster(fg_context *ctx, const fg_film_report *r,
                                   fg_film_workspace *workspace, const fg_film_bearing *bearing,
                                   double speed_rpm, fg_film_result *result) {
  for (size_t i = 0; i < sizeof faster / sizeof *faster; i++) {
    FG_TRY(fg_film_solve_bearing(ctx, r, workspace, bearing, faster[i] * speed_rpm, FG_FILM_AFRESH,
                                 result));
    if (result->outcome == FG_FILM_UNSOLVED) continue;
    FG_TRY(fg_film_solve_bearing(ctx, r, workspace, bearing, speed_rpm, FG_FILM_ONWARD, result));
    if (fg_film_rests(result)) return FG_OK;
  }
  return FG_OK;
}

/* Places where the rotor is held: eccentricities, and attitudes from the load on. */
static const double held_eccentricity[] = {1, 0.7, 1.3}, held_attitude_rad[] = {0.3, 0.7, 1.2};
enum {
  HELD_ATTITUDES = sizeof held_attitude_rad / sizeof *held_attitude_rad,
  HELD_PLACES = HELD_ATTITUDES * sizeof held_eccentricity / sizeof *held_eccentricity
};

/* The film on from a rotor that is held at one of the places. */
static fg_status solve_from_place(fg_context *ctx, const fg_film_report *r,
                                  fg_film_workspace *workspace, const fg_film_bearing *bearing,
                                  double speed_rpm, size_t held, fg_film_result *result) {
  fg_film_case_fill(r, &workspace->film, bearing, speed_rpm, &workspace->at);
  double eccentricity = held_eccentricity[held / HELD_ATTITUDES];
  double angle = atan2(workspace->at.load[1], workspace->at.load[0]) +
                 held_attitude_rad[held % HELD_ATTITUDES];
  const double place[] = {eccentricity * cos(angle), eccentricity * sin(angle)};
  *result = (fg_film_result){.outcome = FG_FILM_UNSOLVED, .speed_rpm = speed_rpm};
  fg_status status =
      fg_film_solve_from_place(ctx, &workspace->film, &workspace->at, place, &workspace->state);
  if (status == FG_ERR_NUMERIC) return FG_OK;
  FG_TRY(status);
  fg_film_case_copy(&workspace->at, workspace->film.columns, &workspace->before);
  return fg_film_solve_bearing(ctx, r, workspace, bearing, speed_rpm, FG_FILM_ONWARD, result);
}

/* The first film on which the rotor rests. */
fg_status fg_film_solve_from_places(fg_context *ctx, const fg_film_report *r,
                                    fg_film_workspace *workspace, const fg_film_bearing *bearing,
                                    double speed_rpm, fg_film_result *result) {
  for (size_t i = 0; i < HELD_PLACES; i++) {
    FG_TRY(solve_from_place(ctx, r, workspace, bearing, speed_rpm, i, result));
    if (fg_film_rests(result)) return FG_OK;
  }
  return FG_OK;
}

/* Rotors further apart than this, over C, are at two places. */
static const double apart = 1e-3;

fg_status fg_film_seek_beside(fg_context *ctx, const fg_film_report *r,
                              fg_film_workspace *workspace, const fg_film_bearing *bearing,
                              const double place[2], fg_film_result *result, bool *found) {
  *found = false;
  for (size_t i = 0; i < HELD_PLACES && !*found; i++) {
    FG_TRY(solve_from_place(ctx, r, workspace, bearing, r->options.speed_rpm, i, result));
    const double *other = workspace->state.place;
    *found = fg_film_rests(result) && hypot(other[0] - place[0], other[1] - place[1]) > apart;
  }
  return FG_OK;
}

fg_status fg_film_seek_film(fg_context *ctx, const fg_film_report *r, fg_film_workspace *workspace,
                            const fg_film_bearing *bearing, double speed_rpm,
                            fg_film_result *result) {
  typedef fg_status way(fg_context *, const fg_film_report *, fg_film_workspace *,
                        const fg_film_bearing *, double, fg_film_result *);
  static way *const others[] = {solve_from_faster, fg_film_solve_from_places};
  FG_TRY(fg_film_solve_bearing(ctx, r, workspace, bearing, speed_rpm, FG_FILM_AFRESH, result));
  for (size_t i = 0; i < sizeof others / sizeof *others && !fg_film_rests(result); i++) {
    fg_film_result other;
    FG_TRY(others[i](ctx, r, workspace, bearing, speed_rpm, &other));
    if (other.speed_rpm == speed_rpm && (other.outcome < result->outcome || fg_film_rests(&other)))
      *result = other;
    else /* back to the first */
      FG_TRY(fg_film_solve_bearing(ctx, r, workspace, bearing, speed_rpm, FG_FILM_AFRESH, result));
  }
  return FG_OK;
}

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rotor's orbit in time: film, foil and rotor integrated together. */
#ifndef FG_FILM_ORBIT_H
#define FG_FILM_ORBIT_H

#include "film/film.h"

typedef struct fg_film_orbit_point {
  double turn, place[2], thinnest;
} fg_film_orbit_point;

typedef struct fg_film_orbit_plan {
  double mass;       /* in units of fg_film_threshold */
  double loss_ratio; /* ratio of whirl at which viscous bumps lose what the loss factor says */
  double pulse;      /* additional load during the first turn, over the load */
  size_t turns, points_per_turn;
} fg_film_orbit_plan;

/* Integrates from the steady state, which a smooth pulse of load disturbs during the first turn.
 * `points` has turns × points_per_turn + 1 elements; `count` gets those before the rotor touches.
 */
fg_status fg_film_integrate_orbit(fg_context *ctx, fg_film *film, const fg_film_case *at,
                                  const fg_film_state *steady, const fg_film_orbit_plan *plan,
                                  fg_film_orbit_point *points, size_t *count);

/* Growth of the orbit's amplitude, logarithm per turn, and its whirl over the speed, from the
 * points after the first quarter; NaN for fewer than two maxima. */
typedef struct fg_film_orbit_growth {
  double per_turn, ratio;
} fg_film_orbit_growth;
fg_film_orbit_growth fg_film_measure_orbit(const fg_film_orbit_point *points, size_t count);

#endif

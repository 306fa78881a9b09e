/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places around a bearing, with their clearances. */
#ifndef FG_BEARING_PLACES_H
#define FG_BEARING_PLACES_H

#include "foilgauge/bearing.h"

/* Known places: clearance and direction. */
typedef struct fg_places {
  double clearance[FG_BEARING_BUMPS_MAX];
  double x[FG_BEARING_BUMPS_MAX], y[FG_BEARING_BUMPS_MAX];
  size_t given[FG_BEARING_BUMPS_MAX]; /* index into the caller's arrays */
  size_t count;
} fg_places;

/* Solves three equations by Cramer's rule; false when they are singular. */
bool fg_places_solve(double a[3][3], const double b[3], double x[3]);

/* The clearance at place i of a rotor shifted by (a, b). */
double fg_places_shifted(const fg_places *places, size_t i, double a, double b);

/* Finds the rotor position with the largest minimum clearance: fills centred_min_mm, centred_at_mm,
 * and the three places that it touches equally. False, and NaN, where the crowns leave half of the
 * bearing open. */
bool fg_places_centre(const fg_places *places, size_t touched[3], fg_bearing_clearance *result);

#endif

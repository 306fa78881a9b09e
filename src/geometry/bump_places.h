/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Assignment of bumps to places of the pitch, and the empty places. */
#ifndef FG_GEOMETRY_BUMP_PLACES_H
#define FG_GEOMETRY_BUMP_PLACES_H

#include "geometry/layout.h"

/* Numbers the bumps, which are in order, by their places: an empty place skips a number. When the
 * design has more bumps than places between the first and the last one, the others are missing at
 * the ends, as far as the strip has room for them there. Sets FG_FOIL_MISSING_BUMP,
 * FG_FOIL_BUMP_COUNT. */
void fg_places_number(const fg_layout *layout, const fg_design *design, const fg_nominal *nominal,
                      fg_foil *foil);

/* Returns the turn from one direction to another, degrees, -180 to 180. */
double fg_places_turn(double from_deg, double to_deg);

#endif

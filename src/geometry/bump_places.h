/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which place of the pitch each bump stands at, and which places are empty. */
#ifndef FG_GEOMETRY_BUMP_PLACES_H
#define FG_GEOMETRY_BUMP_PLACES_H

#include "geometry/layout.h"

/* Numbers the bumps, which are in order, by their places: an empty place leaves a number out. What
 * the design has more than there are places between the first and the last bump is missing at the
 * ends, as far as the strip has room for it there. Sets FG_FOIL_MISSING_BUMP, FG_FOIL_BUMP_COUNT.
 */
void fg_places_number(const fg_layout *layout, const fg_design *design, const fg_nominal *nominal,
                      fg_foil *foil);

/* From one direction to another, degrees, -180 to 180. */
double fg_places_turn(double from_deg, double to_deg);

#endif

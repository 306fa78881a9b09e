/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Local deviations of a foil's lands: dents, creases, places where the rows of a scan jump. */
#ifndef FG_GEOMETRY_LAND_DEVIATION_H
#define FG_GEOMETRY_LAND_DEVIATION_H

#include "geometry/layout.h"

/* Sets `deviates` where the strip between two neighbouring bumps leaves its land over 0.1 mm by
 * more than the scatter of all lands explains, and both edges do: dust and burrs move one. It looks
 * at the land as it should be, a typical fillet away from both bumps: a dent cuts the land that was
 * found, and its stations are then in no fit. FG_ERR_MEMORY. */
fg_status fg_land_deviation_find(fg_context *ctx, const fg_layout *layout, bool *deviates);

#endif

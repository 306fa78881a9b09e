/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Deviations of a foil's fillets: dents, creases, places where the rows of a scan jump. */
#ifndef FG_GEOMETRY_FILLET_DEVIATION_H
#define FG_GEOMETRY_FILLET_DEVIATION_H

#include "geometry/layout.h"

/* Sets `deviates` where the strip between the arc of a bump and the land beside it is no fillet as
 * the others are, a circle that touches both: its radius differs by more than the radii of all
 * explain. So it is where rows jump between the arc and the land. Sets it also where an arc is two
 * displaced pieces of a circle. Bumps that are crushed tell nothing. FG_ERR_MEMORY. */
fg_status fg_fillet_deviation_find(fg_context *ctx, const fg_design *design,
                                   const fg_layout *layout, bool *deviates);

#endif

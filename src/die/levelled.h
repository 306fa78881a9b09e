/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Traces that were levelled by subtracting a line. */
#ifndef FG_DIE_LEVELLED_H
#define FG_DIE_LEVELLED_H

#include "foilgauge/die.h"
#include "geometry/layout.h"

/* Refuses a trace that lost a line a + q x of its heights, as levelling in a profilometer's program
 * does. That is no rotation: it shears the die by q. With y downwards the shear moves the surface
 * of a circle of radius r by u = q r/2 sin 2 psi in the direction psi. The lands leave their circle
 * by u; the radius of a bump's arc, r + u + u'', changes by -3/2 q sin 2 psi of itself. A slope of
 * 0.2 degrees changes bumps at 40 degrees by 0.5 %. Lands and bumps must agree on q: an oval die
 * has bumps that are alike. `trace` has its bumps, y downwards. */
fg_status fg_die_check_levelled(fg_context *ctx, const char *path, const fg_layout *layout,
                                const fg_die_trace *trace);

#endif

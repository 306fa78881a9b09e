/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A foil of kind "arc": a plain strip, one circle from end to end. */
#ifndef FG_GEOMETRY_ARC_FOIL_H
#define FG_GEOMETRY_ARC_FOIL_H

#include "geometry/layout.h"

/* Finds the layout of a plain strip: no bumps; its circle over stretches of the whole strip, which
 * are `lands`. A bent end is a lip (turning.lip_first, lip_last). Facts that become flags go to
 * *flags. `error` gets words (NULL: none) when it is no plain strip. Errors are FG_ERR_MEMORY only.
 */
fg_status fg_arc_foil_layout(fg_context *ctx, const fg_design *design, const fg_strip *strip,
                             fg_layout *layout, unsigned *flags, const char **error);

/* Derives the subtended angle and its dependents from the strip's ends and the overall circle,
 * which is set already. */
void fg_arc_foil_derive(const fg_design *design, const fg_layout *layout, fg_foil *foil);

#endif

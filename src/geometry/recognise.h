/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Test that a measured part is a foil of its design. */
#ifndef FG_GEOMETRY_RECOGNISE_H
#define FG_GEOMETRY_RECOGNISE_H

#include "foilgauge/foil.h"

/* Flags a part that cannot be a foil of the design, whatever its springback and damage, or whose
 * bumps may be another part's that touches it, with the reason in `error`. */
void fg_foil_recognise(const fg_design *design, fg_foil *foil);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The order of a foil's beams. */
#ifndef FG_GEOMETRY_BEAM_NUMBERS_H
#define FG_GEOMETRY_BEAM_NUMBERS_H

#include "foilgauge/foil.h"

/* Sorts the beams, numbers them by the rules of foilgauge/foil.h, sets rotation_deg,
 * FG_FOIL_MISSING_BEAM and FG_FOIL_BEAM_PLACES_UNKNOWN. FG_ERR_MEMORY. */
fg_status fg_beams_number(fg_context *ctx, const fg_design *design, fg_foil *foil);

#endif

/* The order of a foil's beams. */
#ifndef FG_GEOMETRY_BEAM_NUMBERS_H
#define FG_GEOMETRY_BEAM_NUMBERS_H

#include "foilgauge/foil.h"

/* Sorts the beams, numbers them from 1 (foilgauge/foil.h says how) and sets rotation_deg.
 * FG_ERR_MEMORY. */
fg_status fg_beams_number(fg_context *ctx, fg_foil *foil);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Row jumps across beams: after a row that was lost or doubled all edges are displaced along y, so
 * those that cross it obliquely step there, all at one row. */
#ifndef FG_GEOMETRY_BEAM_ROWS_H
#define FG_GEOMETRY_BEAM_ROWS_H

#include "foilgauge/foil.h"

enum { FG_BEAM_JUMPS_MAX = 6 };

typedef struct fg_beam_jumps {
  double y_mm[FG_BEAM_JUMPS_MAX], size_mm[FG_BEAM_JUMPS_MAX];
  size_t count;
  double row_mm;
} fg_beam_jumps;

/* Finds the jumps in the straight edges of all beams of a foil. Edges along y do not show them.
 * FG_ERR_MEMORY. */
fg_status fg_beam_jumps_find(fg_context *ctx, const fg_foil *foil, fg_beam_jumps *jumps);

/* Widens a beam's uncertainties by the jumps across it. */
void fg_beam_jumps_widen(const fg_beam_jumps *jumps, fg_beam *beam);

#endif

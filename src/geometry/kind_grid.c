/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grids: no foil, but marks on a square lattice. */
#include <math.h>

#include "geometry/foil_kind.h"

/* A pitch that is known no better is as good as none; a place that is off by more is on no lattice.
 */
#define U_SHARE_MAX 0.05

static fg_status check_grid(fg_context *ctx, const fg_design *design) {
  const fg_design_grid *grid = &design->grid;
  if (grid->pitch_mm != 0) FG_TRY(fg_design_check_positive(ctx, "pitch_mm", grid->pitch_mm));
  if (grid->u_pitch_mm != 0 && grid->pitch_mm == 0)
    return fg_fail(ctx, FG_ERR_DATA, "u_pitch_mm is %g without pitch_mm; state both",
                   grid->u_pitch_mm);
  const double limit = U_SHARE_MAX * grid->pitch_mm;
  if (!(grid->u_pitch_mm >= 0 && grid->u_pitch_mm <= limit))
    return fg_fail(ctx, FG_ERR_DATA, "u_pitch_mm is %g; it must be from 0 to %g mm",
                   grid->u_pitch_mm, limit);
  if (!(grid->u_place_mm >= 0 && (grid->pitch_mm == 0 || grid->u_place_mm <= limit)))
    return fg_fail(ctx, FG_ERR_DATA, "u_place_mm is %g; it must be from 0 to %g mm",
                   grid->u_place_mm, limit);
  return FG_OK;
}

const fg_foil_row fg_foil_kind_grid = {
    .traits =
        {
            .name = "grid",
            .noun = "a grid",
            .group = FG_DESIGN_GRID,
            .refused = 1u << FG_DESIGN_BEAMS | 1u << FG_DESIGN_DISCS | 1u << FG_DESIGN_ARC,
            .needed = {"marks"},
            .why_no_thickness_measured = "belongs to strips; form is \"grid\"",
            .why_no_gauges = "belong to foils and discs; form is \"grid\"",
            .why_no_station = "form is grid: the station measures foils",
            .why_no_forming = "form \"grid\" has no strip that is bent",
            .is_grid = true,
            .part = FG_QUANTITY_OF_DISC,
            .owners = 1u << FG_QUANTITY_OF_DISC,
            .foil_not = FG_QUANTITY_OF_ARC,
        },
    .check = check_grid,
};

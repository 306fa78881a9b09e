/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Discs: no foil, but round gauges of known diameter. */
#include <math.h>
#include <stdio.h>

#include "geometry/foil_kind.h"

/* A width that is known no better is no gauge. */
#define U_DIAMETERS_MAX_MM 0.1

static fg_status check_discs(fg_context *ctx, const fg_design *design) {
  if (design->discs.count > FG_DIAMETERS_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "diameters_mm has %zu values; at most %d", design->discs.count,
                   FG_DIAMETERS_MAX);
  for (size_t i = 0; i < design->discs.count; i++) {
    char member[48];
    snprintf(member, sizeof member, "diameters_mm[%zu]", i);
    FG_TRY(fg_design_check_positive(ctx, member, design->discs.diameters_mm[i]));
  }
  if (!(design->discs.u_diameters_mm >= 0 && design->discs.u_diameters_mm <= U_DIAMETERS_MAX_MM))
    return fg_fail(ctx, FG_ERR_DATA, "u_diameters_mm is %g; it must be from 0 to %g mm",
                   design->discs.u_diameters_mm, U_DIAMETERS_MAX_MM);
  return FG_OK;
}

const fg_foil_row fg_foil_kind_discs = {
    .traits =
        {
            .name = "discs",
            .noun = "discs",
            .group = FG_DESIGN_DISCS,
            .refused = 1u << FG_DESIGN_BEAMS,
            .built_in = true,
            .why_no_thickness_measured = "belongs to strips; form is \"discs\"",
            .why_no_forming = "form \"discs\" has no strip that is bent",
            .part = FG_QUANTITY_OF_DISC,
            .owners = 1u << FG_QUANTITY_OF_FOIL | 1u << FG_QUANTITY_OF_BUMP |
                      1u << FG_QUANTITY_OF_DISC | 1u << FG_QUANTITY_OF_STRIP |
                      1u << FG_QUANTITY_OF_BEARING,
            .foil_not = FG_QUANTITY_OF_ARC,
        },
    .check = check_discs,
};

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities of a beam of a cantilever foil. Values: geometry/beams.c. */
#include <stddef.h>

#include "quantity/rows.h"

enum {
  EDGES = FG_QUANTITY_BETWEEN_EDGES,
  PAGE = FG_QUANTITY_ON_PAGE,
  TERMINAL = FG_QUANTITY_ON_TERMINAL,
  PICTURE = FG_QUANTITY_ON_PICTURE,
  LOT = FG_QUANTITY_IN_LOT,
  OWN = FG_QUANTITY_IS_OWN,
};

static double length_of(const fg_design *design, const fg_nominal *nominal) {
  (void)nominal;
  return design->beams.length_mm;
}

static double width_of(const fg_design *design, const fg_nominal *nominal) {
  (void)nominal;
  return design->beams.width_mm;
}

static double compliance_of(const fg_design *design, const fg_nominal *nominal) {
  (void)nominal;
  return fg_cantilever_nominal(design).compliance_mm_per_n;
}

static double sagitta_of(const fg_design *design, const fg_nominal *nominal) {
  (void)nominal;
  return fg_cantilever_nominal(design).sagitta_mm;
}

static const fg_quantity rows[] = {
    {.name = "length_mm",
     .unit = "mm",
     .symbol = "L",
     .words = "length from the root line to the tip",
     FG_AT_U(fg_beam, length_mm, u_length_mm),
     .decimals = 4,
     .uses = PAGE | TERMINAL | PICTURE | LOT | OWN,
     .rank = 1,
     .characteristic = "Length",
     .nominal = length_of},
    {.name = "width_mm",
     .unit = "mm",
     .symbol = "w",
     .words = "width halfway along it",
     FG_AT_U(fg_beam, width_mm, u_width_mm),
     .decimals = 4,
     .uses = PAGE | TERMINAL | PICTURE | LOT | OWN | EDGES,
     .rank = 2,
     .characteristic = "Length",
     .nominal = width_of},
    {.name = "length_error_pct",
     .unit = "%",
     .symbol = "e_L",
     .words = "length against the design's",
     FG_AT_U(fg_beam, length_error_pct, u_length_error_pct),
     .decimals = 3,
     .uses = PAGE | OWN,
     .rank = 3},
    {.name = "width_error_pct",
     .unit = "%",
     .symbol = "e_w",
     .words = "width against the design's",
     FG_AT_U(fg_beam, width_error_pct, u_width_error_pct),
     .decimals = 3,
     .uses = PAGE | OWN | EDGES,
     .rank = 4},
    {.name = "compliance_error_pct",
     .unit = "%",
     .symbol = "e_S",
     .words = "compliance against the design's",
     FG_AT_U(fg_beam, follows.compliance_error_pct, follows.u_compliance_error_pct),
     .decimals = 3,
     .uses = PAGE | TERMINAL | PICTURE | LOT | OWN | EDGES,
     .rank = 5},
    {.name = "compliance_mm_per_n",
     .unit = "mm/N",
     .symbol = "S",
     .words = "compliance, eq 5.10, where the design states the modulus",
     FG_AT_U(fg_beam, follows.compliance_mm_per_n, follows.u_compliance_mm_per_n),
     .decimals = 4,
     .uses = OWN | EDGES,
     .nominal = compliance_of},
    {.name = "sagitta_mm",
     .unit = "mm",
     .symbol = "sag",
     .words = "sagitta once bent",
     FG_AT_U(fg_beam, follows.sagitta_mm, follows.u_sagitta_mm),
     .decimals = 4,
     .uses = OWN,
     .nominal = sagitta_of},
    {.name = "sagitta_error_pct",
     .unit = "%",
     .symbol = "e_sag",
     .words = "sagitta against the design's",
     FG_AT_U(fg_beam, follows.sagitta_error_pct, follows.u_sagitta_error_pct),
     .decimals = 3,
     .uses = PAGE | TERMINAL | LOT | OWN,
     .rank = 6},
    {.name = "clearance_change_mm",
     .unit = "mm",
     .symbol = "ΔC",
     .words = "change of the clearance by the sagitta",
     FG_AT_U(fg_beam, follows.clearance_change_mm, follows.u_clearance_change_mm),
     .decimals = 5,
     .uses = PAGE | LOT | OWN,
     .rank = 7},
    {.name = "clearance_change_pct",
     .unit = "%",
     .symbol = "ΔC/C_D",
     .words = "the same, of the design's clearance",
     FG_AT_U(fg_beam, follows.clearance_change_pct, follows.u_clearance_change_pct),
     .decimals = 3,
     .uses = OWN},
    {.name = "taper_um_per_mm",
     .unit = "µm/mm",
     .symbol = "taper",
     .words = "widening towards the root",
     FG_AT_U(fg_beam, taper_um_per_mm, u_taper_um_per_mm),
     .decimals = 2,
     .uses = PAGE | OWN,
     .rank = 8},
    {.name = "bow_um",
     .unit = "µm",
     .symbol = "bow",
     .words = "its middle beside the chord of its ends",
     FG_AT_U(fg_beam, bow_um, u_bow_um),
     .decimals = 1,
     .uses = PAGE | OWN,
     .rank = 9},
    {.name = "direction_deg",
     .unit = "°",
     .symbol = "direction",
     .words = "direction from root to tip in the scan",
     FG_AT(fg_beam, direction_deg),
     .decimals = 2,
     .uses = FG_QUANTITY_IS_CAUSE},
    {.name = "rms_um",
     .unit = "µm",
     .symbol = "rms",
     .words = "residual of the long edges",
     FG_AT(fg_beam, rms_um),
     .decimals = 2,
     .uses = PAGE | TERMINAL | OWN,
     .rank = 10},
    {.name = "points",
     .unit = "",
     .symbol = "n",
     .words = "points in the fits of the long edges",
     .kind = FG_QUANTITY_COUNT,
     FG_AT(fg_beam, points)},
};

const fg_quantity_rows fg_quantities_of_beam = FG_QUANTITY_ROWS(rows);

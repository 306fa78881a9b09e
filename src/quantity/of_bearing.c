/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities of a bearing with foils of a lot. */
#include <stddef.h>

#include "foilgauge/bearing.h"
#include "quantity/rows.h"

enum { PAGE = FG_QUANTITY_ON_PAGE };

/* Clearance with foils as designed: the same everywhere. */
static double clearance_of(const fg_design *design, const fg_nominal *nominal) {
  (void)design;
  return nominal->clearance_mm;
}

static double zero_clearance(const fg_design *design, const fg_nominal *nominal) {
  (void)design;
  (void)nominal;
  return 0;
}

static const fg_quantity rows[] = {
    {.name = "count",
     .unit = "",
     .symbol = "n",
     .words = "bumps whose clearance is known",
     .kind = FG_QUANTITY_COUNT,
     FG_AT(fg_bearing_clearance, count)},
    {.name = "mean_mm",
     .tolerance = "clearance_mean_mm",
     .unit = "mm",
     .symbol = "mean",
     .words = "mean clearance",
     FG_AT_U(fg_bearing_clearance, mean_mm, u_mean_mm),
     .decimals = 4,
     .uses = PAGE | FG_QUANTITY_BETWEEN_EDGES,
     .characteristic = "Length",
     .nominal = clearance_of},
    {.name = "min_mm",
     .tolerance = "clearance_min_mm",
     .unit = "mm",
     .symbol = "least",
     .words = "least clearance",
     FG_AT_U(fg_bearing_clearance, min_mm, u_min_mm),
     .decimals = 4,
     .uses = PAGE | FG_QUANTITY_BETWEEN_EDGES,
     .characteristic = "Length",
     .nominal = clearance_of},
    {.name = "min_at_deg",
     .unit = "°",
     .symbol = "at",
     .words = "where the clearance is least",
     FG_AT(fg_bearing_clearance, min_at_deg),
     .decimals = 1},
    {.name = "max_mm",
     .tolerance = "clearance_max_mm",
     .unit = "mm",
     .symbol = "most",
     .words = "largest clearance",
     FG_AT_U(fg_bearing_clearance, max_mm, u_max_mm),
     .decimals = 4,
     .uses = PAGE | FG_QUANTITY_BETWEEN_EDGES,
     .characteristic = "Length",
     .nominal = clearance_of},
    {.name = "circularity_mm",
     .tolerance = "circularity_mm",
     .unit = "mm",
     .symbol = "circularity",
     .words = "peak to valley about the circle through the crowns",
     FG_AT_U(fg_bearing_clearance, circularity_mm, u_circularity_mm),
     .decimals = 4,
     .uses = PAGE,
     .characteristic = "Length",
     .nominal = zero_clearance},
    {.name = "offset_mm",
     .unit = "mm",
     .symbol = "offset",
     .words = "centre of that circle seen from the bearing's",
     .kind = FG_QUANTITY_PAIR,
     FG_AT(fg_bearing_clearance, offset_mm),
     .decimals = 4},
    {.name = "centred_min_mm",
     .tolerance = "clearance_centred_min_mm",
     .unit = "mm",
     .symbol = "least, rotor centred",
     .words = "least clearance of a rotor where it is largest",
     FG_AT_U(fg_bearing_clearance, centred_min_mm, u_centred_min_mm),
     .decimals = 4,
     .uses = PAGE | FG_QUANTITY_BETWEEN_EDGES,
     .characteristic = "Length",
     .nominal = clearance_of},
    {.name = "centred_at_mm",
     .unit = "mm",
     .symbol = "rotor at",
     .words = "where that rotor's axis lies",
     .kind = FG_QUANTITY_PAIR,
     FG_AT(fg_bearing_clearance, centred_at_mm),
     .decimals = 4},
};

const fg_quantity_rows fg_quantities_of_bearing = FG_QUANTITY_ROWS(rows);

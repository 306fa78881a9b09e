/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Springback against the die that a foil was pressed in, beside that against the design. */
#ifndef FG_LOT_STATISTICS_DIES_H
#define FG_LOT_STATISTICS_DIES_H

#include "lot/statistics/analysis.h"

/* Reference of a bump: the radius of its die at its number, or the die's mean where no trace shows
 * that bump. NULL `die`: the foil's cell names none. */
typedef struct fg_lot_to_die {
  const fg_lot_die *die;
  bool by_mean;
  double radius_mm, u_radius_mm; /* of the die */
  double error_pct, u_error_pct; /* 100 (R - R_die) / R_die */
} fg_lot_to_die;

fg_lot_to_die fg_lot_bump_to_die(const fg_lot *lot, const fg_lot_foil *foil, const fg_bump *bump);

void fg_lot_put_dies(FILE *out, const fg_lot_analysis *analysis);

#endif

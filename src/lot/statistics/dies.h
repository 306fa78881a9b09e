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

/* Sums over the bumps of a die's foils. */
typedef struct fg_lot_die_sum {
  const fg_lot_die *die;
  size_t foils, bumps, by_mean;
  double die_error_pct, u_die_error_pct; /* mean of the references relative to the design */
  double design_mean_pct, design_sd_pct; /* errors of the bumps against the design */
  double die_mean_pct, die_sd_pct;       /* errors of the bumps against the die */
  double explained_pct;                  /* share of design_mean that the die explains */
} fg_lot_die_sum;

typedef struct fg_lot_dies {
  fg_lot_die_sum sum[FG_LOT_DIES_MAX];
  size_t count;
  size_t bumps;
  /* Over all bumps with a die: sd of the errors against design and die, and the percentage of the
   * variance that the dies explain. NaN with fewer than two bumps. */
  double design_sd_pct, die_sd_pct, explained_variance_pct;
  /* With two dies: the difference of their foils (second minus first), of the dies, and its share.
   * NaN otherwise. */
  double foils_differ_pct, dies_differ_pct, explained_difference_pct;
} fg_lot_dies;

/* Sets count 0 when the recipe names no die, or no foil has one. */
void fg_lot_analyse_dies(const fg_lot_analysis *analysis, fg_lot_dies *dies);

void fg_lot_put_dies(FILE *out, const fg_lot_analysis *analysis);

#endif

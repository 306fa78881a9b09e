/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Level of each foil of a lot in one quantity. The foil is the unit that was made; its bumps are
 * repeats within it.
 *
 * y = level of the foil + effect of the place + rest, by least squares. A bump that is missing does
 * not shift its foil's level by the place's effect; where no bump is missing the level is the mean.
 */
#ifndef FG_LOT_STATISTICS_FOIL_LEVELS_H
#define FG_LOT_STATISTICS_FOIL_LEVELS_H

#include "lot/statistics/analysis.h"

typedef struct fg_foil_level {
  size_t group; /* index of the group's word */
  size_t owner; /* foil of the lot that the scans belong to */
  size_t values;
  double level;
  double within_sd; /* sd of the values about level and places; NaN: fewer than two */
} fg_foil_level;

typedef struct fg_foil_levels {
  fg_foil_level *foil; /* owned */
  size_t count;
} fg_foil_levels;

/* Makes the levels; `group` and `owner` are by foil of the analysis. Scans of one foil in one group
 * are one foil. A foil without values, or whose group is FG_NO_COLUMN, is left out. Free with
 * fg_foil_levels_free. */
fg_status fg_foil_levels_make(fg_context *ctx, const fg_lot_analysis *analysis,
                              const fg_lot_quantity *quantity, const size_t *group,
                              const size_t *owner, fg_foil_levels *levels);
void fg_foil_levels_free(fg_foil_levels *levels);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What goes to quality systems: lengths and angles, one characteristic per quantity and part, and
 * of the bearings that the manifest names. */
#ifndef FG_REPORT_LOT_CHARACTERISTICS_H
#define FG_REPORT_LOT_CHARACTERISTICS_H

#include "lot/statistics/analysis.h"

typedef struct fg_characteristic {
  const fg_quantity *row;
  fg_quantity_owner owner;
  const fg_tolerance *tolerance; /* NULL: none */
  int number;                    /* of the part; 0: the whole foil or bearing */
  double nominal;                /* of the design */
} fg_characteristic;

/* Those of foils and bumps, then those of bearings. The caller frees *list with free(). */
fg_status fg_characteristics_list(fg_context *ctx, const fg_lot_analysis *analysis,
                                  fg_characteristic **list, size_t *count);

/* What is measured as a whole: one foil, or one bearing and the foils in it. */
typedef struct fg_measured_part {
  const fg_lot_foil *foil;       /* NULL: a bearing */
  const fg_lot_bearing *bearing; /* that it is, or that the foil is in; NULL: in none */
  size_t pad;                    /* of the foil in it, from 0 */
} fg_measured_part;

/* Bearings that the manifest names with their foils in order of the pads, then foils in none.
 * Bearings that are assumed are none: nobody has built them. The caller frees *parts. */
fg_status fg_measured_parts_list(fg_context *ctx, const fg_lot_analysis *analysis,
                                 fg_measured_part **parts, size_t *count);

/* The part's value and its uncertainty; NaN where it has none. */
double fg_characteristic_value(const fg_characteristic *characteristic,
                               const fg_measured_part *part, double *u);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Characteristics for quality systems: lengths and angles, one for each quantity and part, and
 * those of the bearings that the manifest names. */
#ifndef FG_REPORT_LOT_CHARACTERISTICS_H
#define FG_REPORT_LOT_CHARACTERISTICS_H

#include "lot/statistics/analysis.h"

typedef struct fg_characteristic {
  const fg_quantity *row;
  fg_quantity_owner owner;
  const fg_tolerance *tolerance; /* NULL: none */
  int number;                    /* number of the part; 0: the whole foil or bearing */
  double nominal;                /* nominal value of the design */
} fg_characteristic;

/* Lists the characteristics of foils and bumps, then those of bearings. The caller frees *list with
 * free(). */
fg_status fg_characteristics_list(fg_context *ctx, const fg_lot_analysis *analysis,
                                  fg_characteristic **list, size_t *count);

/* Part for quality systems: a foil, or a bearing with its foils. */
typedef struct fg_measured_part {
  const fg_lot_foil *foil;       /* NULL: a bearing */
  const fg_lot_bearing *bearing; /* the bearing itself, or that of the foil; NULL: none */
  size_t pad;                    /* index of the foil's pad, from 0 */
} fg_measured_part;

/* Lists the bearings that the manifest names with their foils in order of the pads, then the other
 * foils. Assumed bearings are left out: nobody has built them. The caller frees *parts. */
fg_status fg_measured_parts_list(fg_context *ctx, const fg_lot_analysis *analysis,
                                 fg_measured_part **parts, size_t *count);

/* Returns the part's value and its uncertainty; NaN where it has none. */
double fg_characteristic_value(const fg_characteristic *characteristic,
                               const fg_measured_part *part, double *u);

#endif

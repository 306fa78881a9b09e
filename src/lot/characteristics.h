/* What goes to quality systems: lengths and angles, one characteristic per quantity and part. */
#ifndef FG_LOT_CHARACTERISTICS_H
#define FG_LOT_CHARACTERISTICS_H

#include "lot/analysis.h"

typedef struct fg_characteristic {
  const fg_lot_quantity *quantity;
  int number;       /* of the part; 0: the whole foil */
  double nominal;   /* of the design */
  const char *kind; /* QIF's name */
} fg_characteristic;

/* The caller frees *list with free(). */
fg_status fg_characteristics_list(fg_context *ctx, const fg_lot_analysis *analysis,
                                  fg_characteristic **list, size_t *count);

/* The foil's value and its uncertainty; NaN where it has none. */
double fg_characteristic_value(const fg_characteristic *characteristic, const fg_foil *foil,
                               double *u);

#endif

/* What the files of a lot's page share. */
#ifndef FG_LOT_PAGE_PARTS_H
#define FG_LOT_PAGE_PARTS_H

#include <math.h>
#include <stdio.h>

#include "lot/analysis.h"

/* A dash where it is not known. */
static inline void put_number(FILE *out, double value, int digits) {
  if (isfinite(value))
    fprintf(out, "%s%.*g", value < 0 ? "−" : "", digits, fabs(value));
  else
    fputs("–", out);
}

/* What the strips measure, and what the design says where that is another thickness. */
void fg_lot_put_thickness(FILE *out, const fg_lot_analysis *analysis);

/* The section on the stiffness of the bumps. */
void fg_lot_put_stiffness(FILE *out, const fg_lot_analysis *analysis);

#endif

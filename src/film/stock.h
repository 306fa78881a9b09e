/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foils of a lot, that bearings are drawn from. */
#ifndef FG_FILM_STOCK_H
#define FG_FILM_STOCK_H

#include "film/bearing.h"

/* Clearances and stiffness of the foils at the places of a pad, foil after foil. */
typedef struct fg_film_stock {
  size_t foils, places;
  double *clearance_mm, *stiffness; /* of a bump, over the design's */
  size_t left_out;                  /* foils that cannot be built in */
} fg_film_stock;

/* Reads bumps.csv and foils.csv of the lot's folder: every foil that passes or is not judged, with
 * a clearance at all its places (fitted into the sleeve), no crushed bump, and of a part that is
 * scanned again its first scan. FG_ERR_DATA for fewer foils than pads. */
fg_status fg_film_stock_read(fg_context *ctx, fg_film_report *report, fg_film_stock *stock);
void fg_film_stock_free(fg_film_stock *stock);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The film of bearings drawn from a lot's foils, for the lot's report. */
#ifndef FG_FILM_LOT_FILM_H
#define FG_FILM_LOT_FILM_H

#include "lot/statistics/analysis.h"

/* Finds analysis->film, where the recipe asks; a bearing without a film is no failure, but said in
 * `film_why`. */
fg_status fg_lot_film_find(fg_context *ctx, fg_lot_analysis *analysis);
void fg_lot_film_free(fg_lot_analysis *analysis);

#endif

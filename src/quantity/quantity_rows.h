/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What reports, lots, tables and models ask of the rows of quantities. */
#ifndef FG_QUANTITY_QUANTITY_ROWS_H
#define FG_QUANTITY_QUANTITY_ROWS_H

#include <stdbool.h>

#include "foilgauge/quantity.h"

/* Rows of one use at most: what a caller must have room for. */
enum { FG_QUANTITY_SHOWN_MAX = 16 };

/* Numbers that one row may stand for: a pair and its uncertainties. */
enum { FG_QUANTITY_NUMBERS_MAX = 4 };

bool fg_quantity_has_u(const fg_quantity *quantity);

/* The rows of one use that parts of a form have, as people read them: by rank, those without one
 * behind. Their number. */
size_t fg_quantity_shown(fg_quantity_owner owner, fg_quantity_use use, fg_foil_kind kind,
                         const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX]);

/* Values of a row: two of a pair, else one. */
size_t fg_quantity_values(const fg_quantity *quantity);

/* Every number of a row: the values, then their uncertainties where it has any. How many there
 * are. */
size_t fg_quantity_width(const fg_quantity *quantity);
size_t fg_quantity_numbers(const fg_quantity *quantity, const void *object,
                           double numbers[FG_QUANTITY_NUMBERS_MAX]);
/* Puts them back; a count that is no whole number becomes 0. */
void fg_quantity_restore(const fg_quantity *quantity, void *object,
                         const double numbers[FG_QUANTITY_NUMBERS_MAX]);

/* The name of the k-th of them in a table: "radius_mm", "u_radius_mm"; of a pair "centre_x_mm": the
 * unit stays last. */
void fg_quantity_column(const fg_quantity *quantity, size_t k, char *text, size_t size);

/* The values that can be judged, for a message: "radius_mm, ..."; appended. Counts too. */
void fg_quantity_list(fg_quantity_owner owner, fg_foil_kind kind, bool counts, char *text,
                      size_t size);

/* What widens an object: how far each value that has an uncertainty would lie elsewhere, one after
 * the other, two of a pair. How many they are. */
size_t fg_quantity_moves(fg_quantity_owner owner);

/* The farther, in size, of what `farthest` holds and of `other` minus `object`. */
void fg_quantity_take_moves(fg_quantity_owner owner, const void *object, const void *other,
                            double *farthest);

/* Adds `share` of every move to its uncertainty, in squares, and to the covariances. */
void fg_quantity_widen(fg_quantity_owner owner, void *object, const double *moves, double share);

/* Adds what a calibration leaves in doubt, in squares, source by source. */
void fg_quantity_widen_calibrated(fg_quantity_owner owner, void *object,
                                  const fg_calibrated *calibrated);

/* Takes it out again: u_ of the statistics alone; pairs keep theirs, and so do
 * covariances. */
void fg_quantity_narrow_calibrated(fg_quantity_owner owner, void *object,
                                   const fg_calibrated *calibrated);

/* Where the moves of an object hold a row that has u_. */
size_t fg_quantity_move_of(fg_quantity_owner owner, const fg_quantity *quantity);

/* What of a row's u_ the calibration is; of a pair of its first. NaN where the row has none. */
double fg_quantity_calibration(fg_quantity_owner owner, const fg_quantity *quantity,
                               const fg_calibrated *calibrated);

/* Whether a table's column of that name is a result of a measurement, not a cause of it: the value
 * or the uncertainty of a row of a foil, a bump or a disc, also as "bump_radius_mm",
 * "overall_radius_mm", "overall.radius_mm" or, of the overall circle, without the circle's name. */
bool fg_quantity_is_result(const char *column);

#endif

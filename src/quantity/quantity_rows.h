/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queries of the rows of quantities for reports, lots, tables and models. */
#ifndef FG_QUANTITY_QUANTITY_ROWS_H
#define FG_QUANTITY_QUANTITY_ROWS_H

#include <stdbool.h>

#include "foilgauge/quantity.h"

/* Max number of rows of one use. */
enum { FG_QUANTITY_SHOWN_MAX = 16 };

/* Max number of numbers of one row: a pair and its uncertainties. */
enum { FG_QUANTITY_NUMBERS_MAX = 4 };

bool fg_quantity_has_u(const fg_quantity *quantity);

/* Lists the rows of one use that parts of a kind have, in the order for people: by rank, then those
 * without one. Returns their number. */
size_t fg_quantity_shown(fg_quantity_owner owner, fg_quantity_use use, fg_foil_kind kind,
                         const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX]);

/* Number of values of a row: two of a pair, else one. */
size_t fg_quantity_values(const fg_quantity *quantity);

/* Lists every number of a row: the values, then their uncertainties where it has any. Returns their
 * number. */
size_t fg_quantity_width(const fg_quantity *quantity);
size_t fg_quantity_numbers(const fg_quantity *quantity, const void *object,
                           double numbers[FG_QUANTITY_NUMBERS_MAX]);
/* Writes the numbers back; a count that is no whole number becomes 0. */
void fg_quantity_restore(const fg_quantity *quantity, void *object,
                         const double numbers[FG_QUANTITY_NUMBERS_MAX]);

/* Writes the name of number `k` in a table: "radius_mm", "u_radius_mm"; of a pair "centre_x_mm":
 * the unit stays last. */
void fg_quantity_column(const fg_quantity *quantity, size_t k, char *text, size_t size);

/* Appends the names of values that can have a tolerance, for a message: "radius_mm, ..."; `counts`:
 * with counts. */
void fg_quantity_list(fg_quantity_owner owner, fg_foil_kind kind, bool counts, char *text,
                      size_t size);

/* Number of moves of an object: one per value with an uncertainty, two per pair. A move is the
 * value's shift under another explanation. */
size_t fg_quantity_moves(fg_quantity_owner owner);

/* Sets each of `farthest` to the larger, in size, of itself and `other` minus `object`. */
void fg_quantity_keep_farthest(fg_quantity_owner owner, const void *object, const void *other,
                               double *farthest);

/* Adds `share` of every move to its uncertainty, in squares, and to the covariances. */
void fg_quantity_widen(fg_quantity_owner owner, void *object, const double *moves, double share);

/* Adds a calibration's uncertainty, in squares, source by source. */
void fg_quantity_widen_calibrated(fg_quantity_owner owner, void *object,
                                  const fg_calibrated *calibrated);

/* Subtracts it again: u_ of the statistics alone; pairs keep theirs, and so do covariances. */
void fg_quantity_narrow_calibrated(fg_quantity_owner owner, void *object,
                                   const fg_calibrated *calibrated);

/* Index of the move of a row that has u_. */
size_t fg_quantity_move_of(fg_quantity_owner owner, const fg_quantity *quantity);

/* Returns the calibration's part of a row's u_; of a pair that of its first. NaN where the row has
 * none. */
double fg_quantity_calibration(fg_quantity_owner owner, const fg_quantity *quantity,
                               const fg_calibrated *calibrated);

/* Returns true when a table's column of that name is a result of a measurement, not a cause of it:
 * the value or the uncertainty of a row of a foil, a bump or a disc, also as "bump_radius_mm",
 * "overall_radius_mm", "overall.radius_mm" or, of the overall circle, without the circle's name. */
bool fg_quantity_is_result(const char *column);

#endif

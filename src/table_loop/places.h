/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places of a column, for cycles over it. */
#ifndef FG_TABLE_LOOP_PLACES_H
#define FG_TABLE_LOOP_PLACES_H

#include "table_loop/parts.h"

/* Finds the spacing of a coordinate's places from its sorted values. */
void fg_loop_places_measure(const double *sorted, size_t rows, fg_loop_coordinate *at);
/* Returns true where a base period is known: of an angle, or declared. */
bool fg_loop_places_have_base(const fg_loop_table_spec *spec, const fg_loop_coordinate *at);

/* Sets the base periods that are known: a turn of every angle, and those that were declared. */
fg_status fg_loop_places_find_bases(fg_context *ctx, const fg_loop_table_state *build);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bases of the effects of tables: accepted coordinates, columns, start values of shapes. */
#ifndef FG_EFFECT_BASES_H
#define FG_EFFECT_BASES_H

#include "foilgauge/loop.h"

/* A period of two places has no sine: the rounding that remains of it is no column. */
#define FG_BASIS_ROUNDING 1e-9

/* Returns true for a number, not a word, with more than one value. */
bool fg_basis_is_number(const fg_loop_coordinate *at);
/* Returns true for an order in time or place, along which neighbours are related. */
bool fg_basis_is_sequence(const fg_loop_coordinate *at);
/* Returns the candidate's coordinate, the first of a pair. */
const fg_loop_coordinate *fg_basis_first(const fg_loop_problem *problem,
                                         const fg_loop_candidate *candidate);

/* Returns the number of levels of words, or of different values of numbers. */
size_t fg_basis_level_count(const fg_loop_coordinate *at);
/* Writes an indicator of every level but the first: levels - 1 columns. */
void fg_basis_level_columns(const fg_loop_problem *problem, const fg_loop_coordinate *at,
                            double *columns);

/* Of a column, in column_bases.c. */
fg_loop_accepts fg_basis_accepts_linear, fg_basis_accepts_quadratic, fg_basis_accepts_interaction,
    fg_basis_accepts_factor, fg_basis_accepts_threshold, fg_basis_accepts_sensitivity;
fg_loop_columns fg_basis_interaction_columns, fg_basis_factor_columns;
fg_loop_basis fg_basis_linear, fg_basis_quadratic, fg_basis_interaction, fg_basis_factor,
    fg_basis_threshold, fg_basis_sensitivity;
fg_loop_starts fg_basis_threshold_starts;

/* Over an order, in order_bases.c. */
fg_loop_accepts fg_basis_accepts_drift, fg_basis_accepts_transient, fg_basis_accepts_lip;
fg_loop_basis fg_basis_decay;
fg_loop_starts fg_basis_transient_starts, fg_basis_lip_starts;

/* Of cycles, in cycle_bases.c: of any period, and of the orders of a known base. */
fg_loop_accepts fg_basis_accepts_periodic, fg_basis_accepts_orders;
fg_loop_columns fg_basis_periodic_columns;
fg_loop_basis fg_basis_periodic;
fg_loop_starts fg_basis_periodic_starts, fg_basis_order_starts;
/* Fills the sine and the cosine of a period over a coordinate, from its lowest place on: 2 × rows.
 */
void fg_basis_wave(size_t rows, const fg_loop_coordinate *at, double period, double *columns);

/* Of a reversal, in cycle_bases.c. */
fg_loop_accepts fg_basis_accepts_hysteresis;
fg_loop_basis fg_basis_hysteresis;

/* Of a heat treatment: physical laws of temperature and time, in heat_bases.c. */
fg_loop_accepts fg_basis_accepts_temperature, fg_basis_accepts_duration, fg_basis_accepts_both;
fg_loop_basis fg_basis_arrhenius, fg_basis_larson_miller, fg_basis_log_time, fg_basis_jmak;
fg_loop_starts fg_basis_arrhenius_starts, fg_basis_jmak_starts;

#endif

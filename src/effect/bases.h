/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The forms that effects of tables take: which coordinates they accept, their columns, start values
 * of what is not linear in them. */
#ifndef FG_EFFECT_BASES_H
#define FG_EFFECT_BASES_H

#include "foilgauge/loop.h"

/* A number, not a word, that is not the same in every row. */
bool fg_basis_is_number(const fg_loop_coordinate *at);
/* An order in time or place, where neighbours belong together. */
bool fg_basis_is_sequence(const fg_loop_coordinate *at);
/* The candidate's coordinate, of a pair the first. */
const fg_loop_coordinate *fg_basis_first(const fg_loop_problem *problem,
                                         const fg_loop_candidate *candidate);

/* Words have levels; numbers as many as they have values. */
size_t fg_basis_level_count(const fg_loop_coordinate *at);
/* An indicator of every level but the first: levels - 1 columns. */
void fg_basis_level_columns(const fg_loop_problem *problem, const fg_loop_coordinate *at,
                            double *columns);

/* Of a column. column_forms.c */
fg_loop_accepts fg_basis_accepts_linear, fg_basis_accepts_quadratic, fg_basis_accepts_interaction,
    fg_basis_accepts_factor, fg_basis_accepts_threshold, fg_basis_accepts_sensitivity;
fg_loop_columns fg_basis_interaction_columns, fg_basis_factor_columns;
fg_loop_basis fg_basis_linear, fg_basis_quadratic, fg_basis_interaction, fg_basis_factor,
    fg_basis_threshold, fg_basis_sensitivity;
fg_loop_starts fg_basis_threshold_starts;

/* Over an order. order_forms.c */
fg_loop_accepts fg_basis_accepts_drift, fg_basis_accepts_transient, fg_basis_accepts_lip,
    fg_basis_accepts_periodic;
fg_loop_basis fg_basis_decay, fg_basis_periodic;
fg_loop_starts fg_basis_transient_starts, fg_basis_lip_starts, fg_basis_periodic_starts;

/* Of a heat treatment: physical forms of temperature and time. heat_forms.c */
fg_loop_accepts fg_basis_accepts_temperature, fg_basis_accepts_duration, fg_basis_accepts_both;
fg_loop_basis fg_basis_arrhenius, fg_basis_larson_miller, fg_basis_log_time, fg_basis_jmak;
fg_loop_starts fg_basis_arrhenius_starts, fg_basis_jmak_starts;

#endif

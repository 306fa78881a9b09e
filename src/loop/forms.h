/* The forms that effects of tables take: which coordinates they accept, their columns, start values
 * of what is not linear in them. */
#ifndef FG_LOOP_FORMS_H
#define FG_LOOP_FORMS_H

#include "foilgauge/loop.h"

/* A number, not a word, that is not the same in every row. */
bool fg_engine_is_number(const fg_loop_coordinate *at);
/* An order in time or place, where neighbours belong together. */
bool fg_engine_is_sequence(const fg_loop_coordinate *at);
/* The candidate's coordinate, of a pair the first. */
const fg_loop_coordinate *fg_engine_first(const fg_loop_problem *problem,
                                          const fg_loop_candidate *candidate);

/* Of a column. column_forms.c */
fg_loop_accepts fg_engine_accepts_linear, fg_engine_accepts_quadratic,
    fg_engine_accepts_interaction, fg_engine_accepts_factor, fg_engine_accepts_threshold,
    fg_engine_accepts_sensitivity;
fg_loop_columns fg_engine_interaction_columns, fg_engine_factor_columns;
fg_loop_basis fg_engine_linear_basis, fg_engine_quadratic_basis, fg_engine_interaction_basis,
    fg_engine_factor_basis, fg_engine_threshold_basis, fg_engine_sensitivity_basis;
fg_loop_starts fg_engine_threshold_starts;

/* Over an order. order_forms.c */
fg_loop_accepts fg_engine_accepts_drift, fg_engine_accepts_transient, fg_engine_accepts_lip,
    fg_engine_accepts_periodic;
fg_loop_basis fg_engine_decay_basis, fg_engine_periodic_basis;
fg_loop_starts fg_engine_transient_starts, fg_engine_lip_starts, fg_engine_periodic_starts;

/* Of a heat treatment: physical forms of temperature and time. heat_forms.c */
fg_loop_accepts fg_engine_accepts_temperature, fg_engine_accepts_duration, fg_engine_accepts_both;
fg_loop_basis fg_engine_arrhenius_basis, fg_engine_larson_miller_basis, fg_engine_log_time_basis,
    fg_engine_jmak_basis;
fg_loop_starts fg_engine_arrhenius_starts, fg_engine_jmak_starts;

#endif

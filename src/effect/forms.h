/* The forms that effects of tables take: which coordinates they accept, their columns, start values
 * of what is not linear in them. */
#ifndef FG_EFFECT_FORMS_H
#define FG_EFFECT_FORMS_H

#include "foilgauge/loop.h"

/* A number, not a word, that is not the same in every row. */
bool fg_loop_form_is_number(const fg_loop_coordinate *at);
/* An order in time or place, where neighbours belong together. */
bool fg_loop_form_is_sequence(const fg_loop_coordinate *at);
/* The candidate's coordinate, of a pair the first. */
const fg_loop_coordinate *fg_loop_form_first(const fg_loop_problem *problem,
                                             const fg_loop_candidate *candidate);

/* Words have levels; numbers as many as they have values. */
size_t fg_loop_form_level_count(const fg_loop_coordinate *at);
/* An indicator of every level but the first: levels - 1 columns. */
void fg_loop_form_level_columns(const fg_loop_problem *problem, const fg_loop_coordinate *at,
                                double *columns);

/* Of a column. column_forms.c */
fg_loop_accepts fg_loop_form_accepts_linear, fg_loop_form_accepts_quadratic,
    fg_loop_form_accepts_interaction, fg_loop_form_accepts_factor, fg_loop_form_accepts_threshold,
    fg_loop_form_accepts_sensitivity;
fg_loop_columns fg_loop_form_interaction_columns, fg_loop_form_factor_columns;
fg_loop_basis fg_loop_form_linear_basis, fg_loop_form_quadratic_basis,
    fg_loop_form_interaction_basis, fg_loop_form_factor_basis, fg_loop_form_threshold_basis,
    fg_loop_form_sensitivity_basis;
fg_loop_starts fg_loop_form_threshold_starts;

/* Over an order. order_forms.c */
fg_loop_accepts fg_loop_form_accepts_drift, fg_loop_form_accepts_transient,
    fg_loop_form_accepts_lip, fg_loop_form_accepts_periodic;
fg_loop_basis fg_loop_form_decay_basis, fg_loop_form_periodic_basis;
fg_loop_starts fg_loop_form_transient_starts, fg_loop_form_lip_starts, fg_loop_form_periodic_starts;

/* Of a heat treatment: physical forms of temperature and time. heat_forms.c */
fg_loop_accepts fg_loop_form_accepts_temperature, fg_loop_form_accepts_duration,
    fg_loop_form_accepts_both;
fg_loop_basis fg_loop_form_arrhenius_basis, fg_loop_form_larson_miller_basis,
    fg_loop_form_log_time_basis, fg_loop_form_jmak_basis;
fg_loop_starts fg_loop_form_arrhenius_starts, fg_loop_form_jmak_starts;

#endif

/* Bases of the heat treatment: physical forms of temperature and time. */
#ifndef FG_LOOP_HEAT_FORMS_H
#define FG_LOOP_HEAT_FORMS_H

#include "foilgauge/loop.h"

typedef const fg_loop_problem problem_t;
typedef const fg_loop_candidate candidate_t;

/* A number, not a word, that is not the same in every row. */
bool fg_engine_is_number(const fg_loop_coordinate *at);

bool fg_engine_accepts_temperature(problem_t *problem, size_t a, size_t b);
bool fg_engine_accepts_duration(problem_t *problem, size_t a, size_t b);
bool fg_engine_accepts_both(problem_t *problem, size_t a, size_t b);
void fg_engine_arrhenius_basis(problem_t *problem, candidate_t *candidate, const double *shape,
                               double *columns);
size_t fg_engine_arrhenius_starts(problem_t *problem, candidate_t *candidate,
                                  double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]);
void fg_engine_larson_miller_basis(problem_t *problem, candidate_t *candidate, const double *shape,
                                   double *columns);
void fg_engine_log_time_basis(problem_t *problem, candidate_t *candidate, const double *shape,
                              double *columns);
void fg_engine_jmak_basis(problem_t *problem, candidate_t *candidate, const double *shape,
                          double *columns);
size_t fg_engine_jmak_starts(problem_t *problem, candidate_t *candidate,
                             double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]);

#endif

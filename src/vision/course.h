/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How one value of the edges' shape runs along a strip or around a turn: what edges_smooth.c and
 * disc_shape.c do alike. */
#ifndef FG_VISION_COURSE_H
#define FG_VISION_COURSE_H

#include <stdbool.h>

#include "core/small_solve.h"

typedef struct fg_course_sums {
  double squares, expected, count; /* of deviations, and of the fits' own variances */
} fg_course_sums;

/* Solves for the course; false where it cannot be. `judged`: the sums are about a course already,
 * and *real becomes the share of the scatter that the fits' own variances do not explain. */
bool fg_course_solve(fg_normal_equations *system, const fg_course_sums *sums, bool judged,
                     double *coefficients, double *real);

/* What lies further from the course is left out of it; reorders the sizes. INFINITY without any. */
double fg_course_limit(double *sizes, size_t count);

#endif

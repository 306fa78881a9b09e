/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The course along y of what one channel shows against another. */
#ifndef FG_MEASURE_COLOUR_COURSE_H
#define FG_MEASURE_COLOUR_COURSE_H

#include "measure/colour_fit.h"

/* dy over windows along y beside the other unknowns of `rows`, the smooth curve through them, and
 * the test for a constant one: into what `shift` has of the course. `rows` must be fitted with a
 * constant dy; where that does not hold they get what was found beside the course. *told false: the
 * rows do not tell. */
fg_status fg_colour_course_find(fg_context *ctx, fg_colour_rows *rows, fg_colour_shift *shift,
                                bool *told);

/* The smooth course at a place, um, between the windows' middles; beyond them it stays. */
double fg_colour_course_at(const fg_colour_shift *shift, double y_mm);

#endif

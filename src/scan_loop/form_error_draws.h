/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Peak-to-valley deviations of a part under one model: draws from the amplitudes of its columns. */
#ifndef FG_SCAN_LOOP_FORM_ERROR_DRAWS_H
#define FG_SCAN_LOOP_FORM_ERROR_DRAWS_H

#include "scan_loop/circles.h"

/* Deviations of the part under one model: columns at the rows of the circles. */
typedef struct fg_form_error_deviations {
  size_t count;
  double *columns;      /* owned; count × rows, beside the circles */
  double *mean, *lower; /* owned; of the amplitudes, um: lower factor of their covariance */
} fg_form_error_deviations;

/* Of one model on every circle. */
typedef struct fg_form_error_moments {
  double weight, *mean, *square;
  double *ends; /* growth over what the circles may be longer: as over as much at their ends */
} fg_form_error_moments;

enum { FG_FORM_ERROR_MOMENTS = 3 };

/* Moments that lie in 3 × circles numbers. */
fg_form_error_moments fg_form_error_moments_in(double *numbers, const fg_circles *circles);

fg_status fg_form_error_deviations_open(fg_context *ctx, const fg_circles *circles, size_t count,
                                        fg_form_error_deviations *deviations);
void fg_form_error_deviations_close(fg_form_error_deviations *deviations);

/* Adds mean and mean square of the peak-to-valley deviation over the draws, which are the same in
 * every call and with any number of threads (see fg_parallel_run). */
fg_status fg_form_error_draw(fg_context *ctx, const fg_circles *circles,
                             const fg_form_error_deviations *deviations,
                             fg_form_error_moments *moments);

#endif

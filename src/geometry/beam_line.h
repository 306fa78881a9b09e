/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The line of one edge of a beam, and the scatter of a beam's edges.
 *
 * A place on a fitted line is a weighted sum of the stations' places across it. Its variance is
 * that sum over the autocovariance of the stations. The two long edges give that function, so that
 * short edges, with too few stations of their own, have the right variance too. Deviations of the
 * long edges over more stations than the function's lags show in means over blocks.
 */
#ifndef FG_GEOMETRY_BEAM_LINE_H
#define FG_GEOMETRY_BEAM_LINE_H

#include "foilgauge/foil.h"

enum { FG_BEAM_LAGS = 80 };

typedef struct fg_beam_line {
  const fg_beam_edge *edge;
  fg_point at, along; /* along in the order of the stations */
  double *across; /* of every station, from the line towards the void, mm; NaN: not used; owned */
  size_t used, usable;
  double rms_mm;
  double spread; /* ratio of its variance to that of the long edges; at least 1 */
} fg_beam_line;

/* Fits the line by total least squares without outliers. FG_ERR_NUMERIC when too few stations are
 * usable; FG_ERR_MEMORY. A round floor has the tangent at its apex, which is farthest against
 * `axis`, the beam's direction towards its tip. */
fg_status fg_beam_line_fit(fg_context *ctx, const fg_beam_edge *edge, fg_point axis,
                           fg_beam_line *line);
void fg_beam_line_free(fg_beam_line *line);

typedef struct fg_beam_noise {
  double covariance[FG_BEAM_LAGS]; /* by the number of stations between two, mm² */
  size_t lags;
  double step_mm;    /* from station to station */
  double long_range; /* factor of the variance over long stretches; at least 1 */
} fg_beam_noise;

/* Finds the noise of both long edges. FG_ERR_MEMORY. */
fg_status fg_beam_noise_find(fg_context *ctx, const fg_beam_line *left, const fg_beam_line *right,
                             fg_beam_noise *noise);

/* Integral length of the correlation, mm. */
double fg_beam_noise_length(const fg_beam_noise *noise);

/* Property of a line, by the place along it from `at`: its place across, its slope, and the
 * parabola over its length (end minus middle). */
typedef enum fg_beam_property { FG_BEAM_PLACE, FG_BEAM_SLOPE, FG_BEAM_PARABOLA } fg_beam_property;

/* Variance of that property, from the stations' scatter alone. FG_ERR_MEMORY. */
fg_status fg_beam_line_variance(fg_context *ctx, const fg_beam_line *line,
                                const fg_beam_noise *noise, fg_beam_property ask, double along_mm,
                                double *variance);

/* Returns the parabola, mm. */
double fg_beam_line_parabola(const fg_beam_line *line);

#endif

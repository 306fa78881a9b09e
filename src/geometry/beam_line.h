/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The line of one edge of a beam, and what the edges of a beam scatter by.
 *
 * A place on a fitted line is a weighted sum of the stations' places across it. Its variance is
 * that sum over the autocovariance of the stations, which the two long edges tell: so short edges,
 * which tell little of their own, have the right one too. What the long edges do over longer
 * stretches than the lags of that function is seen in means over blocks.
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
  double spread; /* by how much more, in variance, it scatters than the long edges; at least 1 */
} fg_beam_line;

/* Total least squares without what lies far off. FG_ERR_NUMERIC when too few stations are usable;
 * FG_ERR_MEMORY. Of a round floor the tangent at its apex, which is farthest against `axis`, the
 * beam's direction towards its tip. */
fg_status fg_beam_line_fit(fg_context *ctx, const fg_beam_edge *edge, fg_point axis,
                           fg_beam_line *line);
void fg_beam_line_free(fg_beam_line *line);

typedef struct fg_beam_noise {
  double covariance[FG_BEAM_LAGS]; /* of stations so many apart, mm² */
  size_t lags;
  double step_mm;    /* from station to station */
  double long_range; /* by what the variance over long stretches is more; at least 1 */
} fg_beam_noise;

/* From both long edges. FG_ERR_MEMORY. */
fg_status fg_beam_noise_find(fg_context *ctx, const fg_beam_line *left, const fg_beam_line *right,
                             fg_beam_noise *noise);

/* Integral length of the correlation, mm. */
double fg_beam_noise_length(const fg_beam_noise *noise);

/* What a line says, by the place along it from `at`: where it is there, its slope, and the
 * parabola over its length (end minus middle). */
typedef enum fg_beam_ask { FG_BEAM_PLACE, FG_BEAM_SLOPE, FG_BEAM_PARABOLA } fg_beam_ask;

/* The variance of it, from the stations' scatter alone. FG_ERR_MEMORY. */
fg_status fg_beam_line_variance(fg_context *ctx, const fg_beam_line *line,
                                const fg_beam_noise *noise, fg_beam_ask ask, double along_mm,
                                double *variance);

/* The parabola itself, mm. */
double fg_beam_line_parabola(const fg_beam_line *line);

#endif

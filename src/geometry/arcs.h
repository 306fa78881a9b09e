/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Arcs of a foil: the stations of one circle, the circle, and its covariance.
 *
 * Works on the datum line (midline, inner or outer edge) of a strip.
 */
#ifndef FG_GEOMETRY_ARCS_H
#define FG_GEOMETRY_ARCS_H

#include <stdbool.h>

#include "foilgauge/foil.h"

enum { FG_NOISE_LAGS = 256 };

/* The line that is fitted: one point per station. */
typedef struct fg_datum_line {
  const fg_strip *strip;
  fg_point *points;   /* datum line; owned */
  double *half_width; /* half the distance of the edges, mm; owned */
  bool is_edge;       /* the datum is one of the edges, not the middle */
  double blur_mm;     /* rms blur of the edges that make the line */
} fg_datum_line;

/* `inner_is_right`: the shaft's side is the right edge. */
fg_status fg_datum_line_build(fg_context *ctx, const fg_strip *strip, fg_datum datum,
                              bool inner_is_right, fg_datum_line *line);
void fg_datum_line_free(fg_datum_line *line);

/* Stations [first, last] that lie on one circle. */
typedef struct fg_range {
  size_t first, last;
} fg_range;

/* A jump of the scan within an arc. */
typedef struct fg_arc_step {
  double chance;      /* of residuals that look as much like a jump by noise; 1: none was sought */
  double jump_mm;     /* signed, along x or y; NaN: none was sought */
  double gain;        /* by how much the jump lowers the sum of squared residuals, mm² */
  double smooth_gain; /* by how much an oval does, with two more parameters, mm² */
  double variance_left;    /* of the residuals from a circle with the jump, mm² */
  double covariance[3][3]; /* mean squares of the change of x, y and R if the scan jumps; mm² */
} fg_arc_step;

/* One or more ranges of one circle (an arc has one, the overall circle has a land each). */
typedef struct fg_arc {
  const fg_range *ranges;
  size_t range_count;
  fg_circle circle;  /* as fitted, corrected for the blur's shift */
  double scatter_mm; /* robust sd of the residuals */
  double rms_mm;     /* of the residuals that were used */
  size_t points, outliers;
  double covariance[3][3];
  fg_arc_step step; /* of a bump */
} fg_arc;

/* Fits the circle to all usable stations of the ranges. Points further than 5 robust sd (and at
 * least 0.3 µm) off are left out; the fit is repeated until they stay the same. FG_ERR_NUMERIC when
 * there are fewer than 8. */
fg_status fg_arc_fit(fg_context *ctx, const fg_datum_line *line, fg_arc *arc);

/* Fits the algebraic circle alone, for the search of an arc's ends. */
fg_status fg_arc_estimate(fg_context *ctx, const fg_datum_line *line, fg_arc *arc);

/* Radial distance of a point from a circle, outwards. */
double fg_circle_distance(const fg_circle *circle, fg_point p);

/* Radial residual of a station, outwards positive; NaN where the station is not usable. It is
 * corrected for the blur's shift. */
double fg_arc_residual(const fg_datum_line *line, const fg_circle *circle, size_t station);

/* Returns true when a station is in the fit: usable and no outlier. */
bool fg_arc_used(const fg_datum_line *line, const fg_arc *arc, size_t station);

/* Grows `range` from the arc's core, both ways, up to `bounds`, until the line leaves the circle.
 * `side` is +1 when it leaves outwards (a bump's fillets), -1 inwards (a land's). A fillet leaves
 * with the square of the distance from its tangent point. The root of the departure is a straight
 * line, whose foot is that point. The range ends 1.5 blurs before it. */
void fg_arc_grow(const fg_datum_line *line, const fg_arc *arc, double side, fg_range bounds,
                 fg_range *range);

/* Autocovariance of residuals along the strip, pooled over arcs. */
typedef struct fg_noise_model {
  double covariance[FG_NOISE_LAGS]; /* mm², by lag in stations; tapered to 0 */
  size_t lags;                      /* number of lags that count; 1: white */
  double integral_stations;         /* 1 + 2 sum of autocorrelation */
} fg_noise_model;

/* Residuals that noise is estimated from: of the datum line from its circle, or of the half width
 * from its mean. */
typedef enum fg_noise_of { FG_NOISE_OF_LINE, FG_NOISE_OF_HALF_WIDTH } fg_noise_of;

void fg_noise_estimate(const fg_datum_line *line, const fg_arc *arcs, size_t count, fg_noise_of of,
                       fg_noise_model *noise);

/* Covariance of (x, y, R) of one arc under a noise model: A (sum_ij x_i x_j' c_|i-j|) A. Where the
 * estimated correlation is so uncertain that this is no covariance, the noise counts as white with
 * the variance times the integral of the correlation (at least 1). */
void fg_arc_covariance(const fg_datum_line *line, const fg_noise_model *noise, fg_arc *arc);

/* Covariance from the ranges as clusters: A (sum over ranges of g g') A × n/(n - 3), g the sum of x
 * times the residual over one range. It holds when whole ranges deviate together (lands that do not
 * lie on one circle). Returns the ratio of its variance of R to the one in `arc`, and replaces that
 * covariance when the ratio could come by chance with a probability of less than `p`. */
double fg_arc_cluster_covariance(const fg_datum_line *line, double p, fg_arc *arc);

/* Shift of the parameters (x, y, R) if every station of the line moved along its normal by `move`,
 * mm. */
bool fg_arc_shift_by(const fg_datum_line *line, const fg_arc *arc,
                     double (*move)(const void *user, size_t station), const void *user,
                     double shift[3]);

/* Shift of the parameters (x, y, R) if the half width's deviation from its mean were an error of
 * the line. It shows the systematic error of the edge model. */
bool fg_arc_half_width_shift(const fg_datum_line *line, const fg_arc *arc, double shift[3]);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shift between two channels of the same edges: least squares over the cross-sections. */
#ifndef FG_MEASURE_COLOUR_FIT_H
#define FG_MEASURE_COLOUR_FIT_H

#include "foilgauge/colour.h"
#include "measure/colour_stations.h"

/* Slopes in px per mm. A disc that one channel shows larger is larger in all directions. */
enum {
  FG_COLOUR_DX,
  FG_COLOUR_MAGNIFICATION,
  FG_COLOUR_DY,
  FG_COLOUR_SKEW,
  FG_COLOUR_SWELL, /* of discs only */
  FG_COLOUR_UNKNOWNS
};

/* One cross-section's difference between two channels, px, in the order along its part. */
typedef struct fg_colour_row {
  double x_mm, y_mm, nx, ny, bend;
  double value, weight; /* 1 / variance, by the pixels' noise */
  double size;          /* of its residual, in standard deviations of its own */
  int part;
  bool used;
} fg_colour_row;

typedef struct fg_colour_rows {
  fg_colour_row *list; /* owned */
  size_t count;
  double *sizes; /* room for one number each; owned */
  size_t unknowns;
  double x0_mm, pixel_mm[2];
  double scatter;     /* factor of the variances by the residuals, squared */
  double correlation; /* integral of their correlation along the parts, in rows */
  double values[FG_COLOUR_UNKNOWNS], covariance[FG_COLOUR_UNKNOWNS][FG_COLOUR_UNKNOWNS];
} fg_colour_rows;

/* Returns the median contrast of a channel over the square root of its noise; 0: no edge was found.
 */
double fg_colour_contrast(fg_context *ctx, const fg_colour_stations *stations, int channel);

/* Builds the rows that both channels show. FG_ERR_MEMORY. */
fg_status fg_colour_rows_build(fg_context *ctx, const fg_colour_stations *stations, int against,
                               int channel, const double dpi[2], fg_colour_rows *rows);
void fg_colour_rows_free(fg_colour_rows *rows);

/* Coefficients of the unknowns in a row's value. */
void fg_colour_row_coefficients(const fg_colour_rows *rows, const fg_colour_row *row,
                                double to[FG_COLOUR_UNKNOWNS]);

/* Marks as used the rows whose `size` is at most `sigmas` times the spread by the median of the
 * sizes. Returns the number of changes. */
size_t fg_colour_rows_keep(fg_colour_rows *rows, double sigmas);

/* Fits values and covariance of the unknowns with a constant dy to the used rows; drops outliers.
 * The covariance lacks the factors of scatter and correlation. False: the rows do not determine
 * them. */
bool fg_colour_rows_fit(fg_colour_rows *rows);

/* Finds scatter and correlation of the used rows about their values and a drift along y (px). */
void fg_colour_rows_scatter(fg_colour_rows *rows, double (*drift)(const void *user, double y_mm),
                            const void *user);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fit of a scanner's two axes to a plate of known diameters, or of marks at known places. */
#ifndef FG_STATION_CHECK_FIT_H
#define FG_STATION_CHECK_FIT_H

#include "foilgauge/foil.h"

/* A disc of the diameter d shows as an ellipse: its radius in the direction a is
 *   d/2 (1 + scale_x cos² a + scale_y sin² a + shear sin a cos a). */
typedef struct fg_check_fit {
  size_t discs; /* of known diameter; of a grid its marks */
  bool is_grid;
  double scale[2], u_scale[2]; /* measured over true, less 1; x, y */
  double shear, u_shear;       /* rad; a right angle between +x and +y shows as so much less */
  /* Error of the level at which edges are placed: edges of bright parts lie outwards by it, for
   * every size. NaN: discs of one size cannot separate it from the scale. */
  double level_um, u_level_um;
  /* Of a grid, else NaN: the largest residual of a mark beside scale and shear; blur of its edges.
   */
  double largest_um, u_largest_um, blur_um, u_blur_um;
  bool passes;
} fg_check_fit;

/* Fits by least squares over the edges of all discs of known diameter. FG_ERR_NOT_MEASURED:
 * there is none. */
fg_status fg_check_fit_plate(fg_context *ctx, const fg_design *design,
                             const fg_measurement *measurement, fg_check_fit *fit);

/* The same by a grid of known pitch: FG_ERR_NOT_MEASURED for one that shows a single axis. */
fg_status fg_check_fit_grid(fg_context *ctx, const fg_design *design,
                            const fg_measurement *measurement, fg_check_fit *fit);

/* The words of a scanner that is as allowed begin so. */
#define FG_CHECK_IN_ORDER "scanner in order"

/* Judges the fit against the largest deviation of a scale that is allowed; `words`: the result. */
void fg_check_fit_judge(fg_check_fit *fit, double scale_max_ppm, char *words, size_t size);

#endif

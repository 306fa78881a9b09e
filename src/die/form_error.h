/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainty of fitted circles by the form error of the surface.
 *
 * A ground or eroded surface has errors over lengths comparable to a bump's arc: the circle absorbs
 * most of such a wave, and its residual is smaller and shorter than the wave. So size and length of
 * the noise are found by restricted likelihood, which accounts for the circle's parameters, over
 * all bumps of a trace together: residuals in bins along the arc are white noise beside noise with
 * a correlation exp(-d/l) or, smooth, (1 + d/l + (d/l)²/3) exp(-d/l). For very smooth form errors
 * the result is conservative (reports/thesis/die.md).
 */
#ifndef FG_DIE_FORM_ERROR_H
#define FG_DIE_FORM_ERROR_H

#include "foilgauge/die.h"
#include "geometry/arcs.h"

/* Estimates the form error, and the covariance of (x, y, R) of every arc under it. Arcs have one
 * range each. */
fg_status fg_die_form_error_find(fg_context *ctx, const fg_datum_line *line, fg_arc *const *arcs,
                                 size_t count, fg_die_form_error *form_error);

#endif

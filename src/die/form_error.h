/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a surface's form does to the circles that are fitted to it.
 *
 * A ground or eroded surface errs over lengths that are no longer small beside a bump's arc: most
 * of such a wave is taken up by the circle, and what is left of it in the residuals looks smaller
 * and shorter than it is. So size and length of the noise are found by restricted likelihood, which
 * knows what a circle takes up, over all bumps of a trace together: residuals in bins along the arc
 * are white noise beside noise with a correlation exp(-d/l) or, smooth, (1 + d/l + (d/l)²/3)
 * exp(-d/l). On very smooth form that is on the safe side (reports/thesis/die.md).
 */
#ifndef FG_DIE_FORM_ERROR_H
#define FG_DIE_FORM_ERROR_H

#include "foilgauge/die.h"
#include "geometry/arcs.h"

/* Finds it, and the covariance of (x, y, R) of every arc under it. Arcs have one range each. */
fg_status fg_die_form_error_find(fg_context *ctx, const fg_datum_line *line, fg_arc *const *arcs,
                                 size_t count, fg_die_form_error *form_error);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bumps that are no circles within the noise of the foil's edges. */
#ifndef FG_GEOMETRY_BUMP_MISFIT_H
#define FG_GEOMETRY_BUMP_MISFIT_H

#include "geometry/layout.h"

/* Returns the rms residual, mm, above which a bump is no circle: beyond the median of all bumps by
 * a share and by several standard deviations among them. NaN: no memory. */
double fg_misfit_rms_limit(fg_context *ctx, const fg_layout *layout);

/* Replaces the covariance of a bump whose rms exceeds the limit by the one of its own residuals,
 * with their own correlation along the strip, if that is larger. */
void fg_misfit_widen(const fg_datum_line *line, double rms_limit_mm, fg_arc *arc);

#endif

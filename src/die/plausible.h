/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plausibility of a profile as a trace of the design's die: unit, tip, half. */
#ifndef FG_DIE_PLAUSIBLE_H
#define FG_DIE_PLAUSIBLE_H

#include "foilgauge/die.h"
#include "geometry/layout.h"

/* Checks, before the fit, size and number of points. */
fg_status fg_die_check_size(fg_context *ctx, const fg_design *design, const char *path,
                            const fg_die_profile *profile);

/* Checks the tip against the design: it must touch the grooves and be smaller than a bump. */
fg_status fg_die_check_tip(fg_context *ctx, const fg_design *design, const char *path,
                           const fg_die_profile *profile);

/* Checks, after the fit, complete bumps, the half's sense, radii. `trace` has its bumps. */
fg_status fg_die_check_half(fg_context *ctx, const char *path, const fg_die_profile *profile,
                            const fg_layout *layout);
fg_status fg_die_check_trace(fg_context *ctx, const fg_design *design, const char *path,
                             const fg_die_profile *profile, const fg_die_trace *trace);

#endif

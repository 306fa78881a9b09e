/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether a profile can be a trace of the design's die: a wrong unit, a wrong tip, a wrong half. */
#ifndef FG_DIE_PLAUSIBLE_H
#define FG_DIE_PLAUSIBLE_H

#include "foilgauge/die.h"
#include "geometry/layout.h"

/* Before anything is fitted: its size and its points. */
fg_status fg_die_check_size(fg_context *ctx, const fg_design *design, const char *path,
                            const fg_die_profile *profile);

/* The tip against what the design has: it must touch grooves and lie below a bump's size. */
fg_status fg_die_check_tip(fg_context *ctx, const fg_design *design, const char *path,
                           const fg_die_profile *profile);

/* After: bumps that are seen whole, the half's sense, radii. `trace` has its bumps. */
fg_status fg_die_check_half(fg_context *ctx, const char *path, const fg_die_profile *profile,
                            const fg_layout *layout);
fg_status fg_die_check_trace(fg_context *ctx, const fg_design *design, const char *path,
                             const fg_die_profile *profile, const fg_die_trace *trace);

#endif

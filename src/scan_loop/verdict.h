/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the loop on scans says of its effects: decided once, for JSON, page, text and model. */
#ifndef FG_SCAN_LOOP_VERDICT_H
#define FG_SCAN_LOOP_VERDICT_H

#include <stdbool.h>

#include "foilgauge/loop.h"

struct fg_scan_loop;

/* An effect of this size would be a nuisance: what could have been shown at it and was not is
 * `absent`. */
#define FG_SCAN_LOOP_MATTERS_UM 3.0

/* Whether an effect of that size could have been seen: `smallest_um` would have shown, NaN none. */
static inline bool fg_scan_loop_would_show(double smallest_um) {
  return smallest_um <= FG_SCAN_LOOP_MATTERS_UM;
}

/* The word for everything, and for the points alone (outcome.c). */
fg_loop_outcome fg_scan_loop_outcome(const struct fg_scan_loop *loop);
fg_loop_outcome fg_scan_loop_points_outcome(const struct fg_scan_loop *loop);

/* Fills `result` of the loop from what was searched and fitted; anew when it was filled before. */
fg_status fg_scan_loop_decide(fg_context *ctx, struct fg_scan_loop *loop);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decisions of the loop on scans about its effects, made once for JSON, page, text and model. */
#ifndef FG_SCAN_LOOP_VERDICT_H
#define FG_SCAN_LOOP_VERDICT_H

#include <stdbool.h>

#include "foilgauge/loop.h"

struct fg_scan_loop;

/* Size from which an effect is a nuisance, um: an effect that would have shown at this size and did
 * not is `absent`. */
#define FG_SCAN_LOOP_MATTERS_UM 3.0

/* Returns true when an effect of that size would have shown: `smallest_um` is the detectable
 * amplitude, NaN for none. */
static inline bool fg_scan_loop_would_show(double smallest_um) {
  return smallest_um <= FG_SCAN_LOOP_MATTERS_UM;
}

/* Returns the outcome of everything, and of the rows alone (outcome.c). */
fg_loop_outcome fg_scan_loop_outcome(const struct fg_scan_loop *loop);
fg_loop_outcome fg_scan_loop_points_outcome(const struct fg_scan_loop *loop);

/* Returns true where nothing is claimed of discs that deviate from circles by more than noise:
 * their own forms. */
bool fg_scan_loop_has_uneven_discs(const struct fg_scan_loop *loop);

/* Fills `result` of the loop from search and fit; replaces an earlier one. */
fg_status fg_scan_loop_decide(fg_context *ctx, struct fg_scan_loop *loop);

#endif

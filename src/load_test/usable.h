/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Samples that say nothing of the branch they lie on. */
#ifndef FG_LOAD_TEST_USABLE_H
#define FG_LOAD_TEST_USABLE_H

#include "foilgauge/load_test.h"

/* Marks in `left_out` (count of the direction) the samples at which an instrument stands at the end
 * of its range, and flags the direction. */
void fg_load_mark_saturated(const fg_load_test *test, fg_load_direction *direction, bool *left_out);

/* Finds the depth from which a way back within a stroke is no noise of the displacement. */
fg_status fg_load_find_depth(fg_context *ctx, const fg_load_test *test,
                             const fg_load_direction *direction, double *depth_mm);

/* Marks the samples of a stroke, `first` to `last`, from where the displacement goes back by more
 * than the depth until it is where it was. Within such a loop the force lies off the branch, and
 * where the loop closes it is back on it (return-point memory: G. Bertotti, I. Mayergoyz, The
 * Science of Hysteresis, 2006). Returns true when there is one. */
bool fg_load_mark_loops(const fg_load_sample *samples, size_t first, size_t last, int sense,
                        double depth_mm, bool *left_out);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Noise of force and of displacement, told apart by how the scatter follows the slope; and what
 * that means for the strokes: where a stroke turns, samples lie closer than the displacement is
 * known, and what is regressed on it is bent. */
#ifndef FG_LOAD_TEST_NOISE_H
#define FG_LOAD_TEST_NOISE_H

#include "load_test/strokes.h"

/* Step of a column that was rounded; 0: none is seen. */
double fg_load_find_step(const fg_load_sample *samples, size_t count);

/* Fills `noise` of the strokes, the variance of every sample by it, and where strokes turn; drops
 * the samples within the displacement's noise of the turns. */
fg_status fg_load_find_noise(fg_context *ctx, const fg_load_sample *samples, double step_mm,
                             fg_load_strokes *strokes);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Noise of force and of displacement, separated by the dependence of the scatter on the slope. Near
 * a turn, samples lie closer than the displacement's noise, which biases any regression on the
 * displacement. */
#ifndef FG_LOAD_TEST_NOISE_H
#define FG_LOAD_TEST_NOISE_H

#include "load_test/strokes.h"

/* Returns the rounding step of a column; 0: none visible. */
double fg_load_find_step(const fg_load_sample *samples, size_t count);

/* Fills `noise` of the strokes, the variance of every sample from it, and the turns of the strokes;
 * drops the samples within the displacement's noise of the turns. */
fg_status fg_load_find_noise(fg_context *ctx, const fg_load_sample *samples, double step_mm,
                             fg_load_strokes *strokes);

#endif

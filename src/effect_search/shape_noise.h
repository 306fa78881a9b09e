/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Noise of a strip's width that its shape passes on. The strip's level, its surroundings' and the
 * edges' blur are fitted to the same pixels as the edges; where the strip is a few blurs wide, they
 * are hard to tell from its width. They are curves over direction and place, so that this part of
 * the width's error is smooth along the whole foil, and no scatter of rows shows it. */
#ifndef FG_EFFECT_SEARCH_SHAPE_NOISE_H
#define FG_EFFECT_SEARCH_SHAPE_NOISE_H

#include "foilgauge/strip.h"

/* Returns the variance of half the width by the fitted shape, um² for one mm of strip: that of the
 * fit of everything less that of the edges alone (Cramer-Rao bounds of a strip between two edges of
 * the same blur on a level that falls off linearly). `px_mm`: a pixel. 0: no noise is known. */
double fg_shape_noise_um2_mm(const fg_strip *strip, double px_mm);

/* Functions over direction and place that the shape follows (vision/edges_smooth.c), without the
 * mean. */
enum { FG_SHAPE_FUNCTIONS = 6 };

/* At a normal's direction; place: x and y, in whatever unit. */
void fg_shape_functions(double normal_rad, const double place[2], double *values);

#endif

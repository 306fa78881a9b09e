/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Local quadratic regression of a stroke's force over its displacement. It never crosses an
 * unsampled stretch (holes.c): beyond it is another branch. */
#ifndef FG_LOAD_TEST_LOCAL_FIT_H
#define FG_LOAD_TEST_LOCAL_FIT_H

#include "load_test/strokes.h"

typedef struct fg_local_fit {
  double value, u_value; /* F, N */
  double slope, u_slope; /* dF/dx, N/mm */
  double window_mm;      /* half of its width */
  double u_unsampled_mm; /* of a crossing in an unsampled stretch, its contribution; 0: in none */
} fg_local_fit;

typedef enum fg_local_target { FG_LOCAL_VALUE, FG_LOCAL_SLOPE } fg_local_target;

/* Fits a window of half width `window_mm` about x. False: too few samples in it. */
bool fg_local_fit_at(const fg_load_stroke *stroke, double x, double window_mm, fg_local_fit *fit);

/* With this window, or with the next wider one that holds enough samples. */
bool fg_local_fit_near(const fg_load_stroke *stroke, double x, double window_mm, fg_local_fit *fit);

/* Fits with this window; u includes half of the difference from the next wider one. */
bool fg_local_fit_with(const fg_load_stroke *stroke, double x, double window_mm, fg_local_fit *fit);

/* Interpolates within an unsampled stretch on the chord between its borders, with u of a
 * rectangular distribution over the rise of the force. False: x lies in none. */
bool fg_local_across(const fg_load_stroke *stroke, double x, fg_local_fit *fit);

/* Fits with a window chosen by the noise. */
bool fg_local_fit_adaptive(const fg_load_stroke *stroke, double x, fg_local_target target,
                           fg_local_fit *fit);

/* Finds the place where the force passes `level_n`, coming from the largest displacement, and the
 * fit there. In an unsampled stretch: within its bounds, see `u_unsampled_mm`. False: it does not
 * pass. */
bool fg_local_crossing(const fg_load_stroke *stroke, double level_n, double *x, double *u_x,
                       fg_local_fit *fit);

#endif

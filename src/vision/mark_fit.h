/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The place of a mark to the bound of the picture's noise: a least-squares fit of the mark's model
 * to its pixels. */
#ifndef FG_VISION_MARK_FIT_H
#define FG_VISION_MARK_FIT_H

#include "vision/mark_model.h"
#include "vision/tiles.h"

/* A mark to be fitted, and the fit. */
typedef struct fg_mark_fit {
  double p[FG_MARK_PARAMETERS_MAX]; /* on entry a start */
  double reach_px;                  /* half the side of the window, or its radius */
  double along_px;                  /* of lines: half the length that is used */
  double u_px;                      /* along x and along y; of a line across it */
  double residual;                  /* rms, counts */
  double share; /* of the window's pixels that were seen; a covered mark misses some */
} fg_mark_fit;

/* Returns false where no mark of this kind fits. */
fg_status fg_mark_fit_run(fg_context *ctx, const fg_tiles *tiles, fg_mark_kind kind,
                          fg_mark_fit *fit, bool *found);

#endif

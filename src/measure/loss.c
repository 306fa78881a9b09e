/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/loss.h"

#include <math.h>

#include "scan/jpeg_tables.h"

/* Variance of an edge's place by a quantization step, px². A step rounds all profiles across an
 * edge alike, and tone curve and levels are fitted to them: the edges of a scan move together. The
 * move grows with the steps over the contrast, and with the edge's sharpness, as more of it lies at
 * frequencies of large steps. Sharper edges than any scanner's count as the sharpest possible. */
#define EDGE_PX2_PER_STEP 1.9
#define BLUR_MIN_PX       0.5
/* Additional variance per gray value of step along an edge that runs with the rows or columns:
 * neighbouring blocks are rounded alike there, unlike elsewhere. A strip's two edges share less of
 * it. */
#define TURN_VARIANCE_PER_STEP 0.04
#define ARC_VARIANCE_PER_STEP  0.02

double fg_loss_edge_px(int jpeg_quality, double contrast, double blur_px) {
  if (!jpeg_quality || contrast == 0) return 0;
  double step = fg_jpeg_step_of(jpeg_quality) / fabs(contrast);
  return EDGE_PX2_PER_STEP * step / fmax(blur_px, BLUR_MIN_PX);
}

double fg_loss_turn_variance(int jpeg_quality) {
  return jpeg_quality ? TURN_VARIANCE_PER_STEP * fg_jpeg_step_of(jpeg_quality) : 0;
}

double fg_loss_arc_variance(int jpeg_quality) {
  return jpeg_quality ? ARC_VARIANCE_PER_STEP * fg_jpeg_step_of(jpeg_quality) : 0;
}

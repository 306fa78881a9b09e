/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A smooth reference line along a strip: stations at equal steps with tangent and curvature.
 *
 * Pixels get their place (along, across) from this line. It must be smooth; its exact place in the
 * strip does not matter.
 */
#ifndef FG_VISION_REFERENCE_H
#define FG_VISION_REFERENCE_H

#include "foilgauge/circle.h"
#include "vision/trace.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_reference_station {
  double x, y;      /* px */
  double tx, ty;    /* unit tangent; the normal is (-ty, tx) */
  double curvature; /* 1/px, positive when the line bends towards the normal */
} fg_reference_station;

typedef struct fg_reference {
  fg_reference_station *stations; /* owned */
  size_t count;
  double step_px;
} fg_reference;

/* Smooths traced points with local parabolas over ± window_px and resamples them. */
fg_status fg_reference_build(fg_context *ctx, const fg_point *points, size_t count,
                             double window_px, double step_px, fg_reference *reference);

void fg_reference_free(fg_reference *reference);

/* A pixel's place relative to the circle that osculates a station, from its offset a along the
 * tangent and b along the normal: along = a/(1 - kb), across = b - k a²/(2 (1 - kb)). For a within
 * a step of the station the error is (ka)^3 a/8, below 1e-6 px. */
static inline void fg_reference_project(double curvature, double a, double b, double *along,
                                        double *across) {
  *along = a / (1 - curvature * b);
  *across = b - 0.5 * curvature * a * *along;
}

#ifdef __cplusplus
}
#endif
#endif

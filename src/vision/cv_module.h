/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Types and functions of the module around OpenCV. cv_bridge.c loads it at the first use, because
 * OpenCV brings thirty shared objects that most commands never use. */
#ifndef FG_VISION_CV_MODULE_H
#define FG_VISION_CV_MODULE_H

#include <stddef.h>
#include <stdint.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FG_CV_MODULE_FILE   "foilgauge-opencv.so"
#define FG_CV_MODULE_SYMBOL "fg_cv_module"

/* Closed contours: contour i holds the points starts[i] to starts[i + 1] - 1, in order. */
typedef struct fg_contours {
  int32_t *xy;    /* x, y of every point; owned */
  size_t *starts; /* count + 1; owned */
  size_t count;
} fg_contours;

/* A picture to draw on: rows of R, G, B bytes, without padding. */
typedef struct fg_rgb {
  uint8_t *pixels; /* 3 × width × height */
  int32_t width, height;
} fg_rgb;

/* Size, place and colour of drawn text. */
typedef struct fg_text_style {
  double height_px;     /* of the capitals */
  double anchor;        /* share of the text's width by which it moves to the left */
  uint32_t colour;      /* 0xRRGGBB */
  int32_t thickness_px; /* of the strokes */
  int32_t rim_px;       /* of the dark rim around the strokes; 0: none */
} fg_text_style;

/* Each is the function of cv_bridge.h of that name. */
typedef struct fg_cv_functions {
  const char *version; /* version of the program that the module was built with */
  fg_status (*contours)(fg_context *ctx, const uint8_t *picture, int32_t width, int32_t height,
                        double level, int32_t min, fg_contours *out);
  fg_status (*draw_line)(fg_context *ctx, fg_rgb *rgb, const double *xy_px, size_t count,
                         uint32_t colour, int32_t thickness_px);
  fg_status (*draw_text)(fg_context *ctx, fg_rgb *rgb, const char *text, const double at_px[2],
                         const fg_text_style *style);
} fg_cv_functions;

#ifdef __cplusplus
}
#endif
#endif

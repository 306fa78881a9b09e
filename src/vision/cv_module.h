/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the module around OpenCV offers: it is loaded where it is first needed (cv_bridge.c), as
 * OpenCV brings thirty shared objects that most commands never use. */
#ifndef FG_VISION_CV_MODULE_H
#define FG_VISION_CV_MODULE_H

#include "vision/cv_bridge.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FG_CV_MODULE_FILE   "foilgauge-opencv.so"
#define FG_CV_MODULE_SYMBOL "fg_cv_module"

/* Each is the function of cv_bridge.h of that name. */
typedef struct fg_cv_functions {
  const char *version; /* of the program that it was built with */
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

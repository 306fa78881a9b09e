/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The only door to OpenCV (core and imgproc): plain C in, plain C out, no exception escapes. The
 * first call loads OpenCV; FG_ERR_IO when that fails. */
#ifndef FG_VISION_CV_BRIDGE_H
#define FG_VISION_CV_BRIDGE_H

#include "vision/cv_module.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Finds the outlines of the areas brighter than `level` and of the gaps in them, when their box is
 * at least `min` cells wide and high. Width and height are at most 32767. */
fg_status fg_cv_contours(fg_context *ctx, const uint8_t *picture, int32_t width, int32_t height,
                         double level, int32_t min, fg_contours *out);
void fg_contours_free(fg_contours *contours);

/* Draws an antialiased line through `count` points x, y in px. Pixel centres are whole numbers; the
 * picture's border clips the line. `colour` is 0xRRGGBB. */
fg_status fg_cv_draw_line(fg_context *ctx, fg_rgb *rgb, const double *xy_px, size_t count,
                          uint32_t colour, int32_t thickness_px);

/* Draws ASCII text, its baseline at at_px[1]. */
fg_status fg_cv_draw_text(fg_context *ctx, fg_rgb *rgb, const char *text, const double at_px[2],
                          const fg_text_style *style);

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One way to draw, two places to draw on: a picture of pixels, and inline SVG.
 *
 * Positions are in mm of the scan. Widths and heights of letters are in units of the
 * canvas, so that a picture of any size looks alike.
 */
#ifndef FG_PAGE_CANVAS_H
#define FG_PAGE_CANVAS_H

#include "page/picture.h"
#include "vision/cv_bridge.h"

/* Colours of drawings over a scan, 0xRRGGBB. */
enum {
  FG_COLOUR_EDGE = 0x00a6c8,
  FG_COLOUR_BUMP = 0xff7a1a,
  FG_COLOUR_OVERALL = 0x3d9dff,
  FG_COLOUR_RESIDUAL = 0xe0359b,
  FG_COLOUR_TEXT = 0xffffff,
};

typedef struct fg_canvas {
  fg_rgb *rgb; /* draw here, or */
  FILE *svg;   /* write here */
  double px_per_mm[2];
  double origin_px[2]; /* canvas px of the scan's (0, 0) */
  double unit_px;      /* of widths and letters */
  int32_t width_px, height_px;
} fg_canvas;

typedef struct fg_pen {
  uint32_t colour; /* 0xRRGGBB */
  double width;    /* units */
  double dash;     /* length of a dash and of a gap, units; 0: solid */
} fg_pen;

/* Returns a canvas over a measured scan, or over a picture of it. */
fg_canvas fg_canvas_over(const fg_picture *picture, const fg_measurement *measurement);

/* Draws a line through points. Points closer than half a pixel are left out. */
fg_status fg_canvas_line(fg_context *ctx, fg_canvas *canvas, const fg_point *mm, size_t count,
                         fg_pen pen);

/* Draws `count` lines of two points each. */
fg_status fg_canvas_segments(fg_context *ctx, fg_canvas *canvas, const fg_point (*mm)[2],
                             size_t count, fg_pen pen);

/* Draws an arc of a circle; angles run from the x axis towards y. */
fg_status fg_canvas_arc(fg_context *ctx, fg_canvas *canvas, const fg_circle *circle,
                        double from_rad, double to_rad, fg_pen pen);

/* Writes text with a dark rim, which can be read on any ground. Its capitals are `height` units
 * tall, and their middle is at the point's height. `anchor` 0: it starts at the point; 0.5:
 * centred there. */
fg_status fg_canvas_text(fg_context *ctx, fg_canvas *canvas, fg_point mm, double height,
                         double anchor, uint32_t colour, const char *text);

/* Rewrites text in ASCII, the only letters of a picture: α becomes alpha, ± becomes +-. */
void fg_text_to_ascii(const char *text, char *ascii, size_t size);

#endif

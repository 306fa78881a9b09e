/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The three lines of a colour sensor.
 *
 * Each line reads every row of the glass at a moment of its own. The scanner joins the rows read
 * together by the lines' nominal gap, so the channels differ by the carriage's unevenness over that
 * gap. */
#ifndef FG_RENDER_COLOUR_LINES_H
#define FG_RENDER_COLOUR_LINES_H

#include <stdbool.h>

#include "render/members.h"

enum { FG_COLOUR_LINES = 3 }; /* red, green, blue */

/* One line: true = nominal - shift + d(x, y + gap), along x after the correction of the
 * magnification about the picture's middle. */
typedef struct fg_colour_line {
  double gap_px;               /* row y is read with errors of the carriage at y + gap */
  double shift_px[2];          /* shift of everything in the picture, right and down */
  double magnification_ppm;    /* enlargement along x */
  double background, contrast; /* of 255 */
} fg_colour_line;

typedef struct fg_colour_lines {
  bool stated; /* false: the scan is gray */
  fg_colour_line line[FG_COLOUR_LINES];
} fg_colour_lines;

extern const char *const fg_colour_line_words[FG_COLOUR_LINES];

/* Reads member colour_lines of a spec's scanner. Background and contrast default to those of the
 * gray scan. */
fg_status fg_colour_lines_read(const fg_place *place, const cJSON *scanner, double background,
                               double contrast, fg_colour_lines *lines);

/* Returns the largest shift of anything by a line, along one axis, px. */
double fg_colour_lines_reach_px(const fg_colour_lines *lines, double width_px);

#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The three lines of a colour sensor. Each reads every row of the glass at a moment of its own; the
 * scanner puts the rows that were read together again by the lines' nominal gap, so what is left
 * between the channels is the carriage's unevenness over that gap. */
#ifndef FG_RENDER_COLOUR_LINES_H
#define FG_RENDER_COLOUR_LINES_H

#include <stdbool.h>

#include "core/json_writer.h"
#include "render/members.h"

enum { FG_COLOUR_LINES = 3 }; /* red, green, blue */

/* One line: true = nominal - shift + d(x, y + gap), along x after the magnification about the
 * picture's middle was taken off. */
typedef struct fg_colour_line {
  double gap_px;               /* what is read at row y with errors of the carriage at y + gap */
  double shift_px[2];          /* by which it shows everything further right and down */
  double magnification_ppm;    /* and larger along x */
  double background, contrast; /* of 255 */
} fg_colour_line;

typedef struct fg_colour_lines {
  bool stated; /* else the scan is gray */
  fg_colour_line line[FG_COLOUR_LINES];
} fg_colour_lines;

extern const char *const fg_colour_line_words[FG_COLOUR_LINES];

/* Member colour_lines of a spec's scanner. Background and contrast are those of the gray scan where
 * nothing else is said. */
fg_status fg_colour_lines_read(const fg_place *place, const cJSON *scanner, double background,
                               double contrast, fg_colour_lines *lines);

/* The most by which a line shows anything away from its place, along one axis, px. */
double fg_colour_lines_reach_px(const fg_colour_lines *lines, double width_px);

#endif

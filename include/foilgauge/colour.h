/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shifts between the channels of a colour scan, whose sensor has three lines.
 *
 * Each line sees an edge at a moment of its own, so each channel has its own place of every edge.
 * With n the edge's normal and D(y) the carriage's error (true = nominal + D), a line that lies a
 * gap g ahead shows, after the scanner has put the rows together by the nominal gap, an edge at
 *
 *   n . d = n_x (dx + m (x - x0)) + n_y (dy(y) + s (x - x0)),   dy(y) = dy - (D(y + g) - D(y))
 *
 * away from where the other line shows it: m is lateral colour of the optics, s a line that is
 * turned against the other, and dy(y) the carriage's unevenness over the gap, without anything that
 * the optics, the part or its edges do: those are the same in all channels.
 */
#ifndef FOILGAUGE_COLOUR_H
#define FOILGAUGE_COLOUR_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/scan.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Distance between two channels, in pixels, from which on it is flagged. */
#define FG_COLOUR_APART_PX 0.1
/* p below which a drift is called uneven, and the constants are found beside it. */
#define FG_COLOUR_UNEVEN_P 0.01

enum { FG_COLOUR_WINDOWS_MAX = 240, FG_COLOUR_SHARED = 4 };

/* Mean of dy(y) over the edges of one window along y, and the smooth curve there. u_dy combines
 * u_own, which the windows do not share, and the shifts by one standard deviation of each of four
 * independent errors that they do share. */
typedef struct fg_colour_window {
  float y_mm, dy_um, u_dy_um;
  float u_own_um, shared_um[FG_COLOUR_SHARED];
  float smooth_um, u_smooth_um;
} fg_colour_window;

typedef enum fg_colour_state {
  FG_COLOUR_MEASURED,    /* "measured" */
  FG_COLOUR_IDENTICAL,   /* "identical": the same picture as the other: a gray one saved as RGB */
  FG_COLOUR_NO_CONTRAST, /* "no_contrast": its edges cannot be seen */
  FG_COLOUR_FEW_EDGES,   /* "few_edges": too few to tell */
} fg_colour_state;

/* One channel against another: its places of edges minus the other's. Values are NaN unless
 * measured; all zero without u where identical. dx and dy hold at (x0, mean over all y). */
typedef struct fg_colour_shift {
  fg_channel channel;
  fg_colour_state state;
  double dx_px, u_dx_px, dy_px, u_dy_px;
  double magnification_ppm, u_magnification_ppm; /* m: this channel's picture is larger along x */
  double skew_ppm, u_skew_ppm;                   /* s */
  double largest_px;   /* largest distance along x within the measured parts */
  size_t stations;     /* cross-sections used */
  double rms_um;       /* of the remaining differences, along the normal */
  double correlation;  /* squared ratio of their u to that of independent ones */
  double drift_rms_um; /* of the smooth dy(y) about its mean */
  double p_constant;   /* probability that a constant dy looks like this: small, the carriage was
                          uneven */
  double window_mm;    /* length of a window */
  size_t window_count;
  fg_colour_window windows[FG_COLOUR_WINDOWS_MAX]; /* ascending y */
} fg_colour_shift;

typedef struct fg_colour_lines {
  bool seen;          /* it is a colour scan whose channels could be read apart; else all is 0 */
  fg_channel against; /* the channel that was measured; green where it was their mean */
  double x0_mm;       /* place at which dx and dy hold */
  fg_colour_shift shifts[2];
  bool apart; /* one of them by more than FG_COLOUR_APART_PX */
} fg_colour_lines;

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A traced strip: both edges of a foil's cross-section along its whole length.
 *
 * The vision side fills it, the geometry side reads it. Positions are in mm of the scan:
 * x right, y down, pixel centres at whole numbers times the axis' pixel size.
 */
#ifndef FOILGAUGE_STRIP_H
#define FOILGAUGE_STRIP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/status.h"

#include "foilgauge/circle.h"
#include "foilgauge/picture.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Facts about a strip in the scan; the recogniser turns them into flags. */
typedef enum fg_strip_fact {
  FG_STRIP_TOUCHES_BORDER = 1u << 0, /* the scan's border cuts it */
  FG_STRIP_TOUCHES_OTHER = 1u << 1,  /* something else of the same material touches it */
  FG_STRIP_CLIPPED = 1u << 2,        /* pixels at the edges are at the end of the scale */
  FG_STRIP_SIDE_BAND = 1u << 3,      /* a band beside one edge: the part's wall shows */
  FG_STRIP_GAP = 1u << 4,            /* the strip is interrupted or its edge is hidden somewhere */
} fg_strip_fact;

/* Defect of a station that is not usable. */
typedef enum fg_station_fact {
  FG_STATION_DISTURBED = 1u << 0, /* its pixels are not those of a strip */
  FG_STATION_CUT = 1u << 1,       /* background shows all across the strip */
  FG_STATION_TOUCHED = 1u << 2,   /* another part lies on the strip or beside it */
} fg_station_fact;

/* One cross-section. Left and right are as seen when walking along the strip with y down:
 * the normal is the tangent turned by +90 degrees (from x to y), and `right` lies on its side. */
typedef struct fg_station {
  double s_mm;     /* arc length of the midline from the strip's first end */
  fg_point left;   /* left edge, mm */
  fg_point right;  /* right edge, mm */
  fg_point normal; /* unit normal, in mm coordinates */
  float u_left_um; /* standard deviation of the edge along the normal, from pixel noise alone */
  float u_right_um;
  float weight;   /* 0: not usable (dust, burr, hidden edge); 1: good */
  unsigned facts; /* fg_station_fact */
} fg_station;

/* The cut at one end of a strip. */
typedef struct fg_strip_end {
  bool found;           /* it is seen as a straight cut */
  bool at_border;       /* the scan's border hides it */
  fg_point left, right; /* where it meets the lines of the strip's edges, mm */
  double u_um, u_skew; /* standard deviation along the strip of its middle, and of its direction out
                          of square (a ratio), by the pixels' misfit */
  double blur_um;      /* sd of the blur across it */
} fg_strip_end;

typedef struct fg_strip {
  fg_station *stations; /* in order along the strip, from one end to the other; owned */
  size_t count;
  fg_strip_end ends[2];  /* at the first station and at the last */
  double step_mm;        /* nominal distance of stations */
  double thickness_mm;   /* median distance of the edges */
  double u_thickness_mm; /* from its variation along the strip; the tone curve's uncertainty is
                            separate: */
  double blur_left_um, blur_right_um; /* sd of the edge blur found on each side */
  double contrast;             /* strip minus background, in units of the scan's full scale */
  double noise;                /* pixel noise sd, same unit */
  bool bright;                 /* brighter than its surroundings */
  double spread_px, asymmetry; /* of its edges, see vision/edge_spread.h; NaN: not seen */
  /* Thickness, blur and contrast (counts of 255) with counts used as light, whatever tone curve the
   * edges show. Gauges and the level of a scanner's model are applied by them. NaN: not measured,
   * or not wanted (fg_measure_options.without_plain) and a tone curve was found. */
  double plain_mm, plain_blur_um, plain_counts;
  bool plain_side_band; /* as FG_STRIP_SIDE_BAND */
  double gamma;         /* exponent of the tone curve found */
  double u_gamma;       /* by its profiles */
  double loss_um; /* u of each edge's place by JPEG's loss, outwards or inwards with the other edge;
                     0: lossless */
  double loss_variance; /* share by which the loss raises the variance from the residuals */
  double tone_um; /* change of thickness per unit of ln gamma: both edges lie at half the light */
  unsigned facts; /* fg_strip_fact */
  fg_picture_state picture; /* beside its edges */
  int64_t box_px[4];        /* x, y, width, height of its area in the scan */
} fg_strip;

void fg_strip_free(fg_strip *strip); /* frees the stations; NULL is fine */

/* Sets thickness and its uncertainty from the stations, also after their edges were moved: the
 * median distance of the edges, and the standard error of its mean over stretches of an eighth of
 * the strip, since neighbouring stations err alike. NaN without usable stations. */
fg_status fg_strip_measure_thickness(fg_context *ctx, fg_strip *strip);

/* The blur of a strip's edges: that of the side where it is wider. */
double fg_strip_blur_um(const fg_strip *strip);

/* The strip's thickness in units of that blur. */
double fg_strip_widths_in_blurs(const fg_strip *strip);

/* By how much the edges of a thin strip err more than those of a wide one, since they blur into
 * each other: the error is a share of the blur that grows with its cube (reports/accuracy_hard.md)
 * below three blurs of thickness. 1: the strip is that wide. */
double fg_strip_coarseness(const fg_strip *strip);

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gauges on the glass: parts of known width in the same scan as the measured parts.
 *
 * An edge lies where the light is halfway between both sides. The tone curve T makes a count
 * of it that is h of the contrast, from dark to bright. Where edges are put at half of the counts
 * instead, every edge of blur s is seen (h - 1/2) s sqrt(2 pi) farther on its dark side: a bright
 * part is wider by twice that, and a hole in it narrower. Edges alone do not determine h. A gauge
 * does:
 *
 *   measured - known = ± 2 (h - 1/2) s sqrt(2 pi) + width × scale error
 *
 * + where it is bright. Gauge and part are both read with edges at half of the counts for that:
 * edge models that guess a tone curve may guess another one for each. With more than one gauge h is
 * the least-squares solution, with the scanner's scale as a nuisance parameter: a thin leaf
 * determines h better than a thick pin. Then every edge of every part is moved to h.
 */
#ifndef FOILGAUGE_GAUGE_H
#define FOILGAUGE_GAUGE_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum fg_gauge_kind {
  FG_GAUGE_LEAF, /* "leaf": of a feeler gauge, standing on its edge: a strip of known thickness */
  FG_GAUGE_PIN,  /* "pin": seen end-on: a disc of known diameter */
  FG_GAUGE_RING, /* "ring": a setting ring, whose bore is known */
  FG_GAUGE_HOLE, /* "hole": in a part of any outline */
} fg_gauge_kind;

/* A gauge as stated by the user. */
typedef struct fg_gauge {
  fg_gauge_kind kind;
  double width_mm, u_mm; /* thickness or diameter, and its standard uncertainty */
} fg_gauge;

enum { FG_GAUGES_MAX = 8 };

/* The same gauge in a scan. */
typedef struct fg_gauge_reading {
  bool found;                        /* false: nothing below but `note` is set */
  bool used;                         /* it contributes to the level of the scan's edges */
  double measured_mm, u_measured_mm; /* before any edge was moved; u from the edges' scatter */
  double place_mm[4];                /* its box in the scan: x, y, width, height */
  double level, u_level;             /* h - 1/2 by this gauge alone, share of the contrast */
  double blur_mm;                    /* sd of its edges' blur */
  double contrast;                   /* bright minus dark, counts of 255 */
  bool bright;                       /* the area between its edges is bright */
  char note[160];                    /* reason why it was not found, or is not used; empty */
} fg_gauge_reading;

/* "leaf", "pin", "ring", "hole". */
const char *fg_gauge_word(fg_gauge_kind kind);

/* Reads "leaf:0.1:0.0005": kind, width and its standard uncertainty in mm. FG_ERR_USAGE. */
fg_status fg_gauge_parse(fg_context *ctx, const char *text, fg_gauge *gauge);

/* FG_ERR_DATA for an impossible value; `name` is its name in the message. */
fg_status fg_gauge_check(fg_context *ctx, const char *name, const fg_gauge *gauge);

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A die measured by a stylus: traces x, z of each half against the design of the foil that it
 * presses.
 *
 * HALVES. A half is named by its bumps: the concave half has grooves (its lands are a dome) and
 * touches the strip's inner side, the shaft's; the convex half has ridges (its lands are a bowl)
 * and touches the outer side, the sleeve's.
 *
 * THE TIP. A trace is where the centre of a tip of radius r went (its lowest point is the same line
 * lower by r), a line parallel to the surface: its circles have the surface's centres, ridges a
 * radius that is r larger, grooves one that is r smaller, for bumps and lands alike. The circles
 * are fitted to that line and r is taken off: no direction of the surface has to be estimated.
 *
 * THE DATUM. A half's surface lies half a thickness t from the midline of the strip in the closed
 * die: concave half R + t/2, R0 - t/2; convex half R - t/2, R0 + t/2. Everything is reported of the
 * design's datum line. A strip of constant thickness that is pressed between both halves has its
 * midline half way between their surfaces: the die's value is the mean of the halves'.
 */
#ifndef FOILGAUGE_DIE_H
#define FOILGAUGE_DIE_H

#include "foilgauge/foil.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum fg_die_half { FG_DIE_CONCAVE, FG_DIE_CONVEX, FG_DIE_HALVES } fg_die_half;

/* "concave", "convex" */
const char *fg_die_half_word(fg_die_half half);

typedef enum fg_die_unit { FG_DIE_UNIT_NONE, FG_DIE_MM, FG_DIE_UM, FG_DIE_NM } fg_die_unit;

/* "mm", "um", "nm"; "" for none. */
const char *fg_die_unit_word(fg_die_unit unit);

/* What is said of one trace beside its file. What is not said is taken from the file's header, the
 * half also from its name; what contradicts it is an error. */
typedef struct fg_die_source {
  const char *path;
  const char *half;    /* "concave" or "convex"; NULL: not said */
  fg_die_unit unit[2]; /* of x, z; FG_DIE_UNIT_NONE: not said */
  size_t column[2];    /* of x, z, from 1; 0: not said */
  double tip_um;       /* radius of the tip; NaN: not said; 0: the profile is corrected already */
  bool reversed;       /* bump numbers run against x */
  int first_bump;      /* the lowest number of the bumps whose crown is seen; 0: 1 */
} fg_die_source;

typedef struct fg_die_options {
  double u_tip_um;      /* standard uncertainty of the tip's radius */
  double u_scale_ppm;   /* of the instrument's scale, of x and z alike */
  double max_slope_deg; /* what is steeper takes no part in a fit; 0: the default */
} fg_die_options;

#define FG_DIE_MAX_SLOPE_DEG 77.0

/* A profile as its file has it, in mm and in the order of ascending x. */
typedef struct fg_die_profile {
  fg_point *points; /* x, z; owned */
  size_t count;
  size_t first_line; /* of the file's data */
  fg_die_half half;
  fg_die_unit unit[2];
  double tip_um;
  char sha256[65];
} fg_die_profile;

/* Reads and checks a file. FG_ERR_DATA names the file, the line and what to do; FG_ERR_IO. */
fg_status fg_die_profile_load(fg_context *ctx, const fg_die_source *source,
                              fg_die_profile *profile);
void fg_die_profile_free(fg_die_profile *profile);

/* A station of a trace: a mean of a few of its points. */
typedef struct fg_die_station {
  double x, z;        /* mm, as traced */
  double residual_um; /* from the circle of its bump or of the lands; NaN: in no fit */
  int bump;           /* number; 0: the lands', -1: neither */
} fg_die_station;

/* Noise along the bumps' arcs by restricted likelihood (src/die/form_error.h). */
typedef struct fg_die_form_error {
  double sd_mm;       /* of means over a small part of an arc */
  double length_mm;   /* of its correlation: exp(-d/l), where it is `smooth` (1 + d/l + (d/l)²/3)
                         exp(-d/l) */
  double white_share; /* of the variance; the rest is correlated */
  bool smooth;
} fg_die_form_error;

/* One trace measured; lengths of the design's datum line, centres of the trace (x, z, mm). */
typedef struct fg_die_trace {
  const char *path; /* not owned */
  char sha256[65];
  fg_die_half half;
  int repeat; /* among its half's traces, from 1 */
  fg_die_unit unit[2];
  double tip_um;
  bool reversed;
  size_t points;           /* of the file */
  double length_mm;        /* in x */
  double step_um;          /* mean distance of its stations */
  double steep_share;      /* of its stations that are too steep */
  size_t lands, cut_bumps; /* cut: seen in part only, at an end or too steep */
  int *lost;               /* numbers of bumps that were traced from foot to foot, and whose arc is
                              no circle: dust, a burr, a lost contact; among cut_bumps; owned */
  size_t lost_count;
  int last_number;              /* the highest number of the bumps whose crown is seen */
  double noise_um;              /* sd of the bumps' residuals */
  fg_die_form_error form_error; /* form error: noise model of the residuals */
  double shift_mm;              /* added to a bump's traced radius by tip and datum */
  fg_overall overall;           /* springback_error_pct is the error with its sign turned round */
  fg_bump *bumps;               /* in order of number; owned */
  size_t bump_count;
  fg_die_station *stations; /* in order of x; owned */
  size_t station_count;
} fg_die_trace;

/* Measures one profile. FG_ERR_DATA: it is no trace of this design's die (unit, tip, bumps). */
fg_status fg_die_trace_measure(fg_context *ctx, const fg_design *design,
                               const fg_die_options *options, const fg_die_source *source,
                               const fg_die_profile *profile, fg_die_trace *trace);

/* What is reported of every bump, and as a mean of each half. */
typedef enum fg_die_quantity {
  FG_DIE_RADIUS,
  FG_DIE_RADIUS_ERROR,
  FG_DIE_ANGLE,
  FG_DIE_ANGLE_ERROR,
  FG_DIE_CENTRE,
  FG_DIE_HEIGHT,
  FG_DIE_INTERSECTION,
  FG_DIE_PLACE, /* angle from where the design has the bump, the trace's rotation taken off */
  FG_DIE_QUANTITIES
} fg_die_quantity;

typedef struct fg_die_row {
  const char *name, *unit, *symbol, *words;
  int decimals;
} fg_die_row;

const fg_die_row *fg_die_row_of(fg_die_quantity quantity);

/* The design's value. */
double fg_die_nominal(const fg_design *design, const fg_nominal *nominal, fg_die_quantity quantity);

/* Over repeats: mean, sd of one repeat (NaN from one), standard uncertainty of the mean with what
 * repeats do not show: form of the surface, tip, scale. Over a half's bumps: the sd is theirs. */
typedef struct fg_die_value {
  double value, sd, u;
} fg_die_value;

typedef struct fg_die_bump {
  int number;
  size_t count; /* of repeats; of the die: of halves */
  fg_die_value value[FG_DIE_QUANTITIES];
} fg_die_bump;

/* What is said of the whole: of a half, or of the die. */
typedef struct fg_die_side {
  size_t traces;
  fg_die_bump *bumps; /* in order of number; owned */
  size_t bump_count;
  fg_die_value mean[FG_DIE_QUANTITIES];
  fg_die_value overall_radius_mm, overall_error_pct;
} fg_die_side;

typedef struct fg_die {
  fg_design design;
  fg_nominal nominal;
  fg_die_options options;
  fg_die_trace *traces; /* in the order given; owned */
  size_t trace_count;
  fg_die_side half[FG_DIE_HALVES]; /* traces 0: not there */
  fg_die_side whole;
} fg_die;

/* Loads, measures, and brings together. */
fg_status fg_die_measure(fg_context *ctx, const fg_design *design, const fg_die_options *options,
                         const fg_die_source *sources, size_t count, fg_die *die);
void fg_die_free(fg_die *die);

#ifdef __cplusplus
}
#endif
#endif

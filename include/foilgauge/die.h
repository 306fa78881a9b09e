/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A die measured by a stylus: traces x, z of each half against the design of the pressed foil.
 *
 * HALVES. A half is named by its bumps: the concave half has grooves (its lands are a dome) and
 * touches the strip's inner side, the shaft's; the convex half has ridges (its lands are a bowl)
 * and touches the outer side, the sleeve's.
 *
 * THE TIP. A trace is the path of the centre of a tip of radius r (or of its lowest point, lower by
 * r), a line parallel to the surface: its circles have the surface's centres, ridges a radius
 * larger by r, grooves one smaller by r, for bumps and lands alike. The circles are fitted to that
 * line and then corrected by r, so the direction of the surface is not needed.
 *
 * THE DATUM. A half's surface lies half a thickness t from the midline of the strip in the closed
 * die: concave half R + t/2, R0 - t/2; convex half R - t/2, R0 + t/2. All values refer to the
 * design's datum line. A strip of constant thickness pressed between both halves has its midline
 * half way between their surfaces: the die's value is the mean of the halves'.
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

/* Facts of one trace that its file may lack. A fact not stated here is read from the file's header,
 * the half also from its name; a contradiction is an error. */
typedef struct fg_die_source {
  const char *path;
  const char *half;    /* "concave" or "convex"; NULL: not stated */
  fg_die_unit unit[2]; /* of x, z; FG_DIE_UNIT_NONE: not stated */
  size_t column[2];    /* of x, z, from 1; 0: not stated */
  double tip_um;       /* radius of the tip; NaN: not stated; 0: the profile is corrected already */
  bool reversed;       /* bump numbers decrease with x */
  int first_bump;      /* lowest number of the bumps with a visible crown; 0: 1 */
} fg_die_source;

typedef struct fg_die_options {
  double u_tip_um;      /* standard uncertainty of the tip's radius */
  double u_scale_ppm;   /* of the instrument's scale, of x and z alike */
  double max_slope_deg; /* steeper stations are not fitted; 0: the default */
} fg_die_options;

#define FG_DIE_MAX_SLOPE_DEG 77.0

/* Profile of a file, in mm and sorted by x. */
typedef struct fg_die_profile {
  fg_point *points; /* x, z; owned */
  size_t count;
  size_t first_line; /* of the file's data */
  fg_die_half half;
  fg_die_unit unit[2];
  double tip_um;
  char sha256[65];
} fg_die_profile;

/* Reads and checks a file. FG_ERR_DATA names the file, the line and the remedy; FG_ERR_IO. */
fg_status fg_die_profile_load(fg_context *ctx, const fg_die_source *source,
                              fg_die_profile *profile);
void fg_die_profile_free(fg_die_profile *profile);

/* Station of a trace: mean of a few of its points. */
typedef struct fg_die_station {
  double x, z;        /* mm, as traced */
  double residual_um; /* from the circle of its bump or of the lands; NaN: not fitted */
  int bump;           /* number; 0: the lands, -1: neither */
} fg_die_station;

/* Noise along the bumps' arcs, by restricted likelihood (src/die/form_error.h). */
typedef struct fg_die_form_error {
  double sd_mm;       /* of means over a small part of an arc */
  double length_mm;   /* of its correlation: exp(-d/l), where it is `smooth` (1 + d/l + (d/l)²/3)
                         exp(-d/l) */
  double white_share; /* of the variance; the rest is correlated */
  bool smooth;
} fg_die_form_error;

/* One measured trace; lengths refer to the design's datum line, centres to the trace (x, z, mm). */
typedef struct fg_die_trace {
  const char *path; /* not owned */
  char sha256[65];
  fg_die_half half;
  int repeat; /* among its half's traces, from 1 */
  fg_die_unit unit[2];
  double tip_um;
  bool reversed;
  size_t points;           /* of the file */
  double length_mm;        /* along x */
  double step_um;          /* mean distance of its stations */
  double steep_share;      /* share of its stations that are too steep */
  size_t lands, cut_bumps; /* cut: incomplete, at an end or too steep */
  int *lost; /* numbers of bumps that were traced from foot to foot, but whose arc is no circle:
                dust, a burr, a lost contact; among cut_bumps; owned */
  size_t lost_count;
  int last_number;              /* highest number of the bumps with a visible crown */
  double noise_um;              /* sd of the bumps' residuals */
  fg_die_form_error form_error; /* form error: noise model of the residuals */
  double shift_mm;              /* correction of a bump's traced radius for tip and datum */
  fg_overall overall;           /* springback_error_pct is the error with opposite sign */
  fg_bump *bumps;               /* sorted by number; owned */
  size_t bump_count;
  fg_die_station *stations; /* sorted by x; owned */
  size_t station_count;
} fg_die_trace;

/* Measures one profile. FG_ERR_DATA: it is no trace of this design's die (unit, tip, bumps). */
fg_status fg_die_trace_measure(fg_context *ctx, const fg_design *design,
                               const fg_die_options *options, const fg_die_source *source,
                               const fg_die_profile *profile, fg_die_trace *trace);

/* Quantities reported of every bump, and as a mean of each half. */
typedef enum fg_die_quantity {
  FG_DIE_RADIUS,
  FG_DIE_RADIUS_ERROR,
  FG_DIE_ANGLE,
  FG_DIE_ANGLE_ERROR,
  FG_DIE_CENTRE,
  FG_DIE_HEIGHT,
  FG_DIE_INTERSECTION,
  FG_DIE_PLACE, /* angle from the design's position, corrected for the trace's rotation */
  FG_DIE_QUANTITIES
} fg_die_quantity;

typedef struct fg_die_row {
  const char *name, *unit, *symbol, *words;
  int decimals;
} fg_die_row;

const fg_die_row *fg_die_row_of(fg_die_quantity quantity);

/* Returns the design's value. */
double fg_die_nominal(const fg_design *design, const fg_nominal *nominal, fg_die_quantity quantity);

/* Value over repeats: mean, sd of one repeat (NaN for one), standard uncertainty of the mean with
 * the errors common to repeats: form error, tip, scale. For a half or the die, the sd is over
 * bumps. */
typedef struct fg_die_value {
  double value, sd, u;
} fg_die_value;

typedef struct fg_die_bump {
  int number;
  size_t count; /* number of repeats; of the die: of halves */
  fg_die_value value[FG_DIE_QUANTITIES];
} fg_die_bump;

/* Values of a half, or of the die, as a whole. */
typedef struct fg_die_side {
  size_t traces;
  fg_die_bump *bumps; /* sorted by number; owned */
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
  fg_die_side half[FG_DIE_HALVES]; /* traces 0: not measured */
  fg_die_side whole;
} fg_die;

/* Loads all traces, measures them, and combines them. */
fg_status fg_die_measure(fg_context *ctx, const fg_design *design, const fg_die_options *options,
                         const fg_die_source *sources, size_t count, fg_die *die);
void fg_die_free(fg_die *die);

#ifdef __cplusplus
}
#endif
#endif

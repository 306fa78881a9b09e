/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The design of a foil: what the part should be, and the tolerances it is judged by.
 *
 * Lengths are in mm, angles in degrees. Words and equations: thesis chapter 5, eq 5.1 to 5.9.
 * A design file is JSON with "schema": "foilgauge/design/1"; the member names are those below.
 */
#ifndef FOILGAUGE_DESIGN_H
#define FOILGAUGE_DESIGN_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/calibration.h"
#include "foilgauge/gauge.h"
#include "foilgauge/grid.h"
#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum fg_foil_kind {
  FG_FOIL_CLASSICAL,  /* bumps, lands between them, a lip at one end */
  FG_FOIL_SINUSOIDAL, /* long fillets, short lands, no lip */
  FG_FOIL_DISCS,      /* no foil: round holes and discs */
  FG_FOIL_ARC,        /* a plain strip, as a top foil: one circle from end to end, no bumps */
  FG_FOIL_CANTILEVER, /* a flat foil with beams cut out of it, measured before they are bent */
  FG_FOIL_GRID,       /* no foil: a plate or board with marks on a square lattice */
} fg_foil_kind;

/* Up to the last kind: tables of kinds are held against it, so that new kinds stand at the end. */
enum { FG_FOIL_KINDS = FG_FOIL_GRID + 1 };

/* Returns true where foils of this kind have bumps: the design states `bumps`. */
bool fg_foil_kind_has_bumps(fg_foil_kind kind);

/* Line of the strip that the lengths belong to: R, R0 (and so alpha, theta) of the design and of
 * the fits are of this line. X and h do not depend on it: the edges are parallel to the midline, so
 * at a crown R + offset meets R0 - offset and h = R0 - (X - R) keeps its value. R_sleeve is the
 * bore that the lands rest on and t the whole thickness, so the crown's shaft side stands h + t
 * above the bore and eq 5.8 holds as it stands for every datum. Eq 5.5 takes R_sleeve for the
 * radius of the datum line of the lands once the foil is in the bearing. */
typedef enum fg_datum {
  FG_DATUM_MID,   /* the midline */
  FG_DATUM_INNER, /* the edge on the shaft's side */
  FG_DATUM_OUTER, /* the edge on the sleeve's side */
} fg_datum;

/* The stated tone curve, by which a scanner's counts follow the light. */
typedef enum fg_tone_statement {
  FG_TONE_UNKNOWN, /* u of lengths between two edges holds its possible effect */
  FG_TONE_LINEAR,  /* the user vouches that counts are proportional to the light */
} fg_tone_statement;

/* A tolerance: lower <= value <= upper, in the unit of the quantity. Unset limits are -inf, +inf.
 * `quantity` is the JSON name of a reported quantity: of a bump ("height_mm"), or of the whole
 * foil ("overall.radius_mm", "thickness_mm"), or of a lot's bearings ("circularity_mm",
 * "clearance_min_mm", "clearance_centred_min_mm", "clearance_mean_mm", "clearance_max_mm"). In a
 * design file:
 *   "tolerances": { "height_mm": { "min": 0.55, "max": 0.58 }, "radius_error_pct": { "max": 5 } }
 */
typedef struct fg_tolerance {
  char quantity[48];
  double lower, upper;
} fg_tolerance;

/* Position of a value against a limit: the nearest one, or the one that it is farthest beyond. With
 * one limit it is that one. */
typedef struct fg_margin {
  double limit;  /* not finite: there is none */
  double inside; /* distance to the limit; negative: beyond it; NaN without a value */
  bool upper;    /* the limit is the upper one */
} fg_margin;

/* Every distance to a limit is this one. Limits that are not set are -inf, +inf. */
fg_margin fg_margin_to(double lower, double upper, double value);

enum { FG_TOLERANCES_MAX = 32, FG_DIAMETERS_MAX = 256 };

/* Dimensions of a foil with bumps, classical or sinusoidal, and of the bearing it goes into. */
typedef struct fg_design_bumps {
  size_t count;                 /* expected; 0: not stated */
  double radius_mm;             /* R_D */
  double angle_deg;             /* alpha_D */
  double sleeve_radius_mm;      /* R_sleeve; default: overall_radius_mm */
  double pitch_deg;             /* angle from bump to bump about O; default 13 1/3 */
  double fillet_radius_mm;      /* default 0.35 */
  double top_foil_thickness_mm; /* the plain foil between bumps and rotor; 0: none */
  double rotor_diameter_mm;     /* D */
} fg_design_bumps;

/* Dimensions of an arc beside its overall radius. */
typedef struct fg_design_arc {
  double subtended_angle_deg; /* from end to end about its centre */
} fg_design_arc;

/* Dimensions of a cantilever's beams. */
typedef struct fg_design_beams {
  size_t count;               /* expected; 0: not stated */
  double length_mm;           /* L, from the root to the free end */
  double width_mm;            /* w */
  double u_thickness_mm;      /* standard uncertainty of thickness_mm; 0: none stated */
  double sagitta_mm;          /* s_D, of a beam as bent; 0: not stated */
  double elastic_modulus_gpa; /* E; 0: not stated */
  double clearance_mm;        /* C_D of the bearing, which s_D belongs to; 0: not stated */
} fg_design_beams;

/* Known diameters of discs, in any order. */
typedef struct fg_design_discs {
  size_t count;
  double diameters_mm[FG_DIAMETERS_MAX];
  double u_diameters_mm; /* standard uncertainty of each of them; 0: not stated */
} fg_design_discs;

/* Marks of a grid. Without u_pitch_mm nothing is known of the board but its kind: it may be printed
 * with a wrong scale, other along its two axes. */
enum { FG_CERTIFICATE_PATH = 1024 };

typedef struct fg_design_grid {
  fg_mark_kind marks;
  double pitch_mm;   /* from mark to mark; 0: not stated */
  double u_pitch_mm; /* standard uncertainty of the pitch along each axis; 0: not stated */
  double u_place_mm; /* of a mark's place on the lattice, along x and y, independent of others */
  char certificate[FG_CERTIFICATE_PATH]; /* CSV with the place of each mark; "": none */
} fg_design_grid;

/* One of them. */
typedef union fg_design_values {
  fg_design_bumps bumps; /* classical, sinusoidal */
  fg_design_arc arc;
  fg_design_beams beams; /* cantilever */
  fg_design_discs discs;
  fg_design_grid grid;
} fg_design_values;

/* `kind` tells which member of the union is valid: reading another one is an error. Set `kind` with
 * fg_design_become, which fills the union with that kind's defaults. */
typedef struct fg_design {
  char name[64];
  fg_foil_kind kind;
  fg_datum datum;
  double overall_radius_mm;     /* of foils with bumps, as designed, and of arcs; R0_design of
                                   eq e */
  double thickness_mm;          /* t, of every foil */
  double thickness_measured_mm; /* of the strip, by a micrometer, at 20 °C; 0: none stated */
  double u_thickness_measured_mm;
  fg_tone_statement tone; /* stated of the scanner's counts */
  union {
    fg_design_bumps bumps;
    fg_design_arc arc;
    fg_design_beams beams;
    fg_design_discs discs;
    fg_design_grid grid;
    fg_design_values values;
  };
  size_t tolerance_count;
  fg_tolerance tolerances[FG_TOLERANCES_MAX];
  fg_calibration calibration; /* of the scanner that measures it, and the part's temperature */
  fg_artefact artefact;       /* of the known sizes in a design of gauges */
  /* Scale of the scanner's model in use; never read from a design (fg_scanner_model_trace). */
  struct {
    bool known;
    fg_artefact artefact;
  } model_scale;
  size_t gauge_count;
  fg_gauge gauges[FG_GAUGES_MAX]; /* known widths that lie on the glass in the same scan */
} fg_design;

/* Values derived from a design (thesis eq 5.1, 5.2, 5.5, 5.8). */
typedef struct fg_nominal {
  double centre_to_centre_mm;    /* X_D: distance of bump centre from overall centre, from
                                    R_D, alpha_D and the overall radius */
  double half_chord_mm;          /* l0 = R sin(alpha/2), eq 5.2 */
  double arc_length_mm;          /* alpha_D R_D */
  double intersection_angle_deg; /* theta_D */
  double height_mm;              /* h_D = R_D - (X_D - R_sleeve), eq 5.5 */
  double die_height_mm;          /* h_b = t + R - R cos(alpha/2), eq 5.1 */
  double clearance_mm;           /* C_D = R_sleeve - h_D - D/2 - t, eq 5.8, less the top foil */
} fg_nominal;

/* Prediction of a bump by the declared springback model (thesis eq 5.6 and 5.7) from its radius
 * alone: arc length and crown keep their place. */
typedef struct fg_springback {
  double bump_angle_deg;   /* alpha_m = alpha_D R_D / R */
  double bump_angle_slope; /* d alpha_m / dR, degrees per mm */
  double height_mm;        /* h_m = h_D - (R_sleeve - M) */
  double height_slope;     /* d h_m / dR */
  double clearance_mm;     /* eq 5.8 with h_m */
} fg_springback;

/* The Gen II design of thesis table 5.6: R 3.32 mm, alpha 63.15 degrees, overall 20.73 mm,
 * t 0.1 mm, rotor 40 mm, nine bumps, classical, datum mid. */
void fg_design_default(fg_design *design);

/* Makes it a design of another kind: dimensions that the new kind does not have are dropped, those
 * of its own begin at their defaults. FG_ERR_DATA when the design states dimensions that the new
 * kind refuses, such as the subtended angle of an arc. */
fg_status fg_design_become(fg_context *ctx, fg_foil_kind kind, fg_design *design);

/* FG_ERR_DATA when a value is missing, not finite, not positive or contradicts another one (a bump
 * circle that cannot meet the overall circle at alpha, bumps that overlap at this pitch). The
 * message names the member, its value and what would be right. */
fg_status fg_design_check(fg_context *ctx, const fg_design *design);

/* The derived nominal values; checks the design first. All NaN for form discs, and for a cantilever
 * (foilgauge/cantilever.h has its values); of an arc the arc length is that from end to end, and
 * the others are NaN. */
fg_status fg_design_derive(fg_context *ctx, const fg_design *design, fg_nominal *nominal);

/* Clearance over a bump of this height: eq 5.8 less the top foil's thickness, mm, with the design's
 * thickness of the bump foil. */
double fg_design_clearance(const fg_design *design, double height_mm);

/* The same over a strip of another thickness. */
double fg_design_clearance_over(const fg_design *design, double height_mm, double thickness_mm);

/* The declared springback model at a bump radius above 0. */
void fg_design_springback(const fg_design *design, const fg_nominal *nominal, double radius_mm,
                          fg_springback *model);

/* Reads a design from JSON text; members that are absent keep the value `design` has on entry, so
 * fill it with fg_design_default first. Two exceptions guard against a half-written design: of
 * bump_radius_mm, bump_angle_deg, overall_radius_mm and thickness_mm a foil's file states all or
 * none (of an arc overall_radius_mm, subtended_angle_deg and thickness_mm, all of them; of a
 * cantilever beam_length_mm, beam_width_mm and thickness_mm),
 * and sleeve_radius_mm follows an overall_radius_mm that comes without it. Unknown and
 * duplicate members, wrong types, a missing or wrong schema and text after the end are FG_ERR_DATA.
 * `path` is for messages. Checks with fg_design_check; `design` changes on success only. */
fg_status fg_design_parse(fg_context *ctx, const char *path, const char *json, fg_design *design);

/* The same from a file. */
fg_status fg_design_load(fg_context *ctx, const char *path, fg_design *design);

#ifdef __cplusplus
}
#endif
#endif

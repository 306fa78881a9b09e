/* The measured foil: every dimension with its standard uncertainty.
 *
 * Words, symbols and equations: thesis chapter 5 (eq 5.1 to 5.9). Lengths in mm, angles in
 * degrees. u_<name> is the standard uncertainty of <name>: from the residuals with their
 * correlation along the strip, and from what the two edges say against each other. The scanner's
 * own scale error is not in it; NaN where it is not known.
 */
#ifndef FOILGAUGE_FOIL_H
#define FOILGAUGE_FOIL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/circle.h"
#include "foilgauge/design.h"
#include "foilgauge/scan.h"
#include "foilgauge/strip.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What is wrong with, or to be known of, one foil. JSON writes the words in `flags`. */
typedef enum fg_foil_flag {
  FG_FOIL_TOUCHES_BORDER = 1u << 0, /* "touches_border" */
  FG_FOIL_TOUCHES_OTHER = 1u << 1,  /* "touches_other" */
  FG_FOIL_NO_LIP = 1u << 2,         /* "no_lip": bumps are numbered clockwise as seen */
  FG_FOIL_BUMP_COUNT = 1u << 3,     /* "bump_count": not the number the design states */
  FG_FOIL_MISSING_BUMP = 1u << 4,   /* "missing_bump": a place at the pitch is empty */
  FG_FOIL_FEW_LANDS = 1u << 5,      /* "few_lands": the overall circle rests on little */
  FG_FOIL_CLIPPED = 1u << 6,        /* "clipped" */
  FG_FOIL_SIDE_BAND = 1u << 7,      /* "side_band" */
  FG_FOIL_GAP = 1u << 8,            /* "gap" */
  FG_FOIL_ROUGH_EDGE = 1u << 9,     /* "rough_edge": residuals are correlated along the strip */
  FG_FOIL_NOT_MEASURED = 1u << 10,  /* "not_measured": see `error` */
} fg_foil_flag;

typedef enum fg_bump_flag {
  FG_BUMP_CRUSHED = 1u << 0,     /* "crushed": far lower, wider or rounder than its neighbours */
  FG_BUMP_NOT_FITTED = 1u << 1,  /* "not_fitted": values are NaN */
  FG_BUMP_NO_CROSSING = 1u << 2, /* "no_crossing": the two circles do not meet: no angle */
  FG_BUMP_POOR_FIT = 1u << 3,    /* "poor_fit": it is not a circle within the edge noise */
  FG_BUMP_OUTLIERS = 1u << 4,    /* "outliers": burr or dust was down-weighted */
  FG_BUMP_OUT_OF_TOLERANCE = 1u << 5, /* "out_of_tolerance" */
} fg_bump_flag;

typedef struct fg_bump {
  int number;                    /* 1 is next to the lip */
  unsigned flags;                /* fg_bump_flag */
  double radius_mm, u_radius_mm; /* R */
  fg_point centre_mm;            /* C */
  double u_centre_mm[2];
  double centre_to_centre_mm, u_centre_to_centre_mm;       /* X */
  double bump_angle_deg, u_bump_angle_deg;                 /* alpha */
  double intersection_angle_deg, u_intersection_angle_deg; /* theta */
  double height_mm, u_height_mm;                           /* h */
  double clearance_mm, u_clearance_mm;                     /* C_local, eq 5.8 */
  double clearance_error, u_clearance_error;               /* eq 5.9, a ratio */
  double radius_error_pct, u_radius_error_pct;             /* e_R */
  double bump_angle_error_pct, u_bump_angle_error_pct;     /* e_alpha */
  double height_model_mm, u_height_model_mm;               /* eq 5.6, 5.7 */
  double bump_angle_model_deg, u_bump_angle_model_deg;     /* constant arc length */
  double rms_um;                   /* of the datum line's orthogonal residuals */
  size_t points;                   /* datum points in the fit */
  double arc_start_mm, arc_end_mm; /* s of the arc that was used */
  double position_deg;             /* direction of C seen from O, about the scan's x axis */
  /* Lowest and highest value over explanations that a loop could not tell apart; both 0: none. */
  double radius_range_mm[2], height_range_mm[2];
  double covariance[3][3]; /* of (C_x, C_y, R), mm² */
} fg_bump;

typedef struct fg_overall {
  double radius_range_mm[2]; /* as of a bump; both 0: none */
  fg_point centre_mm;        /* O */
  double u_centre_mm[2];
  double radius_mm, u_radius_mm; /* R0 */
  double springback_error_pct, u_springback_error_pct;
  double rms_um;
  size_t points;
  double covariance[3][3]; /* of (O_x, O_y, R0), mm² */
} fg_overall;

/* What a station belongs to. */
typedef enum fg_arc_kind {
  FG_ARC_NONE,
  FG_ARC_LIP,
  FG_ARC_LAND,
  FG_ARC_FILLET,
  FG_ARC_BUMP,
  FG_ARC_END,
} fg_arc_kind;

/* One entry per station of the strip. */
typedef struct fg_station_label {
  fg_arc_kind kind;
  int number;             /* bump or land number; 0 for others */
  bool fitted;            /* it took part in the fit of its circle */
  float residual_um;      /* of the datum line from the fitted circle, outwards positive; NaN */
  float residual_left_um; /* of each edge from the same circle offset by half the thickness */
  float residual_right_um;
} fg_station_label;

typedef enum fg_orientation {
  FG_CLOCKWISE, /* bump numbers rise clockwise as the scan is seen */
  FG_COUNTERCLOCKWISE,
} fg_orientation;

typedef struct fg_foil {
  int number;         /* reading order in the scan, from 1 */
  double place_mm[4]; /* the box that holds it in the scan: x, y, width, height */
  unsigned flags;     /* fg_foil_flag */
  char error[256];    /* why it was not measured; empty when it was */
  fg_orientation orientation;
  double rotation_deg; /* direction of the foil's middle seen from O */
  double thickness_mm, u_thickness_mm;
  fg_overall overall;
  fg_bump *bumps; /* in order of number; owned */
  size_t bump_count;
  fg_strip strip;           /* the edges; owned */
  fg_station_label *labels; /* strip.count entries; owned */
  double noise_um;          /* sd of the midline residuals over all arcs */
  double correlation_mm;    /* integral length of their autocorrelation along the strip */
  double edge_model_um;     /* systematic part: what half-width variation says */
  bool in_tolerance;        /* false when a tolerance of the design is exceeded */
} fg_foil;

/* One station of the turn around a round feature; equal steps of direction. Lengths in mm. */
typedef struct fg_disc_point {
  fg_point at;
  double u;     /* sd of its radius from pixel noise */
  double split; /* half of what its flanks' and its core's pixels differ by; may be NaN */
  double u_split;
  bool used; /* usable */
} fg_disc_point;

/* One round hole or disc (form discs). */
typedef struct fg_disc {
  int number;
  unsigned flags; /* fg_bump_flag */
  bool hole;      /* brighter or darker than what surrounds it is `bright` */
  bool bright;
  fg_point centre_mm;
  double u_centre_mm[2];
  double radius_mm, u_radius_mm;
  double diameter_mm, u_diameter_mm;
  double roundness_um; /* peak to valley of the radial deviation, low-passed at 50
                          undulations per revolution, least-squares circle (ISO 12181: RONt) */
  double u_roundness_um;
  double rms_um;
  double coverage_deg; /* how much of the circumference was usable */
  double blur_um;
  size_t points;
  double covariance[3][3];
  fg_point *edge;     /* owned; `points` long, mm, in order around the circle */
  float *residual_um; /* owned; radial, outwards positive */
  /* Lowest and highest radius over explanations that a loop could not tell apart; both 0: none. */
  double radius_range_mm[2];
  fg_disc_point *stations; /* owned; the edge as it was found, for measuring it again */
  size_t station_count;
  double level_doubt_mm; /* what the level of the edge may move the radius by */
} fg_disc;

/* A measured scan. */
typedef struct fg_measurement {
  char scan[1024]; /* path as given */
  char sha256[65];
  char model_sha256[65]; /* of the scanner's model that corrected it; "": none */
  int64_t width_px, height_px;
  int bit_depth;
  double dpi[2];      /* used, x and y */
  double dpi_file[2]; /* as the file says, before it was snapped; NaN without */
  char format[8];     /* "PNG", "TIFF", "PNM" */
  bool colour;        /* the scan holds colours */
  fg_channel channel; /* what of them was measured */
  char warning[256];  /* what is odd about the file; empty when nothing is */
  fg_design design;
  fg_nominal nominal;
  bool light_on_dark;
  fg_foil *foils; /* owned */
  size_t foil_count;
  fg_disc *discs; /* owned; form discs only */
  size_t disc_count;
  size_t specks; /* objects left alone: dust, scratches, other shapes */
} fg_measurement;

void fg_foil_free(fg_foil *foil); /* what it owns; NULL is fine */
void fg_disc_free(fg_disc *disc); /* likewise */
void fg_measurement_free(fg_measurement *measurement);

/* Recognises lip, lands, bumps and free end of a strip, fits every circle, derives every quantity.
 * Takes over foil->strip (filled by the caller); everything else of `foil` is set. What is wrong
 * with the foil or a bump is a flag, not an error; errors are FG_ERR_MEMORY only. A foil that is
 * the design's in shape but not in size is not measured: its scan's resolution must be wrong. The
 * result does not depend on `threads` (0: all cores). */
fg_status fg_foil_measure(fg_context *ctx, const fg_design *design, unsigned threads,
                          fg_foil *foil);

/* Quantities that follow from the circles (thesis eq 5.3 to 5.9 and the declared springback
 * model). Reads radius_mm, centre_mm and covariance of `bump`, and centre, radius and covariance of
 * `overall`, both of the design's datum line (see fg_datum); the two circles are taken as
 * independent. Fills u_radius_mm, u_centre_mm, position_deg and everything from
 * centre_to_centre_mm to u_bump_angle_model_deg, with uncertainties to first order in the whole
 * covariance. Thickness, rotor and sleeve are the design's, without uncertainty. Sets or clears
 * FG_BUMP_NO_CROSSING: the circles do not cross or only touch; then alpha, theta and e_alpha are
 * NaN and the others stand. A circle that was not fitted (NaN) makes what depends on it NaN. */
void fg_bump_derive(const fg_design *design, const fg_nominal *nominal, const fg_overall *overall,
                    fg_bump *bump);

/* Adds in squares to every uncertainty of a derived bump what a covariance of (X, R, R0), mm², that
 * is not in the circles' own does to it: what was corrected is not known exactly either. */
void fg_bump_widen(const fg_design *design, const fg_nominal *nominal, const fg_overall *overall,
                   double covariance[3][3], fg_bump *bump);

#ifdef __cplusplus
}
#endif
#endif

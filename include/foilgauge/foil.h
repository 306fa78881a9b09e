/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The measured foil: every dimension with its standard uncertainty.
 *
 * Words, symbols and equations: thesis chapter 5 (eq 5.1 to 5.9). Lengths in mm, angles in
 * degrees. u_<name> is the standard uncertainty of <name>: from the residuals with their
 * correlation along the strip, and from the difference between the two edges. The scanner's own
 * scale error is not in it. NaN: not known.
 */
#ifndef FOILGAUGE_FOIL_H
#define FOILGAUGE_FOIL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/cantilever.h"
#include "foilgauge/circle.h"
#include "foilgauge/colour.h"
#include "foilgauge/design.h"
#include "foilgauge/scan.h"
#include "foilgauge/strip.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Defects and conditions of one foil. JSON writes the words in `flags`; the sentences that people
 * read are in words.h. */
typedef enum fg_foil_flag {
  FG_FOIL_TOUCHES_BORDER = 1u << 0,     /* "touches_border" */
  FG_FOIL_TOUCHES_OTHER = 1u << 1,      /* "touches_other" */
  FG_FOIL_NO_LIP = 1u << 2,             /* "no_lip": bumps are numbered clockwise as seen */
  FG_FOIL_BUMP_COUNT = 1u << 3,         /* "bump_count": not the number the design states */
  FG_FOIL_MISSING_BUMP = 1u << 4,       /* "missing_bump": a place at the pitch is empty */
  FG_FOIL_FEW_LANDS = 1u << 5,          /* "few_lands": the overall circle rests on little */
  FG_FOIL_CLIPPED = 1u << 6,            /* "clipped": its edges reach the gray scale's end */
  FG_FOIL_SIDE_BAND = 1u << 7,          /* "side_band": its wall shows beside an edge */
  FG_FOIL_GAP = 1u << 8,                /* "gap": the strip or its edge is not seen somewhere */
  FG_FOIL_ROUGH_EDGE = 1u << 9,         /* "rough_edge": residuals are correlated along the strip */
  FG_FOIL_NOT_MEASURED = 1u << 10,      /* "not_measured": see `error` */
  FG_FOIL_COARSE_RESOLUTION = 1u << 11, /* "coarse_resolution": the edges blur into each other */
  FG_FOIL_NOT_THIS_DESIGN = 1u << 12,   /* "not_this_design": see `error`; the values stand */
  /* "resolution_contradicts_file": the stated resolution is not the file's */
  FG_FOIL_RESOLUTION_CONTRADICTS_FILE = 1u << 13,
  FG_FOIL_UNEQUAL_RESOLUTION = 1u << 14, /* "unequal_resolution": of x and y */
  /* Of kind arc: */
  FG_FOIL_BUMPS_ON_ARC = 1u << 15, /* "bumps_on_arc": a bump or a dent in a plain strip */
  FG_FOIL_LIP = 1u << 16,          /* "lip": an end is bent: there is no angle between ends */
  FG_FOIL_NO_END = 1u << 17,       /* "end_not_found": an end is hidden or torn: no angle */
  FG_FOIL_LOSSY = 1u << 18,        /* "lossy": the scan was compressed with loss */
  /* Of kind cantilever: "beam_count": not the number the design states */
  FG_FOIL_BEAM_COUNT = 1u << 19,
  /* "beyond_model_region": it reaches out of the region where the scanner's model was found */
  FG_FOIL_BEYOND_MODEL_REGION = 1u << 20,
  /* A correction without benefit was left out, see `choice`. */
  FG_FOIL_OVERALL_RADIUS_LEFT = 1u << 21, /* "overall_radius_not_corrected" */
  FG_FOIL_RADIUS_LEFT = 1u << 22,         /* "radius_not_corrected" */
  FG_FOIL_HEIGHT_LEFT = 1u << 23,         /* "height_not_corrected" */
  /* Of kind cantilever: */
  FG_FOIL_MISSING_BEAM = 1u << 24, /* "missing_beam": a place where a beam belongs is empty */
  /* "beam_places_unknown": beams are missing at unknown places: numbers are the order */
  FG_FOIL_BEAM_PLACES_UNKNOWN = 1u << 25,
  /* "thickness_contradicts": the scan's thickness is not the one stated as measured */
  FG_FOIL_THICKNESS_CONTRADICTS = 1u << 26,
  FG_FOIL_OTHER_THICKNESS = 1u << 27, /* "other_thickness": far from the design's */
  FG_FOIL_LAND_DEVIATES = 1u << 28,   /* "land_deviates": a dent, a crease or a jump in a land */
} fg_foil_flag;

typedef enum fg_bump_flag {
  FG_BUMP_CRUSHED = 1u << 0,          /* "crushed": far lower, wider or rounder than a sound bump */
  FG_BUMP_NOT_FITTED = 1u << 1,       /* "not_fitted": values are NaN */
  FG_BUMP_NO_CROSSING = 1u << 2,      /* "no_crossing": the two circles do not meet: no angle */
  FG_BUMP_POOR_FIT = 1u << 3,         /* "poor_fit": it is not a circle within the edge noise */
  FG_BUMP_OUTLIERS = 1u << 4,         /* "outliers": burr or dust was down-weighted */
  FG_BUMP_OUT_OF_TOLERANCE = 1u << 5, /* "out_of_tolerance": reports only, fg_bump_flags */
  FG_BUMP_DISTURBED_EDGE = 1u << 6,   /* "disturbed_edge": dust or a burr hides part of its arc */
  FG_BUMP_GAP = 1u << 7,              /* "gap": the strip is cut within its arc */
  FG_BUMP_TOUCHES_OTHER = 1u << 8,    /* "touches_other": something lies on its arc or beside it */
  FG_BUMP_LOSSY = 1u << 9,            /* "lossy": of discs, as of foils */
  FG_BUMP_BEYOND_MODEL_REGION = 1u << 20, /* "beyond_model_region": of discs, as of foils */
} fg_bump_flag;

/* A strip's thickness and its standard uncertainty. Where an edge is the datum, an error of the
 * edges' level moves it, too: outwards by `edge_mm` where the thickness grows by twice that
 * (`with_edge`; a stated thickness does not). Inner edges move towards the overall centre: R grows
 * and R0 shrinks; of outer edges it is the other way round. */
typedef struct fg_thickness {
  double mm, u_mm;
  double edge_mm; /* one standard deviation; 0: the datum is the midline */
  bool inner, with_edge;
} fg_thickness;

/* Moves of every value that has an uncertainty, by one standard deviation of each error of a
 * calibration (calibration.h), in the order of the rows of quantities (quantity.h), two of a pair.
 * u_ includes them already. The errors are the same in every foil of a scanner. */
enum { FG_CALIBRATED_MAX = 16 }; /* of the owner with most; unit.test_quantity checks it */
typedef struct fg_calibrated {
  double move[FG_CALIBRATION_SOURCES][FG_CALIBRATED_MAX];
} fg_calibrated;

/* Form error: peak-to-valley deviation of the part from its least-squares circle (ISO 12181), as a
 * loop finds it. NaN with a range: the edges do not tell the part's deviation from the scanner's;
 * NaN without: too little of the arc is seen; all 0: nothing was looked for. */
typedef struct fg_form_error {
  double um, u_um;
  double range_um[2];
} fg_form_error;

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
  double clearance_mm, u_clearance_mm;                     /* C_local, eq 5.8, less the top foil */
  double clearance_error, u_clearance_error;               /* eq 5.9, a ratio */
  double height_fitted_mm, u_height_fitted_mm;             /* h in the sleeve, see below */
  double clearance_fitted_mm, u_clearance_fitted_mm;       /* eq 5.8 with it */
  double radius_error_pct, u_radius_error_pct;             /* e_R */
  double bump_angle_error_pct, u_bump_angle_error_pct;     /* e_alpha */
  /* 100 (theta - theta_D) / theta_D */
  double intersection_angle_error_pct, u_intersection_angle_error_pct;
  double height_model_mm, u_height_model_mm;           /* eq 5.6, 5.7 */
  double bump_angle_model_deg, u_bump_angle_model_deg; /* constant arc length */
  double rms_um;                   /* of the datum line's orthogonal residuals */
  size_t points;                   /* datum points in the fit */
  double arc_start_mm, arc_end_mm; /* s of the used arc */
  double position_deg;             /* direction of C seen from O, about the scan's x axis */
  /* Min and max value over explanations that a loop could not tell apart; both 0: none. */
  double radius_range_mm[2], height_range_mm[2];
  fg_form_error form_error;
  double covariance[3][3]; /* of (C_x, C_y, R), mm² */
  fg_calibrated calibrated;
} fg_bump;

typedef struct fg_overall {
  double radius_range_mm[2]; /* as of a bump; both 0: none */
  fg_form_error form_error;  /* of the lands */
  fg_point centre_mm;        /* O */
  double u_centre_mm[2];
  double radius_mm, u_radius_mm; /* R0 */
  double springback_error_pct, u_springback_error_pct;
  double rms_um;
  size_t points;
  double covariance[3][3]; /* of (O_x, O_y, R0), mm² */
} fg_overall;

/* Values of a plain strip, kind arc; NaN where an end is not seen, and of other kinds. Angle and
 * length are between the cuts, on the datum line. An opened foil has an angle error below 0. */
typedef struct fg_foil_arc {
  double subtended_angle_deg, u_subtended_angle_deg;
  double subtended_angle_error_pct, u_subtended_angle_error_pct; /* 100 (actual - design)/design */
  double length_mm, u_length_mm;
} fg_foil_arc;

/* Part of the foil at a station. */
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
  bool fitted;            /* it is in the fit of its circle */
  float residual_um;      /* of the datum line from the fitted circle, outwards positive; NaN */
  float residual_left_um; /* of each edge from the same circle offset by half the thickness */
  float residual_right_um;
} fg_station_label;

/* Correction of one foil by a scanner's model: corrected minus as scanned. u_ is its addition, in
 * squares, to the u_ of that value. Of radius and height the largest of all bumps. NaN: nothing was
 * corrected. */
typedef struct fg_correction {
  double overall_radius_mm, u_overall_radius_mm;
  double radius_mm, u_radius_mm;
  double height_mm, u_height_mm;
} fg_correction;

/* Dimensions that a correction is decided for, each over all bumps of a foil, by the expected error
 * with and without it (src/scan_loop/benefit.h). Other reported values follow from them. */
typedef enum fg_corrected {
  FG_CORRECTED_OVERALL_RADIUS,
  FG_CORRECTED_RADIUS,
  FG_CORRECTED_HEIGHT,
  FG_CORRECTED
} fg_corrected;

typedef enum fg_correction_reason {
  FG_CORRECTION_NONE,     /* there was no correction */
  FG_CORRECTION_HELPS,    /* it removes more error than it adds */
  FG_CORRECTION_SMALL,    /* far below the value's own u: it follows the others */
  FG_CORRECTION_DOUBTFUL, /* it would add more error than it removes */
  FG_CORRECTION_TIED,     /* explanations that cannot be told apart disagree about it */
  FG_CORRECTION_LOST,     /* the corrected edges do not show the same bumps */
} fg_correction_reason;

/* A possible correction, rms over the bumps (R0: with its sign), and the decision. */
typedef struct fg_correction_choice {
  fg_correction_reason reason;
  bool moved;
  double move_mm, u_move_mm;
} fg_correction_choice;

/* One station of the turn around a round feature, in equal steps of direction, or of a beam's side,
 * in equal steps of length. Lengths in mm. */
typedef struct fg_disc_point {
  fg_point at;
  double u;     /* sd of its place across the edge from pixel noise */
  double split; /* half of the difference between its flanks' and its core's pixels; may be NaN */
  double u_split;
  bool used; /* usable */
} fg_disc_point;

/* A BEAM of a flat foil (kind cantilever) is a tongue of material that is free at one end: two long
 * edges that face each other across it, joined at the tip by a straight edge across. It may stand
 * out from a common base, as the tooth of a comb, or lie inside a sheet, cut free by a slit. Every
 * edge lies where the scan's light is halfway between both sides. Its line is fitted to all of it
 * but the rounding at corners and fillets.
 *
 *   axis         runs midway between the lines of the two long edges, from the root to the tip
 *   floor        the end of the cut beside a long edge: its place is the middle of its fitted line,
 *                or, where it is round, the apex of its circle: the point that is farthest from the
 *                tip
 *   root line    joins the floors' places on both sides; where there is a floor on one side only
 *                (the outermost beams of a comb: flag "one_floor") it is at right angles to the
 *                axis, through that floor's place
 *   length       along the axis, from the root line to the tip's line
 *   width        across the axis, between the two long edges' lines, halfway along the length
 *   taper        how much wider the beam is per length towards the root; below 0: narrower
 *   bow          how far its middle lies to one side of the chord of its ends, in the sheet's
 * plane, by the parabola that fits both long edges; above 0: to the right, the tip up
 *
 * Beams that point the same way within 45 degrees are numbered from left to right, as the scan is
 * seen when it is turned so that their tips point up, row by row from the top; others clockwise
 * about the middle of them all, starting after the widest gap. A foil that is turned over has them
 * the other way round. Where there are fewer beams than the design states, numbers follow places: a
 * place at the pitch that is empty leaves its number out, and so does one at an end, told by the
 * middle of the foil's box; around a ring the order starts after the one gap that leaves as many
 * places as beams. Where that does not tell (FG_FOIL_BEAM_PLACES_UNKNOWN), numbers are the order
 * alone. */
typedef enum fg_beam_side {
  FG_BEAM_LEFT, /* as seen with the tip up */
  FG_BEAM_RIGHT,
  FG_BEAM_TIP,
  FG_BEAM_ROOT_LEFT, /* the floors */
  FG_BEAM_ROOT_RIGHT,
  FG_BEAM_SIDES
} fg_beam_side;

typedef enum fg_beam_flag {
  FG_BEAM_NOT_FITTED = 1u << 0,       /* "not_fitted": a long edge is not visible */
  FG_BEAM_TORN_TIP = 1u << 1,         /* "torn_tip": its end is not straight: no length */
  FG_BEAM_NO_FLOOR = 1u << 2,         /* "no_floor": no edge where its root should be: no length */
  FG_BEAM_ONE_FLOOR = 1u << 3,        /* "one_floor": the root is seen on one side only */
  FG_BEAM_BENT = 1u << 4,             /* "bent": it bows in the sheet's plane */
  FG_BEAM_OUT_OF_TOLERANCE = 1u << 5, /* "out_of_tolerance": reports only, fg_beam_flags */
  FG_BEAM_OUTLIERS = 1u << 6,         /* "outliers": burr or dust was left out */
  FG_BEAM_DISTURBED_EDGE = 1u << 7,   /* "disturbed_edge": part of an edge is not visible */
  FG_BEAM_TOUCHES_BORDER = 1u << 8,   /* "touches_border": of the scan */
  FG_BEAM_NARROW_CUT = 1u << 9,       /* "narrow_cut": the edges of the cut blur into each other */
} fg_beam_flag;

/* One edge of a beam as found, for measuring it again. */
typedef struct fg_beam_edge {
  fg_disc_point *stations; /* in order, the material to the right as seen; owned */
  size_t count;
  bool round;           /* an arc about the apex of a floor */
  double radius_mm;     /* of the arc, about */
  double blur_mm;       /* of the scan, there */
  double row_mm;        /* height of a row of the scan; 0: not known */
  double u_mm_of_level; /* u of its place by the level of the edge */
  double u_mm_of_next;  /* u by the blur of the cut's other side; the level's is apart from it */
  double split_mm; /* difference between its flanks and its core, beyond chance; towards the void */
  double loss_share;  /* share by which JPEG's steps raise the variance of the edge */
  double shape_ratio; /* by which the levels and the blur, fitted to the same pixels, raise the
                         variance of its mean place */
} fg_beam_edge;

typedef struct fg_beam {
  int number;
  unsigned flags; /* fg_beam_flag */
  double length_mm, u_length_mm;
  double width_mm, u_width_mm;
  double length_error_pct, u_length_error_pct; /* 100 (actual - design) / design */
  double width_error_pct, u_width_error_pct;
  double taper_um_per_mm, u_taper_um_per_mm;
  double bow_um, u_bow_um;
  fg_cantilever follows;    /* derived from length and width; NaN without them */
  double direction_deg;     /* of the axis, about the scan's x axis */
  double rms_um;            /* of the edges about their lines */
  size_t points;            /* in the fits of the two long edges */
  fg_point root_mm, tip_mm; /* the ends of the axis */
  fg_point
      corners_mm[4]; /* left at the root, left at the tip, right at the tip, right at the root */
  fg_beam_edge edges[FG_BEAM_SIDES]; /* count 0: not there */
  fg_picture_state picture;          /* beside its edges */
  fg_calibrated calibrated;
} fg_beam;

typedef enum fg_orientation {
  FG_CLOCKWISE, /* bump numbers rise clockwise as the scan is seen */
  FG_COUNTERCLOCKWISE,
} fg_orientation;

/* The thickness in force is the one stated from a micrometer, else the scan's. */
typedef struct fg_foil_thickness_values {
  double mm, u_mm; /* in force */
  double scan_mm, u_scan_mm;
  double
      u_tone_mm; /* part of u_scan_mm by the level of the edges: common to all foils of a scanner */
} fg_foil_thickness_values;

/* Scatter of a foil's edges about its circles. */
typedef struct fg_foil_noise {
  double sd_um;          /* of the midline residuals over all arcs */
  double correlation_mm; /* integral length of their autocorrelation along the strip */
  double edge_model_um;  /* systematic part, by the variation of the half width */
  double edge_rough_um;  /* kind arc: sd of one edge beyond its pixels' noise */
} fg_foil_noise;

typedef struct fg_foil {
  int number;         /* reading order in the scan, from 1 */
  double place_mm[4]; /* its box in the scan: x, y, width, height */
  unsigned flags;     /* fg_foil_flag */
  char error[256]; /* reason why it was not measured as a foil of the design; empty when it was */
  fg_orientation orientation;
  double rotation_deg; /* direction of the foil's middle seen from O */
  fg_foil_thickness_values thickness;
  fg_overall overall;
  fg_foil_arc arc;
  fg_bump *bumps; /* in order of number; owned */
  size_t bump_count;
  fg_beam *beams; /* kind cantilever: in order of number; owned, and their edges */
  size_t beam_count;
  fg_strip strip;           /* the edges; owned; kind cantilever: its box alone */
  fg_station_label *labels; /* strip.count entries; owned */
  fg_foil_noise noise;
  fg_correction correction; /* by a scanner's model */
  /* By a scanner's model or a loop: the corrections made, and those left out. */
  fg_correction_choice choice[FG_CORRECTED];
  fg_calibrated calibrated;
} fg_foil;

/* One round hole or disc (kind discs). */
typedef struct fg_disc {
  int number;
  unsigned flags; /* fg_bump_flag */
  bool hole;      /* brighter or darker than its surroundings is `bright` */
  bool bright;
  fg_point centre_mm;
  double u_centre_mm[2];
  double radius_mm, u_radius_mm;
  double diameter_mm, u_diameter_mm;
  double roundness_um; /* peak to valley of the radial deviation, low-passed at 50
                          undulations per revolution, least-squares circle (ISO 12181: RONt) */
  double u_roundness_um;
  double rms_um;
  double coverage_deg; /* usable part of the circumference */
  double blur_um;
  size_t points;
  double covariance[3][3];
  fg_point *edge;     /* owned; `points` long, mm, in order around the circle */
  float *residual_um; /* owned; radial, outwards positive */
  /* As in fg_correction. */
  double radius_correction_mm, u_radius_correction_mm;
  fg_correction_choice choice; /* over all discs of the scan: of the radius */
  /* Min and max radius over explanations that a loop could not tell apart; both 0: none. */
  double radius_range_mm[2];
  fg_disc_point *stations; /* owned; the edge as found, for measuring it again */
  size_t station_count;
  double loss_variance;        /* share by which JPEG's steps raise the variance of the edge */
  double edge_u_mm;            /* uncertainty of its level by the edge's own pixels */
  double level_u_mm;           /* uncertainty of the radius by the level of the edge, all sources */
  double spread_px, asymmetry; /* of its edge, see vision/edge_spread.h; NaN: not seen */
  double plain_mm, plain_blur_um; /* diameter and blur with counts used as light */
  double contrast;                /* bright minus dark, counts of 255 */
  fg_picture_state picture;       /* beside its edge */
  fg_calibrated calibrated;
} fg_disc;

/* A measured scan. */
typedef struct fg_measurement {
  char scan[1024]; /* path as given */
  char sha256[65];
  char date[11];         /* local, of the file's last change, "2026-11-20"; "": not known */
  char model_sha256[65]; /* of the scanner's model that corrected it; "": none */
  const struct fg_scanner_model *model; /* the model; not owned; NULL: none */
  fg_scan_info file; /* size, format, resolution as the file states it, measured channel */
  double dpi[2];     /* used, x and y: as stated, over the length factor of the calibration */
  fg_colour_lines colour_lines;
  fg_picture_state picture;               /* worst of all measured parts */
  fg_gauge_reading gauges[FG_GAUGES_MAX]; /* in the order of the design's */
  char tone_note[300];    /* reason why the level of a scanner's model was not applied; "": none */
  bool gauges_contradict; /* they differ by more than their u: the level's u holds it */
  char warning[256];      /* oddities of the scan; empty: none */
  fg_design design;
  fg_nominal nominal;
  bool light_on_dark;
  fg_foil *foils; /* owned */
  size_t foil_count;
  fg_disc *discs; /* owned; kind discs only */
  size_t disc_count;
  fg_grid *grid;   /* owned; kind grid only, else NULL */
  size_t specks;   /* ignored objects: dust, scratches, other shapes */
  bool calibrated; /* u_ includes the uncertainty of the design's calibration */
} fg_measurement;

/* Size of the scan in x and y. */
void fg_measurement_size_mm(const fg_measurement *measurement, double size_mm[2]);

/* Returns true when it was measured, and as a foil of its design: values may be judged and enter
 * statistics. */
bool fg_foil_is_measured(const fg_foil *foil);

/* Flags a foil that could not be measured, with the reason; its values become NaN. */
void fg_foil_give_up(fg_foil *foil, const char *why);

/* The thickness in force: stated as measured, else the scan's, the design's (u 0) where the scan
 * shows none. */
fg_thickness fg_foil_thickness(const fg_design *design, const fg_foil *foil);

/* Returns true when it differs from the design's by more than U: then reports state both. */
bool fg_thickness_differs(const fg_design *design, const fg_thickness *strip);

void fg_foil_free(fg_foil *foil); /* frees its members; NULL is fine */
void fg_disc_free(fg_disc *disc); /* likewise */
void fg_beam_free(fg_beam *beam); /* likewise */
void fg_measurement_free(fg_measurement *measurement);

/* Recognises lip, lands, bumps and free end of a strip, fits every circle, derives every quantity.
 * foil->strip is the input; everything else of `foil` is set. Defects of the foil or a bump are
 * flags, not errors; errors are FG_ERR_MEMORY only. A foil that has the design's shape but not its
 * size is not measured: its scan's resolution must be wrong. A foil beyond all springback and
 * damage, or whose bumps may be those of a part that touches it, keeps its values, flagged
 * FG_FOIL_NOT_THIS_DESIGN. The result does not depend on `threads` (0: all cores). */
fg_status fg_foil_measure(fg_context *ctx, const fg_design *design, unsigned threads,
                          fg_foil *foil);

/* Fits the lines of every beam of a foil of kind cantilever to its edges, whose stations the caller
 * filled, and derives every quantity. Numbers the beams and puts them in order. Sets their flags
 * but for FG_BEAM_TOUCHES_BORDER and FG_BEAM_NARROW_CUT. Sets rotation_deg (of the beams' common
 * direction; NaN where they have none), noise_um, correlation_mm, FG_FOIL_BEAM_COUNT,
 * FG_FOIL_MISSING_BEAM, FG_FOIL_BEAM_PLACES_UNKNOWN and FG_FOIL_ROUGH_EDGE of the foil. Its
 * place_mm decides which beams are missing at an end. FG_ERR_MEMORY. */
fg_status fg_beams_measure(fg_context *ctx, const fg_design *design, fg_foil *foil);

/* FREE AND FITTED. A scan shows the foil free: height_mm, clearance_mm (eq 5.8) and clearance_error
 * are those of the free foil, on its own overall circle R0. In the bearing the lands are pressed
 * against the sleeve. A bump keeps its radius R and the chord between its feet, l0 = R sin phi with
 * phi = alpha / 2 (eq 5.2), but the circle under the chord is now the sleeve's, R_s:
 *   h_fitted = R (1 - cos phi) + R_s - sqrt(R_s² - l0²)    (height_fitted_mm)
 *   C_fitted = R_s - h_fitted - D/2 - t                    (clearance_fitted_mm)
 * At R0 = R_s it is the free foil's height. Without a crossing there is no chord: NaN.
 *
 * The height of the springback model (height_model_mm) comes from R alone. With measured X, R and
 * alpha eq 5.6 is an identity: alpha is defined by the crossing with the overall circle, so M is R0
 * itself, whatever the bump. Only predicted X_m and alpha_m make it a statement about the part. */

/* Derives the quantities that follow from the circles (thesis eq 5.3 to 5.9 and the declared
 * springback model). Reads radius_mm, centre_mm and covariance of `bump`, and centre, radius and
 * covariance of `overall`, both of the design's datum line (see fg_datum); the two circles are
 * independent. Fills u_radius_mm, u_centre_mm, position_deg and everything from centre_to_centre_mm
 * to u_bump_angle_model_deg, with uncertainties to first order in the whole covariance. `strip` is
 * the thickness t of eq 5.8, independent of the circles; rotor and sleeve are the design's, without
 * uncertainty, and so is C_D. Sets or clears FG_BUMP_NO_CROSSING: the circles do not cross or only
 * touch; then alpha, theta and e_alpha are NaN and the others stand. A circle that was not fitted
 * (NaN) makes its dependents NaN. */
void fg_bump_derive(const fg_design *design, const fg_nominal *nominal, const fg_overall *overall,
                    const fg_thickness *strip, fg_bump *bump);

/* Adds to every uncertainty of a derived bump, in squares, the contribution of a covariance of (X,
 * R, R0), mm², that is not in the circles' own: the uncertainty of a correction. Values stay,
 * whatever the strip's thickness. */
void fg_bump_widen(const fg_design *design, const fg_nominal *nominal, const fg_overall *overall,
                   double covariance[3][3], fg_bump *bump);

#ifdef __cplusplus
}
#endif
#endif

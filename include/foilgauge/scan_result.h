/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the loop on scans came to, decided: numbers, words and points to draw. JSON, text and page
 * say what stands here and decide nothing; whoever uses the library can do the same.
 *
 * Everything belongs to the loop that it is of and lives as long as that.
 */
#ifndef FOILGAUGE_SCAN_RESULT_H
#define FOILGAUGE_SCAN_RESULT_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/circle.h"
#include "foilgauge/loop.h"
#include "foilgauge/measure.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
  FG_SCAN_RESULT_CLAIMS = 15,
  FG_SCAN_RESULT_EXPLANATIONS = 16,
  FG_SCAN_RESULT_UNCLAIMED = 60,
  FG_SCAN_RESULT_PARAMETERS = 4,
  FG_SCAN_RESULT_ADVICE = 3,
  FG_SCAN_RESULT_WORDS = 512,
  FG_SCAN_RESULT_SAMPLES = 241,     /* of a curve that is drawn */
  FG_SCAN_RESULT_GRID_SAMPLES = 61, /* of a line of the picture's grid */
};

/* What effects live on and residuals are drawn over. */
typedef enum fg_scan_coordinate {
  FG_SCAN_X, /* mm of the scan */
  FG_SCAN_Y,
  FG_SCAN_FOIL,   /* along the foil, mm from the lip's side */
  FG_SCAN_PHI,    /* place in the bump's arc, -1 to 1 */
  FG_SCAN_INDEX,  /* number of the bump, with less than half a one to either side for the place in
                     its arc */
  FG_SCAN_NORMAL, /* direction of the edge's outward normal, degrees */
  FG_SCAN_COORDINATES
} fg_scan_coordinate;

/* What the held-out error is of. */
typedef enum fg_scan_held_out {
  FG_SCAN_HELD_OUT_NOTHING, /* nothing was found: it is the rms; or too few bumps to keep some
                               aside: it is NaN */
  FG_SCAN_HELD_OUT_SCANS,   /* scans kept aside */
  /* Cross-fitted: bumps (discs; of a curve over places or a step short stretches of the edge) in
   * folds, and the search repeated without each. Before, nothing but the geometry is fitted, as to
   * all rows. */
  FG_SCAN_HELD_OUT_FOLDS
} fg_scan_held_out;

/* Errors of the points, um. */
typedef struct fg_scan_loop_error {
  double rms, robust_sd, p95, maximum, held_out_rms;
} fg_scan_loop_error;

/* Noise of an edge row, um: white, and what neighbours along the edge share (Patterson and Thompson
 * 1971: restricted likelihood). Every sum of squares was judged by it. */
typedef struct fg_scan_noise {
  const char *model; /* "white": rows are independent. Else how the correlation falls with the
                       distance d: "gaussian": exp(-(d / range)²), "exponential": exp(-d / range) */
  double sd_um;      /* of a row: the root of the squares of the two that follow */
  double white_um, correlated_um;
  double correlation; /* share of the variance that rows next to each other have in common */
  double range_mm;
  double long_waves; /* variance of waves of half a millimetre over what the form says of them */
  double *disc_um;   /* sd of a row of every disc, which has its own; in the scans' order */
  size_t discs;
} fg_scan_noise;

/* One number of an effect: as JSON has it, and as people read it (a ratio in ppm; what leads an
 * effect with its sign). */
typedef struct fg_scan_result_parameter {
  const char *name; /* "amplitude_um", "value", "period_mm" */
  double value, u;
  const char *symbol, *unit;
  double told, u_told;
} fg_scan_result_parameter;

/* What the colour lines say of an effect of the carriage: between the channels of one scan neither
 * part nor optics shows, but the carriage does. */
typedef enum fg_channel_check_verdict {
  FG_CHANNEL_CHECK_NONE,        /* not the carriage's, or no colour scan */
  FG_CHANNEL_CHECK_FOR,         /* "for" */
  FG_CHANNEL_CHECK_AGAINST,     /* "against" */
  FG_CHANNEL_CHECK_CANNOT_TELL, /* "cannot_tell" */
} fg_channel_check_verdict;

typedef struct fg_channel_check {
  fg_channel_check_verdict verdict;
  const char *reason; /* in words */
  double p_value;     /* that lines which show nothing of it look like that */
  double p_against;   /* the same of lines that show it as it is claimed; NaN: gaps not known */
  double factor, u_factor; /* what they show over what they must; without known gaps 1 and NaN */
  double expected_um;      /* rms of what they must show, about its mean */
  double gap_px[3];        /* of red, green, blue: as stated, or what fits best; NaN: none */
  bool gap_stated;
} fg_channel_check;

/* An effect that is in the corrected model. */
typedef struct fg_scan_result_claim {
  const char *id, *direction; /* form: "normal", "radial"; NULL: it has one only */
  const char *words, *equation;
  const char *says; /* what its sign means; NULL: its words say all */
  bool of_width;    /* of the strip's width: residual and dimensions are without it */
  bool free;        /* a curve that no listed effect explains */
  bool sure;        /* every explanation that the data allow holds it */
  fg_loop_verdict verdict;
  fg_scan_coordinate coordinate; /* of curves, and of what the part does */
  const char *coordinate_name;   /* "foil.s" */
  const char *moves;             /* of a curve, in a word */
  const char *basis;             /* what its shape is about; NULL: its numbers say all */
  fg_scan_result_parameter parameter[FG_SCAN_RESULT_PARAMETERS];
  size_t parameters;
  double amplitude_um;
  double p_value;        /* that it, or no effect at all, is needed */
  double retained_share; /* of it beside the geometry; NaN: was not searched */
  double would_explain;  /* share of the residual sum, or of the widths', that it alone takes;
                            likewise */
  double (*shape)[2];    /* coordinate and deviation in um, of curves and of what has a basis */
  size_t shape_points;
  fg_channel_check channel_check;
} fg_scan_result_claim;

/* One of several sets of effects that explain. */
typedef struct fg_scan_result_explanation {
  char name[FG_SCAN_RESULT_WORDS];  /* "scan.scale_y + part.ovality" */
  char words[FG_SCAN_RESULT_WORDS]; /* what it has of its own, for people */
} fg_scan_result_explanation;

/* An effect that is not claimed. `tied`: one of several explanations holds it. */
typedef struct fg_scan_result_unclaimed {
  const char *id, *words;
  bool of_width;
  fg_loop_verdict verdict;
  double would_explain, retained_share;
  double smallest_um; /* would have shown; NaN: no size would */
  bool barred;        /* seen, and not confirmed from disc to disc */
} fg_scan_result_unclaimed;

typedef struct fg_scan_result_scan {
  const fg_measurement *before, *after;
  bool hold_out; /* it only confirms */
} fg_scan_result_scan;

/* What the rows are of: a foil or a disc on a scan. */
typedef struct fg_scan_result_view {
  size_t scan;
  const fg_foil *foil; /* NULL: a disc */
  size_t bumps;        /* of the part */
} fg_scan_result_view;

/* A mean of neighbouring stations, and how far it lies from its circle. */
typedef struct fg_scan_result_row {
  size_t scan;
  size_t arc;                        /* neighbours on one edge without a gap */
  int bump;                          /* number; 0: a land or a disc */
  fg_point at_mm;                    /* measured */
  fg_point ideal_mm;                 /* on its circle */
  fg_point normal;                   /* outwards from the circle's centre */
  double place[FG_SCAN_COORDINATES]; /* NaN: it has none */
  double weight;                     /* stations in the mean; 0: an outlier, which is left out */
  double residual_um[2];             /* before, after; outwards positive */
} fg_scan_result_row;

/* Sum of the effects on one coordinate, to be drawn. */
typedef struct fg_scan_result_line {
  fg_scan_coordinate coordinate;
  bool glass; /* a displacement of the picture; else the part's deviation */
  char axis;  /* 'x', 'y': of a displacement */
  bool free;  /* a free curve of the part is in it: without what circles take over */
  double x[FG_SCAN_RESULT_SAMPLES]; /* over the foil: degrees about O from its middle */
  double um[FG_SCAN_RESULT_SAMPLES];
  double expanded_um[FG_SCAN_RESULT_SAMPLES]; /* U = 2u; NaN: not known */
} fg_scan_result_line;

/* One line of the picture's grid, and where its points really lie. */
typedef struct fg_scan_result_grid_line {
  int axis; /* 0: at an x, 1: at a y */
  fg_point at_mm[FG_SCAN_RESULT_GRID_SAMPLES], move_mm[FG_SCAN_RESULT_GRID_SAMPLES];
} fg_scan_result_grid_line;

typedef struct fg_scan_result_grid {
  fg_scan_result_grid_line *line; /* as dense as shows what moves them */
  size_t lines;                   /* 0: nothing moves the picture */
  double low_mm[2], high_mm[2];   /* of the picture */
  double cell_mm;                 /* between lines, at most */
  double largest_mm;              /* displacement */
  double period_mm;               /* of the shortest ripple; infinite: none */
} fg_scan_result_grid;

/* ---- the bumps against the declared springback, or against what a forming predicts ---- */

enum { FG_SCAN_RESULT_RESPONSES = 2 };

/* In the response's `unit`. */
typedef struct fg_scan_result_bump_claim {
  const char *id, *words;
  fg_loop_verdict verdict; /* found or tied */
  const char *parameter_name[2];
  double parameter[2], parameter_u[2];
  size_t parameters;
  double amplitude, u_amplitude; /* half the range over the bumps */
  double p_value, retained_share;
  struct {
    char name[2 * FG_LOOP_NAME]; /* "part.stretch(constant)" */
    char id[2 * FG_LOOP_NAME];   /* a sum keeps its words */
  } tied[FG_LOOP_ALIASES];       /* does as well */
  size_t ties;
} fg_scan_result_bump_claim;

typedef struct fg_scan_result_bump_unclaimed {
  const char *id, *words;
  fg_loop_verdict verdict;
  double would_explain, p_value, retained_share;
  double smallest; /* would have shown, the response's `unit`; NaN: none would */
} fg_scan_result_bump_unclaimed;

typedef struct fg_scan_result_bump {
  size_t part;
  int number;
  bool held_out;
  double before, after; /* off the model, the response's `unit` */
  double effect;        /* what was found, there */
} fg_scan_result_bump;

/* rms about the declared model, without and with what was found; NaN: not judged. */
typedef struct fg_scan_result_bump_error {
  double rms[2], held_out_rms[2];
} fg_scan_result_bump_error;

typedef struct fg_scan_result_response {
  const char *name, *words; /* "bump_radius_mm", "bump radius" */
  const char *unit, *model; /* of everything here; what is held against */
  bool judged;
  fg_scan_result_bump_claim claim[FG_LOOP_CLAIMS];
  size_t claims;
  fg_scan_result_bump_unclaimed *unclaimed;
  size_t unclaimeds;
  fg_scan_result_bump *bump; /* NULL: not judged */
  size_t bumps;
  bool has_curve; /* over the bump's number, which nothing listed explains */
  double (*curve)[2];
  size_t curve_points;
  double curve_rms, curve_p;
  const char **nearest; /* effects that come near the curve */
  size_t nearests;
  fg_scan_result_bump_error error;
  /* Mean of measured minus declared, which the errors are without; NaN: the model has no level. */
  double level, u_level;
} fg_scan_result_response;

typedef struct fg_scan_result_bumps {
  size_t count, held_out, parts;               /* bumps that are judged, and kept aside; foils */
  bool lip;                                    /* their numbers count from a lip */
  const char *coordinate_name;                 /* of those numbers */
  const char *declared_path, *declared_sha256; /* of the forming; NULL: the design's springback */
  fg_scan_result_response response[FG_SCAN_RESULT_RESPONSES];
  fg_scan_result_bump_error height_um;  /* follows from both */
  const fg_scan_result_response *curve; /* of which a curve is told; NULL: none */
} fg_scan_result_bumps;

/* ---- everything ---- */

typedef struct fg_scan_result {
  fg_loop_outcome verdict;
  bool same_foil, discs;
  bool tied;         /* several explanations */
  bool named;        /* what was found has a name: no two explanations differ in more than a form */
  bool scale_tied;   /* a scale that the edges cannot see would do what the part's stretch does */
  bool corrected;    /* there are claims of the points: before and after differ */
  bool of_width;     /* there are claims of the width */
  bool contradicted; /* scans kept aside become worse */
  double noise_floor_um, edge_model_error_um;
  fg_scan_noise noise;
  double half_width_rms_um, half_width_smooth_um;
  double p_value;    /* that no effect is needed */
  double matters_um; /* an effect of this size would be a nuisance: `absent` below it */
  fg_scan_loop_error before, after;
  fg_scan_held_out held_out;
  size_t folds;        /* that it is cross-fitted over */
  const char *fold_of; /* what they are of: "bumps", "discs", "stretches of the edge"; NULL: none */
  double width_before_um,
      width_after_um; /* with `of_width`: rms of half the width about its mean */

  fg_scan_result_scan *scan;
  size_t scans;
  fg_scan_result_claim claim[FG_SCAN_RESULT_CLAIMS];
  size_t claims;
  const fg_scan_result_claim *curve;             /* the largest free one; NULL: none */
  const char *nearest[FG_SCAN_RESULT_UNCLAIMED]; /* effects that come near the curves */
  size_t nearests;
  fg_scan_result_explanation explanation[FG_SCAN_RESULT_EXPLANATIONS]; /* the likeliest first */
  size_t explanations, unlisted;                                       /* unlisted: further ones */
  char common[FG_SCAN_RESULT_WORDS]; /* what all explanations share; "": nothing */
  fg_scan_result_unclaimed unclaimed[FG_SCAN_RESULT_UNCLAIMED];
  size_t unclaimeds;
  const char *advice[FG_SCAN_RESULT_ADVICE]; /* measurements that would part what is tied */
  size_t advices;
  char channel_check_words[FG_SCAN_RESULT_WORDS]; /* the last of them, where the colour lines say it
                                                   */
  const char *const *note;                        /* what the reader must know */
  size_t notes;
  size_t left_out; /* foils that could not be measured, or are none of the design's */
  fg_scan_result_bumps bumps;

  const char *coordinate_name[FG_SCAN_COORDINATES], *coordinate_title[FG_SCAN_COORDINATES];
  fg_scan_result_view *view;
  size_t views;
  fg_scan_result_row *row;
  size_t rows, row_stations; /* stations in a full row */
  double light_weight;       /* rows up to this weight hardly take part: edges that are not round */
  fg_scan_result_line *line;
  size_t lines;
  fg_scan_result_grid grid;

  const struct fg_scanner_model *model; /* of what is the scanner's: what a model file holds */
} fg_scan_result;

#ifdef __cplusplus
}
#endif
#endif

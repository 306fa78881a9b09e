/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Result of the loop on scans: decisions, numbers, words and points to draw. The writers of JSON,
 * text and page only print it and decide nothing, so that users of the library get the same.
 *
 * Everything belongs to its loop and lives as long as the loop. */
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
  FG_SCAN_RESULT_UNCLAIMED = 64,
  FG_SCAN_RESULT_PARAMETERS = 4,
  FG_SCAN_RESULT_ADVICE = 3,
  FG_SCAN_RESULT_WORDS = 512,
  FG_SCAN_RESULT_SAMPLES = 241,     /* of a curve that is drawn */
  FG_SCAN_RESULT_GRID_SAMPLES = 61, /* of a line of the picture's grid */
};

/* Coordinates of effects and of residual plots. */
typedef enum fg_scan_coordinate {
  FG_SCAN_X, /* mm of the scan */
  FG_SCAN_Y,
  FG_SCAN_FOIL,   /* along the foil, mm from the lip's side */
  FG_SCAN_PHI,    /* place in the bump's arc, -1 to 1 */
  FG_SCAN_INDEX,  /* number of the bump, plus less than half to either side for the place in its arc
                   */
  FG_SCAN_NORMAL, /* direction of the edge's outward normal, degrees */
  FG_SCAN_COORDINATES
} fg_scan_coordinate;

/* Kinds of held-out error. */
typedef enum fg_scan_held_out {
  FG_SCAN_HELD_OUT_NOTHING, /* no effect was found: it is the rms; or too few bumps to hold some
                               out: it is NaN */
  FG_SCAN_HELD_OUT_SCANS,   /* held-out scans */
  /* Cross-fitted: bumps in folds (discs on plates; short stretches of the edge for a step or a
     curve over places), with the search repeated without each. The error before is of the geometry
     alone, fitted to all rows. */
  FG_SCAN_HELD_OUT_FOLDS
} fg_scan_held_out;

/* Errors of the rows, um. */
typedef struct fg_scan_loop_error {
  double rms, robust_sd, p95, maximum, held_out_rms;
} fg_scan_loop_error;

/* Noise of an edge row, um: white, and correlated along the edge (Patterson and Thompson 1971:
 * restricted likelihood). All sums of squares are judged by it. */
typedef struct fg_scan_noise {
  const char *model; /* "white": rows are independent. Else the correlation over the distance d:
                        "gaussian": exp(-(d / range)²), "exponential": exp(-d / range) */
  double sd_um;      /* of a row: root of the squares of the two below */
  double white_um, correlated_um;
  double correlation; /* share of the variance that adjacent rows share */
  double range_mm;
  double long_waves; /* variance of waves of half a millimetre over the model's prediction of it */
  double *disc_um;   /* sd of a row, disc by disc, in the scans' order */
  size_t discs;
} fg_scan_noise;

/* Number of an effect: for JSON, and for people (a ratio in ppm; the leading amplitude with its
 * sign). */
typedef struct fg_scan_result_parameter {
  const char *name; /* "amplitude_um", "value", "period_mm" */
  double value, u;
  const char *symbol, *unit;
  double told, u_told;
} fg_scan_result_parameter;

/* Verdict of the colour lines on an effect of the carriage: between the channels of one scan, part
 * and optics cancel, but the carriage's error does not. */
typedef enum fg_channel_check_verdict {
  FG_CHANNEL_CHECK_NONE,        /* not of the carriage, or no colour scan */
  FG_CHANNEL_CHECK_FOR,         /* "for" */
  FG_CHANNEL_CHECK_AGAINST,     /* "against" */
  FG_CHANNEL_CHECK_CANNOT_TELL, /* "cannot_tell" */
} fg_channel_check_verdict;

typedef struct fg_channel_check {
  fg_channel_check_verdict verdict;
  const char *reason;      /* reason in words */
  double p_value;          /* of the channels, if the effect were absent */
  double p_against;        /* of the channels, if the effect were as claimed; NaN: gaps unknown */
  double factor, u_factor; /* ratio of shown to expected size; without known gaps 1 and NaN */
  double expected_um;      /* rms of the expected difference, about its mean */
  double gap_px[3];        /* of red, green, blue: as stated, or the best fit; NaN: none */
  bool gap_stated;
} fg_channel_check;

/* Effect in the corrected model. */
typedef struct fg_scan_result_claim {
  const char *id, *direction; /* direction of an effect with two bases: "normal", "radial"; NULL: it
                                 has one only */
  const char *words, *equation;
  const char *says; /* meaning of the sign; NULL: its words are complete */
  bool of_width;    /* of the strip's width: residual and dimensions are not corrected for it */
  bool free;        /* a curve that no listed effect explains */
  bool sure;        /* every explanation that the data allow includes it */
  fg_loop_verdict verdict;
  fg_scan_coordinate coordinate; /* of curves, and of effects of the part */
  const char *coordinate_name;   /* "foil.s" */
  const char *moves;             /* of curves: one word for the thing moved */
  const char *basis;             /* reference of the shape; NULL: its numbers are complete */
  fg_scan_result_parameter parameter[FG_SCAN_RESULT_PARAMETERS];
  size_t parameters;
  double amplitude_um;
  double p_value;        /* of the null hypothesis that the effect, or any effect, is not needed */
  double retained_share; /* share left beside the geometry; NaN: was not searched */
  double would_explain; /* share of the residual sum, or of the widths' sum, that it explains alone;
                           NaN: was not searched */
  double (*shape)[2];   /* coordinate and deviation in um, of curves and of effects with a basis */
  size_t shape_points;
  fg_channel_check channel_check;
} fg_scan_result_claim;

/* One of several sets of effects that explain the residual. */
typedef struct fg_scan_result_explanation {
  char name[FG_SCAN_RESULT_WORDS];  /* "scan.scale_y + part.ovality" */
  char words[FG_SCAN_RESULT_WORDS]; /* the part of it that the others lack, for people */
} fg_scan_result_explanation;

/* Effect that is not claimed. `tied`: one of several explanations includes it. */
typedef struct fg_scan_result_unclaimed {
  const char *id, *words;
  bool of_width;
  fg_loop_verdict verdict;
  double would_explain, retained_share;
  double smallest_um; /* smallest amplitude that would have shown; NaN: none */
  bool barred;        /* seen, but not confirmed from disc to disc */
} fg_scan_result_unclaimed;

typedef struct fg_scan_result_scan {
  const fg_measurement *before, *after;
  bool hold_out; /* held out */
} fg_scan_result_scan;

/* Foil or disc on one scan, the unit that rows belong to. */
typedef struct fg_scan_result_view {
  size_t scan;
  const fg_foil *foil; /* NULL: a disc */
  size_t bumps;        /* of the part */
} fg_scan_result_view;

/* Mean of neighbouring stations, and its distance from the circle. */
typedef struct fg_scan_result_row {
  size_t scan;
  size_t arc;                        /* index of a run of neighbours on one edge without a gap */
  int bump;                          /* number; 0: a land or a disc */
  fg_point at_mm;                    /* measured */
  fg_point ideal_mm;                 /* on its circle */
  fg_point normal;                   /* outward from the circle's centre */
  double place[FG_SCAN_COORDINATES]; /* by coordinate; NaN: none */
  double weight;                     /* stations in the mean; 0: an outlier, not used */
  double residual_um[2];             /* before and after correction; outward positive */
} fg_scan_result_row;

/* Sum of the effects on one coordinate, for plots. */
typedef struct fg_scan_result_line {
  fg_scan_coordinate coordinate;
  bool glass;                       /* displacement of the picture; else deviation of the part */
  char axis;                        /* 'x', 'y': component of the displacement */
  bool free;                        /* includes a free curve of the part, less its circle */
  double x[FG_SCAN_RESULT_SAMPLES]; /* over the foil: degrees about O from its middle */
  double um[FG_SCAN_RESULT_SAMPLES];
  double expanded_um[FG_SCAN_RESULT_SAMPLES]; /* U = 2u; NaN: unknown */
} fg_scan_result_line;

/* Line of the picture's grid, and the true places of its points. */
typedef struct fg_scan_result_grid_line {
  int axis; /* 0: at an x, 1: at a y */
  fg_point at_mm[FG_SCAN_RESULT_GRID_SAMPLES], move_mm[FG_SCAN_RESULT_GRID_SAMPLES];
} fg_scan_result_grid_line;

typedef struct fg_scan_result_grid {
  fg_scan_result_grid_line *line; /* as dense as the displacement needs */
  size_t lines;                   /* 0: no effect moves the picture */
  double low_mm[2], high_mm[2];   /* of the picture */
  double cell_mm;                 /* maximum distance between lines */
  double largest_mm;              /* displacement */
  double period_mm;               /* of the shortest ripple; infinite: none */
} fg_scan_result_grid;

/* ---- the bumps against the declared springback, or against a forming's prediction ---- */

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
  } tied[FG_LOOP_ALIASES];       /* equivalent explanations */
  size_t ties;
} fg_scan_result_bump_claim;

typedef struct fg_scan_result_bump_unclaimed {
  const char *id, *words;
  fg_loop_verdict verdict;
  double would_explain, p_value, retained_share;
  double smallest; /* smallest amplitude that would have shown, the response's `unit`; NaN: none */
} fg_scan_result_bump_unclaimed;

typedef struct fg_scan_result_bump {
  size_t part;
  int number;
  bool held_out;
  double before, after; /* deviation from the model, the response's `unit` */
  double effect;        /* contribution of the effects found */
} fg_scan_result_bump;

/* rms about the declared model, without and with the effects found; NaN: not tested. */
typedef struct fg_scan_result_bump_error {
  double rms[2], held_out_rms[2];
} fg_scan_result_bump_error;

typedef struct fg_scan_result_response {
  const char *name, *words; /* "bump_radius_mm", "bump radius" */
  const char *unit, *model; /* unit of all numbers here; declared model */
  bool judged;
  fg_scan_result_bump_claim claim[FG_LOOP_CLAIMS];
  size_t claims;
  fg_scan_result_bump_unclaimed *unclaimed;
  size_t unclaimeds;
  fg_scan_result_bump *bump; /* NULL: not tested */
  size_t bumps;
  bool has_curve; /* a curve over the bump's number that no listed effect explains */
  double (*curve)[2];
  size_t curve_points;
  double curve_rms, curve_p;
  const char **nearest; /* listed effects that resemble the curve */
  size_t nearests;
  fg_scan_result_bump_error error;
  /* Mean of measured minus declared value, which the errors exclude; NaN: the model has no level.
   */
  double level, u_level;
} fg_scan_result_response;

typedef struct fg_scan_result_bumps {
  size_t count, held_out, parts;               /* bumps tested, and held out; foils */
  bool lip;                                    /* bump numbers count from a lip */
  const char *coordinate_name;                 /* of those numbers */
  const char *declared_path, *declared_sha256; /* of the forming; NULL: the design's springback */
  fg_scan_result_response response[FG_SCAN_RESULT_RESPONSES];
  fg_scan_result_bump_error height_um;  /* follows from both */
  const fg_scan_result_response *curve; /* response with an unexplained curve; NULL: none */
} fg_scan_result_bumps;

/* ---- everything ---- */

typedef struct fg_scan_result {
  fg_loop_outcome verdict;
  bool same_foil, discs;
  const char *without; /* effects that were not looked for; NULL: none */
  bool tied;           /* several explanations */
  bool named;          /* the effects are named: explanations differ at most in a basis */
  bool scale_tied; /* a scale that the edges cannot see would explain the part's stretch as well */
  bool uneven_discs; /* nothing is claimed, and discs deviate from circles by more than noise */
  bool corrected;    /* effects of the rows are claimed: before and after differ */
  bool of_width;     /* effects of the width are claimed */
  bool contradicted; /* the error of held-out scans increased */
  double noise_floor_um, edge_model_error_um;
  fg_scan_noise noise;
  double half_width_rms_um, half_width_smooth_um;
  double p_value;    /* of the null hypothesis that no effect is needed */
  double matters_um; /* size from which an effect is a nuisance: `absent` means smaller */
  fg_scan_loop_error before, after;
  fg_scan_held_out held_out;
  size_t folds; /* number of folds of the cross-fit */
  const char
      *fold_of; /* units of the folds: "bumps", "discs", "stretches of the edge"; NULL: none */
  double width_before_um,
      width_after_um; /* with `of_width`: rms of half the width about its mean */

  fg_scan_result_scan *scan;
  size_t scans;
  fg_scan_result_claim claim[FG_SCAN_RESULT_CLAIMS];
  size_t claims;
  const fg_scan_result_claim *curve;             /* largest free curve; NULL: none */
  const char *nearest[FG_SCAN_RESULT_UNCLAIMED]; /* listed effects that resemble the curves */
  size_t nearests;
  fg_scan_result_explanation explanation[FG_SCAN_RESULT_EXPLANATIONS]; /* likeliest first */
  size_t explanations, unlisted;     /* explanations listed; further ones */
  char common[FG_SCAN_RESULT_WORDS]; /* effects common to all explanations; "": none */
  fg_scan_result_unclaimed unclaimed[FG_SCAN_RESULT_UNCLAIMED];
  size_t unclaimeds;
  const char *advice[FG_SCAN_RESULT_ADVICE]; /* measurements that would resolve the tie */
  size_t advices;
  char channel_check_words[FG_SCAN_RESULT_WORDS]; /* verdict of the colour lines, as the last advice
                                                   */
  const char *const *note;                        /* notes for the reader */
  size_t notes;
  size_t left_out; /* foils without measurement, or not of the design */
  fg_scan_result_bumps bumps;

  const char *coordinate_name[FG_SCAN_COORDINATES], *coordinate_title[FG_SCAN_COORDINATES];
  fg_scan_result_view *view;
  size_t views;
  fg_scan_result_row *row;
  size_t rows, row_stations; /* stations in a full row */
  double light_weight; /* largest weight of rows that hardly contribute: edges that are not round */
  fg_scan_result_line *line;
  size_t lines;
  fg_scan_result_grid grid;

  const struct fg_scanner_model *model; /* effects of the scanner, as in a model file */
} fg_scan_result;

#ifdef __cplusplus
}
#endif
#endif

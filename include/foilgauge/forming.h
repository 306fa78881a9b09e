/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Springback of a strip by a beam model of forming (thesis section 5.9, without its contact).
 *
 * BENT. A flat strip is bent to the die's curvature kappa_d(s). Its width is far larger than its
 * thickness: plane strain, E' = E / (1 - nu²). Through the thickness eps = kappa_d z; layers yield
 * at (2 / sqrt 3) Y and harden linearly, by (4 / 3) H per plastic strain. Both fall with the
 * temperature by one curve, E' by a straight line.
 *
 * RELAXED. The die holds the curvature while the temperature follows a schedule. Stress above the
 * hot yield stress flows at once; the remainder creeps by Norton's law, in uniaxial tension d eps /
 * dt = A (sigma / 100 MPa)^n exp(-(Q / R) (1/T - 1/T0)),   T0 = 550 degrees C, in plane strain
 * (sigma_y = sigma_x / 2, no volume change) times (sqrt 3 / 2)^(n + 1). A constant temperature has
 * a closed form in every layer: sigma = (sigma_0^(1 - n) + (n - 1) E' B t)^(-1 / (n - 1)).
 *
 * RELEASED, cold and elastic: kappa_f = kappa_d - rho M / (E' I), with M the moment of the bend and
 * rho its share left after the treatment.
 *
 * The free strip is kappa_f integrated along s; its circles are fitted as `measure` fits them.
 *
 * NOT MODELLED: contact and friction (figures 5.14 to 5.16: contact while the die closes, pressure
 * too low to close it, bumps that differ by their place). A pressure on both faces adds a
 * hydrostatic stress in plane strain, which neither yields nor creeps: it enters no equation here.
 */
#ifndef FOILGAUGE_FORMING_H
#define FOILGAUGE_FORMING_H

#include <stdio.h>

#include "foilgauge/foil.h"
#include "foilgauge/table.h"

#ifdef __cplusplus
extern "C" {
#endif

/* File that was read, for the report; path "": none. */
typedef struct fg_forming_file {
  char path[512], sha256[65];
} fg_forming_file;

/* ---- the material ---- */

enum {
  FG_FORMING_CURVE_MAX = 16,
  FG_FORMING_SOURCE = 240,
  FG_FORMING_FREE_MAX = 4, /* maximum number of fitted constants */
};
#define FG_FORMING_COLD_C       20.0  /* temperature of bending and release */
#define FG_FORMING_CREEP_MPA    100.0 /* reference stress of creep_rate_per_h */
#define FG_FORMING_CREEP_TEMP_C 550.0

typedef enum fg_forming_constant {
  FG_FORMING_MODULUS,       /* youngs_modulus_gpa, at 20 degrees C */
  FG_FORMING_MODULUS_SLOPE, /* modulus_slope_per_K: E = E20 (1 - slope (T - 20)) */
  FG_FORMING_POISSON,       /* poisson_ratio */
  FG_FORMING_YIELD,         /* yield_mpa, at 20 degrees C */
  FG_FORMING_HARDENING,     /* hardening_mpa, per plastic strain */
  FG_FORMING_CREEP_RATE,    /* creep_rate_per_h: A */
  FG_FORMING_CREEP_EXPONENT,
  FG_FORMING_CREEP_ENERGY, /* creep_energy_kj_per_mol */
  FG_FORMING_CONSTANTS
} fg_forming_constant;

typedef struct fg_forming_constant_row {
  const char *name, *symbol, *unit, *words;
  double low, high; /* accepted range, which is also a fit's */
  bool by_factors;  /* the fit uses its logarithm */
  double value;     /* the default */
  const char *source;
} fg_forming_constant_row;

const fg_forming_constant_row *fg_forming_constant_of(fg_forming_constant constant);

typedef struct fg_forming_material {
  char name[96];
  double value[FG_FORMING_CONSTANTS];
  char source[FG_FORMING_CONSTANTS][FG_FORMING_SOURCE];
  /* Yield and hardening at a temperature over those at 20 degrees C: linear between points,
   * undefined beyond the last. */
  size_t curve_count;
  double curve_temperature_C[FG_FORMING_CURVE_MAX], curve_share[FG_FORMING_CURVE_MAX];
  char curve_source[FG_FORMING_SOURCE];
  fg_forming_file file;
} fg_forming_material;

/* Stainless strip 1.4310, annealed: literature values, with their scatter in `source`. The thesis
 * prints no constants. */
void fg_forming_material_default(fg_forming_material *material);
/* FG_ERR_DATA names the member and the allowed values. */
fg_status fg_forming_material_check(fg_context *ctx, const fg_forming_material *material);
/* "foilgauge/material/1": members of the rows above, each a number or {"value", "source"}; and
 * "yield_curve": {"temperature_C": [...], "share": [...], "source"}. Absent members keep their
 * values. */
fg_status fg_forming_material_load(fg_context *ctx, const char *path,
                                   fg_forming_material *material);

/* ---- treatment of the strip ---- */

/* Temperatures over time, linear between the points. No points: released right after bending. */
typedef struct fg_forming_schedule {
  double *time_h, *temperature_C; /* owned */
  size_t count;
  fg_forming_file file;
} fg_forming_schedule;

/* One hold, without heating and cooling. */
fg_status fg_forming_schedule_hold(fg_context *ctx, double temperature_C, double hours,
                                   fg_forming_schedule *schedule);
/* CSV: time_h, temperature_C. */
fg_status fg_forming_schedule_load(fg_context *ctx, const char *path,
                                   fg_forming_schedule *schedule);
void fg_forming_schedule_free(fg_forming_schedule *schedule);

/* Shape of the die: the design's lands, fillets and bumps, or a sine of its height over its pitch.
 */
typedef enum fg_forming_shape { FG_FORMING_ARCS, FG_FORMING_SINE } fg_forming_shape;

enum { FG_FORMING_BUMPS_MAX = 128, FG_FORMING_BUMPS_DEFAULT = 9 };

/* Measured die (`foilgauge die -o`). Bumps without a measured value get the mean. */
typedef struct fg_forming_die {
  fg_forming_file file;
  double overall_radius_mm;
  size_t count;
  struct {
    int number;
    double radius_mm, bump_angle_deg;
  } bump[FG_FORMING_BUMPS_MAX];
  double mean_radius_mm, mean_angle_deg;
} fg_forming_die;

fg_status fg_forming_die_load(fg_context *ctx, const char *path, const fg_design *design,
                              fg_forming_die *die);

typedef struct fg_forming_options {
  fg_forming_shape shape;
  const fg_forming_die *die; /* NULL: as designed */
  size_t layers;             /* over half the thickness; 0: 200 */
  size_t steps;              /* per stretch of a schedule; 0: 200 */
} fg_forming_options;

/* ---- result ---- */

/* Piece of constant curvature. Curvatures are positive where the strip bends round the shaft's
 * axis, as the lands do; stresses are of the fibre stretched by that, 0 to 2 of FG_FORMING_STATES.
 */
typedef enum fg_forming_state {
  FG_FORMING_BENT,   /* cold, in the die */
  FG_FORMING_HEATED, /* at the end of the schedule, in the die */
  FG_FORMING_FREE,   /* cold, out of the die */
  FG_FORMING_STATES
} fg_forming_state;

typedef struct fg_forming_piece {
  fg_arc_kind kind;
  int number;                           /* of its bump or land */
  double start_mm, length_mm;           /* along the midline */
  double curvature_die, curvature;      /* 1/mm */
  double moment_n, share;               /* M per mm of width when bent; rho */
  double stress_mpa[FG_FORMING_STATES]; /* along the strip, at its face */
} fg_forming_piece;

typedef struct fg_forming_bump {
  int number;
  double die_radius_mm, die_angle_deg; /* of a sine: of the circles fitted to it */
  double curvature_radius_mm;          /* 1 / kappa_f at its crown */
  fg_bump fitted;                      /* as the measurement fits it; NaN: not found */
} fg_forming_bump;

typedef struct fg_forming {
  fg_design design;
  fg_nominal nominal;
  fg_forming_material material;
  fg_forming_options options;
  fg_forming_die die;           /* if given */
  fg_forming_schedule schedule; /* owned */
  fg_forming_piece *pieces;     /* owned */
  size_t count;
  double length_mm;
  fg_forming_bump *bumps; /* owned */
  size_t bump_count;
  /* Of the integrated strip: each pitch turns it by one angle about one centre. NaN: it does not
   * close round a centre. */
  double overall_radius_mm, springback_error_pct;
  double turn_die_deg, turn_deg; /* per pitch (arc: from end to end) */
  /* Of the lands alone: a plain strip bent to the overall radius. */
  double strip_radius_mm, strip_springback_error_pct;
  double mean_stress_mpa[FG_FORMING_STATES], largest_stress_mpa[FG_FORMING_STATES];
  double mean_share; /* rho over the strip's length */
  bool yields_back;  /* a layer would yield on release: the release is not elastic */
  fg_foil foil;      /* the free strip as measured; owned */
  bool fitted;       /* its circles were found */
} fg_forming;

/* FG_ERR_DATA: a design without curvature (discs), a schedule beyond the material's curve. `foil`
 * has the flags and `error` that a measurement would have. Free with fg_forming_free. */
fg_status fg_forming_run(fg_context *ctx, const fg_design *design,
                         const fg_forming_material *material, const fg_forming_schedule *schedule,
                         const fg_forming_options *options, fg_forming *forming);
void fg_forming_free(fg_forming *forming);

/* "foilgauge/form/1" (reports/schema/form.schema.json), the table for a terminal, one row per bump,
 * one row per stretch of the strip, a page. */
fg_status fg_forming_write_json(fg_context *ctx, const fg_forming *forming, FILE *out);
fg_status fg_forming_write_text(fg_context *ctx, const fg_forming *forming, FILE *out);
fg_status fg_forming_write_bumps(fg_context *ctx, const fg_forming *forming, FILE *out);
fg_status fg_forming_write_strip(fg_context *ctx, const fg_forming *forming, FILE *out);
fg_status fg_forming_write_html(fg_context *ctx, const fg_forming *forming, FILE *out);

/* ---- constants from a designed experiment ---- */

/* Subject of a run's springback. */
typedef enum fg_forming_response {
  FG_FORMING_OF_STRIP, /* strip_springback_error_pct */
  FG_FORMING_OF_FOIL,  /* springback_error_pct */
} fg_forming_response;

typedef struct fg_forming_found {
  fg_forming_constant constant;
  double value, u; /* standard uncertainty from the covariance; for a constant fitted by its
                      logarithm, of that logarithm */
  double
      interval[2]; /* 95 %, by profile likelihood; NaN for an end that the runs do not determine */
  bool at_bound;   /* it reached the end of its accepted range: its value is meaningless */
} fg_forming_found;

/* Returns true when the runs determine the constant: not at its bound, and both ends of its
 * interval known. */
bool fg_forming_identified(const fg_forming_found *found);

/* Errors of one model: sd of its residuals, and of held-out runs (each in turn). */
typedef struct fg_forming_errors {
  double residual_sd, left_out_rms;
  size_t parameters;
} fg_forming_errors;

typedef struct fg_forming_run_fit {
  double temperature_C, duration_h, measured, fitted, left_out; /* predicted without it */
} fg_forming_run_fit;

typedef struct fg_forming_fit {
  fg_design design;
  fg_forming_material material; /* with the fitted constants */
  fg_forming_response response;
  fg_forming_options options;
  char response_name[64];
  fg_forming_file file; /* of the runs */
  size_t free;
  fg_forming_found found[FG_FORMING_FREE_MAX];
  double correlation[FG_FORMING_FREE_MAX][FG_FORMING_FREE_MAX];
  fg_forming_run_fit *run; /* owned */
  size_t runs;
  fg_forming_errors model, surface; /* surface: 1 + T + D + T:D + T² + D² */
  double repeat_sd;                 /* of runs at the same setting; NaN: none repeats */
  size_t repeats;                   /* their degrees of freedom */
} fg_forming_fit;

/* Request for a fit: table columns temperature_C, duration_h and `response`. FG_ERR_DATA: fewer
 * runs than constants + 2. Free with fg_forming_fit_free. */
typedef struct fg_forming_fit_request {
  const fg_design *design;
  const fg_forming_material *material; /* start values, and constants that are not fitted */
  const char *column;                  /* the response; NULL: springback_error_pct */
  const char *sha256;                  /* of the table's file; NULL: not stated */
  fg_forming_response response;
  fg_forming_options options;
  const fg_forming_constant *free;
  size_t free_count;
} fg_forming_fit_request;

fg_status fg_forming_fit_runs(fg_context *ctx, const fg_table *table,
                              const fg_forming_fit_request *request, fg_forming_fit *fit);
void fg_forming_fit_free(fg_forming_fit *fit);

/* "foilgauge/form-fit/1" (reports/schema/form_fit.schema.json), and for people; the material is a
 * file that fg_forming_material_load reads. */
fg_status fg_forming_fit_write_json(fg_context *ctx, const fg_forming_fit *fit, FILE *out);
fg_status fg_forming_fit_write_text(fg_context *ctx, const fg_forming_fit *fit, FILE *out);
fg_status fg_forming_fit_write_html(fg_context *ctx, const fg_forming_fit *fit, FILE *out);
fg_status fg_forming_write_material(fg_context *ctx, const fg_forming_material *material,
                                    FILE *out);

/* ---- as a declared model ---- */

/* Bumps of a report of `forming`. */
typedef struct fg_forming_prediction {
  char path[1024], sha256[65];
  size_t count;
  fg_bump bump[FG_FORMING_BUMPS_MAX]; /* number and the reported quantities; NaN: not reported */
} fg_forming_prediction;

/* Reads "foilgauge/form/1". FG_ERR_DATA: another file, or one without fitted bumps. */
fg_status fg_forming_prediction_load(fg_context *ctx, const char *path,
                                     fg_forming_prediction *prediction);
/* Predicts a bump's quantity (its JSON name) by the bump's number. FG_ERR_DATA: a number or a
 * quantity that the prediction lacks. */
fg_status fg_forming_predict(fg_context *ctx, const fg_forming_prediction *prediction, int number,
                             const char *quantity, double *value);

#ifdef __cplusplus
}
#endif
#endif

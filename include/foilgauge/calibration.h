/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Calibration: the length of a pixel and the temperature of the part, which the statistics of a
 * scan do not show.
 *
 * A scan tells lengths in pixels. Its own scatter says nothing about the pixel's pitch: it comes
 * from a certificate, or from a reference part, with an uncertainty that all foils of all scans of
 * this scanner share. And lengths are stated at 20 °C (ISO 1), while the part was scanned at T:
 *
 *   L20 = L (1 - alpha (T - 20))
 *   u²  = u_stat² + (L u_scale)² + (L (T - 20) u_alpha)² + (L alpha u_T)²     (GUM 4.1, 5.1.2)
 *
 * alpha is the foil's. The pitch includes the expansion of the scanner's own bed and belt at T, and
 * must hold during the scan: the certificate's u has to cover the range of temperatures that it is
 * used in. Where the pitch was taken from a reference part scanned at the same T, whose dimensions
 * are those at 20 °C, alpha is the foil's less the reference's: the rest cancels. The term of
 * second order, L u_alpha u_T (GUM H.1.7), is left out.
 *
 * EFFECT. Found edges are multiplied by 1 - alpha (T - 20) before anything is fitted to them, so
 * every length is one at 20 °C; a report's dpi includes the factor. No formula says what a longer
 * or shorter pixel changes in a reported quantity. Instead the edges are stretched and the foil is
 * measured again (measure.h): so clearances, errors in percent and any later quantity follow by
 * themselves.
 *   "scale": {"u_rel": 1e-4}                 both axes err alike: angles keep their value
 *   "scale": {"x": {...}, "y": {...}}        each axis by itself: angles and radii move, a bump's
 *                                            radius by -1 to 2 times the axis' error, as it lies
 * Temperature and expansion are of both axes.
 *
 * It is the same error in every foil of a scanner: the mean of n foils has
 * u = sqrt(u_stat² / n + u_cal²), and a difference of two foils is free of it.
 *
 * Certificates state U with a factor k: {"U_rel": 2e-4, "k": 2} is {"u_rel": 1e-4}. In a design or
 * a recipe (which overrules the design):
 *
 *   "calibration": {
 *     "certificate": "DKD-K-12345 2026-03", "date": "2026-03-14",
 *     "scale": {"U_rel": 1e-4, "k": 2},
 *     "temperature": {"value_C": 23.4, "u_K": 0.5},
 *     "expansion": {"value_per_K": 1.23e-5, "U_per_K": 1e-6, "k": 2}
 *   }
 *
 * Only the scale is needed. Without temperature and expansion, which go together, the part counts
 * as being at 20 °C, and U does not include it. Where a scanner's model has the scale, temperature
 * and expansion may stand alone; where the model also says how warm the scanner was, the difference
 * is in U.
 *
 * Two words take the object's place: "flatbed" is the default for a flatbed that nobody has
 * calibrated, and "not needed: REASON" lets values be judged without any, with a reason that every
 * report prints. */
#ifndef FOILGAUGE_CALIBRATION_H
#define FOILGAUGE_CALIBRATION_H

#include <stdbool.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

#define FG_REFERENCE_TEMPERATURE_C 20.0

typedef struct fg_calibration {
  bool stated;          /* false: all of it is 0 */
  char certificate[64]; /* its name; "": none stated */
  char date[11];        /* of the certificate, "2026-03-14"; "": none stated */
  char artefact[64];    /* the plate or gauge that the certificate is of; "": none stated */
  char due[11];         /* the last day that it holds; "": none stated */
  char not_needed[128]; /* reason why no calibration is needed; "": one is */
  bool per_axis;        /* the axes err independently; else alike, and u_scale[1] is u_scale[0] */
  double u_scale[2];    /* relative standard uncertainty of the pixel's pitch along x and y */
  bool has_temperature; /* false: the members below are 0 */
  double temperature_c, u_temperature_k; /* of the part during the scan */
  double expansion_per_k, u_expansion_per_k;
  bool scale_by_model; /* no scale is stated, only temperature and expansion */
  /* Relative uncertainty of the scanner's own expansion since its model was made; never read, but
   * found (fg_scanner_model_trace). */
  double u_bed;
} fg_calibration;

static inline bool fg_calibration_has_scale(const fg_calibration *calibration) {
  return calibration->stated && !calibration->scale_by_model;
}

/* Standard uncertainty, relative, of a scanner's pitch at one temperature that is known at another.
 * Its bed, belt and sensor expand by no more than aluminium does, 23e-6 per K, and by any share of
 * that: a rectangular distribution (GUM 4.3.7). The temperatures may be uncertain. */
double fg_calibration_bed(double kelvin, double u_kelvin);

/* A plate or gauge of known sizes, which lengths are traced to. */
typedef struct fg_artefact {
  char name[64], certificate[64];
  char date[11], due[11]; /* of the certificate, and the last day that it holds; "": not stated */
} fg_artefact;

/* Returns the default for an unknown flatbed: 0.3 % of x and of y, each by itself. Published scales
 * are off by up to 0.6 % across an A4 sheet, other for every scanner of a model. */
fg_calibration fg_calibration_of_flatbed(void);

/* FG_ERR_DATA when a value is no number or impossible; the message names the member. */
fg_status fg_calibration_check(fg_context *ctx, const fg_calibration *calibration);

/* L20 / L; 1 without a temperature. */
double fg_calibration_factor(const fg_calibration *calibration);

/* Relative standard uncertainties of a length by temperature, by expansion and by the scanner's own
 * expansion, and of a length along one axis by all of it. */
typedef struct fg_calibration_budget {
  double scale[2], temperature, expansion, bed;
  double length[2];
} fg_calibration_budget;

fg_calibration_budget fg_calibration_terms(const fg_calibration *calibration);

/* The calibration's errors as two independent ones: relative stretch of x and y by each, one
 * standard deviation. */
enum { FG_CALIBRATION_SOURCES = 2 };
void fg_calibration_sources(const fg_calibration *calibration,
                            double stretch[FG_CALIBRATION_SOURCES][2]);

#ifdef __cplusplus
}
#endif
#endif

/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the statistics of a scan cannot know: how long a pixel is, and how warm the part was.
 *
 * A scan tells lengths in pixels. Its own scatter says nothing about the pixel's pitch: that is
 * known from a certificate, or from a reference part, with an uncertainty that all foils of all
 * scans of this scanner share. And lengths are stated at 20 °C (ISO 1), while the part was scanned
 * at T:
 *
 *   L20 = L (1 - alpha (T - 20))
 *   u²  = u_stat² + (L u_scale)² + (L (T - 20) u_alpha)² + (L alpha u_T)²     (GUM 4.1, 5.1.2)
 *
 * alpha is the foil's. What the scanner's own bed and belt do at T is in its pitch, which is to
 * hold at the scanning: the certificate's u has to cover the range of temperatures that it is used
 * in. Where the pitch was taken from a reference part scanned at the same T, whose dimensions are
 * those at 20 °C, alpha is the foil's less the reference's: the rest cancels. The term of second
 * order, L u_alpha u_T (GUM H.1.7), is left out.
 *
 * WHAT IT DOES. Edges that were found are multiplied by 1 - alpha (T - 20) before anything is
 * fitted to them, so every length is one at 20 °C, and a report's dpi is what makes it so. What a
 * longer or shorter pixel does to a reported quantity is not written down anywhere: the edges are
 * stretched and the foil is measured again (measure.h), so that clearances, errors in percent and
 * whatever comes later follow by themselves.
 *   "scale": {"u_rel": 1e-4}                 both axes err alike: angles keep their value
 *   "scale": {"x": {...}, "y": {...}}        each axis by itself: angles and radii move, a bump's
 *                                            radius by -1 to 2 times the axis' error, as it lies
 * Temperature and expansion are of both axes.
 *
 * It is the same error in every foil of a scanner: the mean of n foils has
 * u = sqrt(u_stat² / n + u_cal²), and a difference of two foils is free of it.
 *
 * Certificates state U with a factor k: {"U_rel": 2e-4, "k": 2} is {"u_rel": 1e-4}. In a design or
 * a recipe (which overrules the design): "calibration": { "certificate": "DKD-K-12345 2026-03",
 * "date": "2026-03-14", "scale": {"U_rel": 1e-4, "k": 2}, "temperature": {"value_C": 23.4, "u_K":
 * 0.5}, "expansion": {"value_per_K": 1.23e-5, "U_per_K": 1e-6, "k": 2}
 *   }
 * Only the scale is needed. Without temperature and expansion, which go together, the part is taken
 * to be at 20 °C, and U holds nothing of it. */
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
  char certificate[64]; /* its name; "": none */
  char date[11];        /* of the certificate, "2026-03-14"; "": none */
  bool per_axis;        /* the axes err by themselves; else alike, and u_scale[1] is u_scale[0] */
  double u_scale[2];    /* relative standard uncertainty of the pixel's pitch along x and y */
  bool has_temperature; /* else what follows is 0 */
  double temperature_c, u_temperature_k; /* of the part while it was scanned */
  double expansion_per_k, u_expansion_per_k;
} fg_calibration;

/* FG_ERR_DATA when a value is no number or not one that can be; the message names the member. */
fg_status fg_calibration_check(fg_context *ctx, const fg_calibration *calibration);

/* L20 / L; 1 without a temperature. */
double fg_calibration_factor(const fg_calibration *calibration);

/* Relative standard uncertainties of a length by temperature and by expansion, and of a length
 * along one axis by all of it. */
typedef struct fg_calibration_budget {
  double scale[2], temperature, expansion;
  double length[2];
} fg_calibration_budget;

fg_calibration_budget fg_calibration_terms(const fg_calibration *calibration);

/* Its errors as two that are independent: how far each stretches x and y, relative, one standard
 * deviation. */
enum { FG_CALIBRATION_SOURCES = 2 };
void fg_calibration_sources(const fg_calibration *calibration,
                            double stretch[FG_CALIBRATION_SOURCES][2]);

#ifdef __cplusplus
}
#endif
#endif

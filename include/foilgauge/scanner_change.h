/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Has a scanner changed? Two of its models compared.
 *
 * Over the region that both models know, the displacement of the bed by the newer model less that
 * by the older one is held against the uncertainty of both. Scale, ratio of axes and shear are
 * compared as numbers; shift and turn of a bed have no meaning, and neither has the scale where one
 * model does not know it. p_value is the probability that two models of an unchanged scanner differ
 * as much, over the bed or in one of the numbers: draws by the models' own covariances give the
 * distribution of the mean square of all places' differences over their uncertainties, and of the
 * largest of the numbers'. */
#ifndef FOILGAUGE_SCANNER_CHANGE_H
#define FOILGAUGE_SCANNER_CHANGE_H

#include <stdio.h>

#include "foilgauge/scan_loop.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum fg_scanner_verdict {
  FG_SCANNER_SAME,      /* p > 0.1 */
  FG_SCANNER_SUSPECTED, /* p from 0.01 to 0.1 */
  FG_SCANNER_CHANGED,
} fg_scanner_verdict;

/* The largest difference against the allowed one. */
typedef enum fg_scanner_limit {
  FG_SCANNER_WITHIN,      /* with its U */
  FG_SCANNER_BEYOND,      /* even less its U */
  FG_SCANNER_CANNOT_TELL, /* the limit lies within U */
  FG_SCANNER_NO_LIMIT,
} fg_scanner_limit;

/* A number of the scanner by both models; NaN where one does not know it, or neither holds it. */
typedef struct fg_scanner_number {
  const char *id, *words;
  double older, newer; /* ratios less 1; u of each below */
  double u_older, u_newer;
  double difference, u;
} fg_scanner_number;

enum { FG_SCANNER_NUMBERS = 3, FG_SCANNER_SIDE = 15, FG_SCANNER_WORDS = 500 };

/* A place of the bed: displacement by the newer model less that by the older. */
typedef struct fg_scanner_place {
  fg_point at_mm, d_um, u_um;
  bool compared; /* false: between the places that the models have of one jump */
} fg_scanner_place;

typedef struct fg_scanner_change {
  fg_scanner_model_facts older, newer;          /* their texts belong to the models */
  double low_mm[2], high_mm[2];                 /* the region of both */
  bool scale_known;                             /* by both */
  fg_scanner_number number[FG_SCANNER_NUMBERS]; /* scale, ratio of axes, shear */
  size_t numbers;
  fg_scanner_place place[FG_SCANNER_SIDE * FG_SCANNER_SIDE]; /* row by row */
  size_t columns, rows, places;
  fg_scanner_place largest;
  double largest_um, u_largest_um; /* along the difference there */
  double rms_um;                   /* along one axis, over all places */
  double would_show_um;            /* rms difference of shape, without the numbers, that p < 0.01
                                    * tells; NAN: neither model has a shape */
  double p_value;
  fg_scanner_verdict verdict;
  double limit_um; /* NaN: none */
  fg_scanner_limit limit;
  char sentence[FG_SCANNER_WORDS];
} fg_scanner_change;

/* FG_ERR_DATA when the models are of two resolutions or named scanners, or know no common region.
 * `limit_um`: the largest allowed difference of a place; NaN: none. The models must outlive
 * `change`. */
fg_status fg_scanner_compare(fg_context *ctx, const fg_scanner_model *older,
                             const fg_scanner_model *newer, double limit_um,
                             fg_scanner_change *change);

/* 0: the same, or within the limit; 1: changed, or beyond it; 3: cannot tell. */
int fg_scanner_change_exit_code(const fg_scanner_change *change);

/* "foilgauge/scanner-change/1". */
fg_status fg_scanner_change_write_json(fg_context *ctx, const fg_scanner_change *change, FILE *out);
fg_status fg_scanner_change_write_text(fg_context *ctx, const fg_scanner_change *change, FILE *out);
fg_status fg_scanner_change_write_html(fg_context *ctx, const fg_scanner_change *change, FILE *out);

#ifdef __cplusplus
}
#endif
#endif

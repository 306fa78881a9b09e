/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kernel density estimate: a sample's distribution without assuming its family.
 *
 * f(x) = sum of w_i phi((x - x_i) / h) / h with the Gaussian kernel phi. The bandwidth h decides
 * how much detail is shown. Three rules (Silverman 1986 eq 3.31; Scott 1992; Sheather and Jones
 * 1991, the equation solved, as R's bw.nrd0, bw.nrd and bw.SJ): Silverman       0.9 min(s, IQR
 * / 1.34) n^(-1/5) Scott           1.06 min(s, IQR / 1.34) n^(-1/5) Sheather-Jones  the root of h =
 * (R(phi) / (n S(alpha(h))))^(1/5): follows several modes Samples above 8192 values are put on a
 * grid of 4096 points (linear binning) first.
 */
#ifndef FOILGAUGE_DENSITY_H
#define FOILGAUGE_DENSITY_H

#include <stddef.h>
#include <stdint.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum fg_bandwidth_rule {
  FG_BANDWIDTH_SILVERMAN,
  FG_BANDWIDTH_SCOTT,
  FG_BANDWIDTH_SHEATHER_JONES,
} fg_bandwidth_rule;

/* "silverman", "scott", "sheather_jones". */
const char *fg_bandwidth_word(fg_bandwidth_rule rule);

typedef struct fg_density {
  double *value;      /* ascending; owned */
  double *weight;     /* sums to 1; owned */
  double *cumulative; /* of weight; owned */
  size_t count;
  double bandwidth;
} fg_density;

/* `values` are finite. FG_ERR_DATA for fewer than two different values. Free with
 * fg_density_free. */
fg_status fg_density_fit(fg_context *ctx, const double *values, size_t count,
                         fg_bandwidth_rule rule, fg_density *density);
void fg_density_free(fg_density *density);

double fg_density_at(const fg_density *density, double x);          /* f(x), per unit of x */
double fg_density_probability(const fg_density *density, double x); /* P(X < x) */
double fg_density_quantile(const fg_density *density, double probability);
double fg_density_mode(const fg_density *density); /* position of the maximum of f */

/* Draws a value from the density; advances `seed`. Equal seeds give equal values on any machine. */
double fg_density_draw(const fg_density *density, uint64_t *seed);

/* Quantile of a sample by linear interpolation between its order statistics (R's type 7).
 * `sorted` ascends, count > 0. */
double fg_sample_quantile(const double *sorted, size_t count, double probability);

#ifdef __cplusplus
}
#endif
#endif

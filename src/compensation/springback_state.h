/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear Gaussian model of one quantity at given sizes. States: m, g, the bumps, the sets, and
 * the mean of each set's foils about it. Few states, many places: by precisions. */
#ifndef FG_COMPENSATION_SPRINGBACK_STATE_H
#define FG_COMPENSATION_SPRINGBACK_STATE_H

#include <gsl/gsl_matrix.h>
#include <gsl/gsl_vector.h>

#include "compensation/springback.h"

typedef struct fg_state_prior {
  double mean_sd, exponent, exponent_sd;
} fg_state_prior;

/* Mean of one place of a set. */
typedef struct fg_state_row {
  size_t place, set;
  double log_ratio, step, foils; /* step: ln(die / target) */
} fg_state_row;

typedef struct fg_state_space {
  fg_state_prior prior;
  size_t places, sets, states, rows;
  double *set_foils; /* foils of each set; owned, as all below */
  fg_state_row *row;
  gsl_matrix *precision;
  gsl_vector *right, *mean;
} fg_state_space;

fg_status fg_state_begin(fg_context *ctx, const fg_formed_set *sets, size_t count, fg_formed formed,
                         const fg_springback_fit *fit, fg_state_space *space);
void fg_state_end(fg_state_space *space);

/* Logarithm of the marginal likelihood of the places' means. */
fg_status fg_state_evidence(fg_context *ctx, fg_state_space *space,
                            const fg_springback_sizes *sizes, double *evidence);

/* Mean of m, g, the bumps and the next set, and the lower root of their covariance. */
fg_status fg_state_posterior(fg_context *ctx, fg_state_space *space,
                             const fg_springback_sizes *sizes, double *mean, double *root);

#endif

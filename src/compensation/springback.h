/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Posterior of the springback of one quantity (foilgauge/compensation.h has the model): a mixture
 * over the unknown sizes of bump, set, foil and remainder, Gaussian at each of them. */
#ifndef FG_COMPENSATION_SPRINGBACK_H
#define FG_COMPENSATION_SPRINGBACK_H

#include "foilgauge/compensation.h"

/* Sizes of the random terms, of one point of the grid; logarithms' sd. */
typedef struct fg_springback_sizes {
  double rest, foil, bump, set;
  bool drift; /* sets as a random walk; false: each by itself */
} fg_springback_sizes;

/* States of a point: m, g, the bumps, and the deviation of the next set. */
enum { FG_STATE_COMMON, FG_STATE_EXPONENT, FG_STATE_BUMP };

typedef struct fg_springback_point {
  double weight;
  fg_springback_sizes sizes;
  double *mean, *root; /* of the states: mean; lower triangle of the covariance, row by row */
} fg_springback_point;

typedef struct fg_springback_fit {
  size_t places;
  int number[FG_COMPENSATION_BUMPS]; /* 0: the whole foil */
  bool seen[FG_COMPENSATION_BUMPS];  /* a set has the place */
  double reference;                  /* ln of the target's size */
  size_t states, points;
  fg_springback_point *point; /* the heaviest first; owned */
  double *block;              /* of means and roots; owned */
  double *state_mean;         /* of the mixture; owned, in `block` */
} fg_springback_fit;

struct fg_formed_laws {
  fg_springback_fit of[FG_FORMED];
};

/* Data that the posterior of one quantity is found from. */
typedef struct fg_springback_data {
  fg_formed formed; /* the quantity */
  const fg_formed_set *sets;
  size_t set_count;
  const int *bump_numbers; /* of the target */
  size_t bump_count;
  double target; /* the quantity's size in the target */
} fg_springback_data;

fg_status fg_springback_find(fg_context *ctx, const fg_springback_data *data,
                             fg_springback_fit *fit);
void fg_springback_fit_free(fg_springback_fit *fit);

/* Describes the law in numbers. */
void fg_springback_describe(const fg_springback_fit *fit, fg_formed_law *law);

/* Mean of ln(formed / die) of the next set at a place, for a die of the size `log_die`. */
double fg_springback_mean(const fg_springback_fit *fit, size_t place, double log_die);
/* ln of the die's size that lands the mean on the target. */
double fg_springback_invert(const fg_springback_fit *fit, size_t place);
/* Standard uncertainty of ln formed at that die, of the law alone (without the next set), and with
 * the next set. */
double fg_springback_u(const fg_springback_fit *fit, size_t place, double log_die, bool with_set);

/* True for a quantity by bump, false for one of the whole foil. */
bool fg_formed_is_by_bump(fg_formed formed);

#endif

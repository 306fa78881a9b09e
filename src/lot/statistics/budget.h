/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stiffness of a lot's bumps as columns, from the analysis of stiffness to its budget. */
#ifndef FG_LOT_STATISTICS_BUDGET_H
#define FG_LOT_STATISTICS_BUDGET_H

#include "lot/statistics/analysis.h"

typedef struct fg_bump_columns {
  double *radius, *arc_length;        /* datum line, as measured */
  double *arch_radius, *arch_length;  /* midline */
  double *thickness;                  /* in force: the foil's, else the design's */
  double *strip;                      /* as measured; NaN */
  double *measurement;                /* variance of ln K by the bump's own uncertainty; NaN */
  double *foot;                       /* stiffness of the feet over the design's */
  double *designed;                   /* ratio with the design's thickness */
  double *ratio[FG_STIFFNESS_MODELS]; /* stiffness over the design's, by model */
  size_t count;
} fg_bump_columns;

/* Returns the variance of ln K from a bump's u of radius and angle. They are correlated: the crown
 * is known far better than the centre, so where R is too large X is, too, and alpha is too small.
 * From X - R = R0 - h follows the covariance of X and R: (u_X² + u_R² - u_h²) / 2. */
double fg_bump_stiffness_variance(const fg_overall *overall, const fg_bump *bump,
                                  const fg_arch_sensitivity *sensitivity);

/* Fills analysis->stiffness.budget. */
void fg_lot_analyse_budget(fg_lot_analysis *analysis, const fg_bump_columns *columns);

#endif

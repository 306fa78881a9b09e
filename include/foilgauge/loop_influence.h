/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows that lead the fit of a model of a table. */
#ifndef FOILGAUGE_LOOP_INFLUENCE_H
#define FOILGAUGE_LOOP_INFLUENCE_H

#include <stddef.h>

enum { FG_LOOP_INFLUENCES = 3 }; /* maximum number of reported rows */

/* A row that leads the fit, beside everything found: its Cook's distance exceeds the median of F.
 */
typedef struct fg_loop_influence {
  size_t row;
  double leverage;
  double studentised; /* residual from the fit without the row, over its sd */
  double cook;
  size_t parameter;       /* declared one that the row moves most */
  double dfbetas;         /* that move, in standard errors */
  double change, without; /* of the parameter, by the row; the parameter without the row */
} fg_loop_influence;

#endif

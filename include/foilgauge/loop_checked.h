/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Residual tests of the loop on tables: their results. */
#ifndef FOILGAUGE_LOOP_CHECKED_H
#define FOILGAUGE_LOOP_CHECKED_H

#include <stdbool.h>
#include <stddef.h>

/* Residual tests, beside all effects sought by name: `clean` requires that none fails. */
typedef enum fg_loop_check {
  FG_LOOP_CHECK_REPEATS,  /* lack of fit: rows of the same declared settings, against the model's
                             prediction of their means */
  FG_LOOP_CHECK_SETTINGS, /* lack of fit of rows that agree in every recorded column */
  FG_LOOP_CHECK_LAGS,     /* correlation at lags 2 to `lag`, all together */
  FG_LOOP_CHECK_ONE_LAG,  /* correlation at the one lag where it is strongest */
  FG_LOOP_CHECKS
} fg_loop_check;

typedef struct fg_loop_checked {
  bool done, failed; /* not done: no row is repeated, or rows have no order or are too few */
  double statistic;  /* F ratio; sum of squares of normal deviates; the largest of them */
  double dof[2];     /* of an F ratio; of a sum of squares the first alone */
  double p_value, level;
  size_t lag;
  double correlation; /* at FG_LOOP_CHECK_ONE_LAG */
  double rms;         /* of the deviation tested, in the response's unit */
  size_t worst[3];    /* one row of each of the settings with the largest deviations */
  size_t worst_count;
} fg_loop_checked;

#endif

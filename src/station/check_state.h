/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tone, sharpening and blur of a scan of the plate, and their change. */
#ifndef FG_STATION_CHECK_STATE_H
#define FG_STATION_CHECK_STATE_H

#include "foilgauge/foil.h"
#include "station/check_fit.h"
#include "station/sql.h"

/* One quantity of the state. */
typedef struct fg_check_quantity {
  const char *name;                   /* in the database */
  const char *words, *unit;           /* for people */
  int decimals;                       /* of its values on pages */
  double smallest_change, share;      /* that matters: in its unit, or as a share of the baseline */
  double (*of_disc)(const fg_disc *); /* NULL: of all discs together, or of a grid alone */
  double (*u_of_disc)(
      const fg_disc *); /* u where all discs share one estimate; NULL: u is their scatter */
  const char *cause;    /* setting of driver or scanner that changes it */
  unsigned findings;    /* findings of the same change by a threshold, without an uncertainty */
  double (*of_fit)(const fg_check_fit *, double *u); /* where no disc has it */
} fg_check_quantity;

enum { FG_CHECK_QUANTITIES = 15 };
extern const fg_check_quantity fg_check_quantities[FG_CHECK_QUANTITIES];

/* Values in the order of fg_check_quantities; NaN: not known. u covers the variation over the
 * glass, as the plate lies elsewhere each time. */
typedef struct fg_check_state {
  int64_t dpi; /* states of unequal resolution are not compared */
  double value[FG_CHECK_QUANTITIES], u[FG_CHECK_QUANTITIES];
  unsigned findings; /* fg_picture_finding */
} fg_check_state;

void fg_check_state_find(const fg_measurement *measurement, const fg_check_fit *fit,
                         fg_check_state *state);

/* Returns the change of a quantity within its scatter and the smallest change that matters. */
double fg_check_state_allowed(const fg_check_state *state, const fg_check_state *baseline,
                              size_t quantity);

/* Returns the number of quantities that have changed against the baseline and of new findings;
 * lists them in words, "" where there are none. */
size_t fg_check_state_compare(const fg_check_state *state, const fg_check_state *baseline,
                              char *words, size_t size);

/* Keeps the state of check `id`; its row is there already. */
fg_status fg_check_state_keep(fg_context *ctx, sqlite3 *writer, int64_t id,
                              const fg_check_state *state);
fg_status fg_check_state_load(fg_context *ctx, sqlite3 *connection, int64_t id,
                              fg_check_state *state);

/* The baseline for scans of this resolution: the check accepted last as one. `at` is 0 where there
 * is none. */
fg_status fg_check_state_baseline(fg_context *ctx, sqlite3 *connection, int64_t dpi, int64_t *at,
                                  fg_check_state *state);

#endif

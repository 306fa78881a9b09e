/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Causes of what foils have in common: found by the loop on tables, accepted by people. */
#ifndef FG_STATION_CAUSE_H
#define FG_STATION_CAUSE_H

#include "station/cause_data.h"

enum { FG_CAUSES = 16, FG_CAUSE_POINTS = 256, FG_CAUSE_WORDS = 600 };

/* By how much a level of a column, or a place on it, moves the quantity; the mean over all foils
 * of the search is 0. Between places the shift is linear, beyond them constant. */
typedef struct fg_cause_point {
  char level[FG_IDENTITY_BYTES];
  double x, shift;
} fg_cause_point;

typedef struct fg_cause {
  char name[FG_CAUSE_NAME]; /* column */
  bool words;               /* of levels */
  fg_cause_point *point;    /* owned */
  size_t points;
  char words_of[FG_CAUSE_WORDS]; /* "since coil K7" */
  char ties[FG_CAUSE_WORDS];     /* other causes that these foils cannot tell it from; "": none */
  char tells[FG_CAUSE_WORDS];    /* foils that would tell; "" */
  double value, u;               /* difference that it makes, quantity's unit; u: standard */
  double p_value;
  int64_t since; /* time of the first foil behind it; 0: it did not begin */
} fg_cause;

/* Shift of a value by a cause; 0 where its column has no value of these. `column` may be NULL. */
double fg_cause_shift(const fg_cause *cause, const fg_cause_column *column, size_t foil);

typedef struct fg_cause_report {
  fg_cause cause[FG_CAUSES]; /* the largest first */
  size_t causes;
  size_t foils, days, lots;
  double mean;                /* of the quantity */
  double before, after;       /* sd of foils, with all causes in and out */
  double cv_before, cv_after; /* rms of rows when groups are left out in turn; NaN: no cause */
  char suspected[FG_CAUSE_WORDS], unexplained[FG_CAUSE_WORDS], note[FG_CAUSE_WORDS]; /* "": none */
  double seconds;
} fg_cause_report;

/* Searches the causes of data->value; `accepted` are taken out of it before. Free with
 * fg_cause_report_free. */
fg_status fg_cause_search(fg_context *ctx, const fg_cause_data *data, const fg_cause *accepted,
                          size_t accepted_count, fg_cause_report *report);
void fg_cause_report_free(fg_cause_report *report);

/* Words of a finding: the foils that it moves, its ties, the foils that would tell. */
void fg_cause_describe(const fg_cause_data *data, const fg_loop_problem *problem,
                       const fg_loop_claim *claim, bool by_lots, fg_cause *cause);
/* Writes "since coil K7: bump radius +0.41 % (+0.0136 mm), U 0.08 %; tied with ...". */
void fg_cause_write_text(FILE *out, const fg_cause *cause, const fg_quantity *row, double mean);
/* The same, HTML-safe. */
void fg_cause_write(FILE *out, const fg_cause *cause, const fg_quantity *row, double mean);

#endif

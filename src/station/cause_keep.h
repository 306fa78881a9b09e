/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Accepted causes in the database, and on charts. */
#ifndef FG_STATION_CAUSE_KEEP_H
#define FG_STATION_CAUSE_KEEP_H

#include "station/cause.h"

/* Reads the causes in force of a choice's quantity and bump; free with fg_causes_free. */
fg_status fg_causes_read(fg_context *ctx, sqlite3 *reader, const fg_trend_choice *choice,
                         fg_cause **causes, size_t *count);
void fg_causes_free(fg_cause *causes, size_t count);

/* Keeps a cause: who accepted it, and why. */
fg_status fg_cause_keep(fg_context *ctx, fg_station_database *database,
                        const fg_trend_choice *choice, const fg_cause *cause, const char *by,
                        const char *note);

/* Points of a chart, and two lists of causes that move them. */
typedef struct fg_shifted_points {
  const int64_t *foil;
  size_t count;
  const fg_cause *cause[2];
  size_t causes[2];
} fg_shifted_points;

/* Finds the shift of each point; *shift is NULL without causes, else the caller frees it. */
fg_status fg_causes_find_shifts(fg_context *ctx, const fg_station_request *request, sqlite3 *reader,
                                const fg_shifted_points *points, double **shift);

/* Writes the accepted causes of a chart, with who accepted them, when, and a form to withdraw each.
 */
fg_status fg_page_causes(fg_context *ctx, const fg_inspection *station, sqlite3 *reader,
                         const fg_trend_choice *choice, FILE *out);

#endif
